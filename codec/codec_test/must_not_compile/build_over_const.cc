// A builder needs bytes that it may change.
#include "codec/generated/rubicon/join_reply.h"

#ifdef RUBRIC_CONTROL
bool make(rubric::MutableBytes out) {
#else
bool make(rubric::Bytes out) {
#endif
  return rubric::rubicon::JoinReplyBuilder::create(out).has_value();
}
