// A setter that can refuse wants to be asked.
#pragma GCC diagnostic error "-Wunused-result"
#include "codec/generated/rubicon/net_msg.h"

void set(rubric::rubicon::NetMsgBuilder& message) {
#ifdef RUBRIC_CONTROL
  if (!message.set_reliable(1)) return;
#else
  message.set_reliable(1);
#endif
}
