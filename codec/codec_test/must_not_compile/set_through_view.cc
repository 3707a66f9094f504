// Setters are the builder's.
#include "codec/generated/rubicon/net_msg.h"

#ifdef RUBRIC_CONTROL
void set(rubric::rubicon::NetMsgBuilder& message) { message.set_seq_num(1); }
#else
void set(rubric::rubicon::NetMsgView& message) { message.set_seq_num(1); }
#endif
