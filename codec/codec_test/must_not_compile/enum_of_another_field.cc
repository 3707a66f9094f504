// A component is not an AM type.
#include "codec/generated/rubicon/app_msg.h"

using namespace rubric::rubicon;

void set(AppMsg& message) {
#ifdef RUBRIC_CONTROL
  message.trans_id = Component::kConnless;
#else
  message.trans_id = AmType::kConnless;
#endif
}
