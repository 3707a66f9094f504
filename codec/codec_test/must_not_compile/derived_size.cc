// The number of bytes follows from the payload; a value cannot contradict it.
#include "codec/generated/rubicon/net_msg.h"

void set(rubric::rubicon::NetMsg& message, rubric::Bytes payload) {
  message.payload = payload;
#ifndef RUBRIC_CONTROL
  message.nbytes = 102;
#endif
}
