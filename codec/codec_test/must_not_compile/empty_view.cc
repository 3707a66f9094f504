// There is no view of nothing.
#include "codec/generated/rubicon/join_reply.h"

int main() {
#ifdef RUBRIC_CONTROL
  rubric::rubicon::JoinReply reply;
#else
  rubric::rubicon::JoinReplyView reply;
#endif
  (void)reply;
}
