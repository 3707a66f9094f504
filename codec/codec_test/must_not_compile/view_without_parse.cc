// A view comes from parse only: bytes that nobody checked have none.
#include "codec/generated/rubicon/join_reply.h"

rubric::Result<rubric::rubicon::JoinReplyView> make(rubric::Bytes bytes) {
#ifdef RUBRIC_CONTROL
  return rubric::rubicon::JoinReplyView::parse(bytes);
#else
  return rubric::rubicon::JoinReplyView(bytes);
#endif
}
