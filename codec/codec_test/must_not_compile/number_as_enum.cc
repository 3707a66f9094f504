// A number becomes an enum only where somebody says so.
#include "codec/generated/rubicon/app_msg.h"

using namespace rubric::rubicon;

void set(AppMsgBuilder& builder) {
#ifdef RUBRIC_CONTROL
  builder.set_trans_id(Component(3));
#else
  builder.set_trans_id(3);
#endif
}
