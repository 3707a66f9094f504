// A view only reads.
#include "codec/generated/rubicon/net_msg.h"

void patch(rubric::rubicon::NetMsgView view, rubric::MutableBytes bytes) {
#ifdef RUBRIC_CONTROL
  (void)view;
  bytes[0] = 1;
#else
  (void)bytes;
  view.bytes()[0] = 1;
#endif
}
