// Mistakes that must not compile: each within #ifdef, under its name. The rest is right.
#pragma GCC diagnostic error "-Wunused-result"
#include "codec/generated/rubicon/app_msg.h"
#include "codec/generated/rubicon/join_reply.h"
#include "codec/generated/rubicon/mote_desc.h"
#include "codec/generated/rubicon/net_msg.h"
#include "codec/generated/rubicon/rssi_beacon.h"

using namespace rubric;
using namespace rubric::rubicon;

// Only parse makes a view, so bytes that were not checked have none.
Result<JoinReplyView> view_of(Bytes bytes) {
#ifdef VIEW_WITHOUT_PARSE
  return JoinReplyView(bytes);
#endif
  return JoinReplyView::parse(bytes);
}

// There is no view of nothing; a view only reads, and setters are the builder's.
void read(NetMsgView view) {
#ifdef EMPTY_VIEW
  JoinReplyView reply;
#elif defined(WRITE_THROUGH_VIEW)
  view.bytes()[0] = 1;
#elif defined(SET_THROUGH_VIEW)
  view.set_seq_num(1);
#endif
  (void)view;
}

// A setter that can refuse wants to be asked.
void set(NetMsgBuilder& message) {
  message.set_seq_num(1);
#ifdef UNREAD_REFUSAL
  message.set_reliable(1);
#endif
  if (!message.set_reliable(1)) return;
}

// The number of bytes follows from the payload; a value cannot contradict it.
void set(NetMsg& message, Bytes payload) {
  message.payload = payload;
#ifdef DERIVED_SIZE
  message.nbytes = 102;
#endif
}

// A component is not an AM type, and a number becomes an enum only where somebody says so.
void set(AppMsg& value, AppMsgBuilder& builder) {
  value.trans_id = Component::kConnless;
  builder.set_trans_id(Component(3));
#ifdef ENUM_OF_ANOTHER_FIELD
  value.trans_id = AmType::kConnless;
#elif defined(NUMBER_AS_ENUM)
  builder.set_trans_id(3);
#endif
}

// An actuator is not a transducer.
bool has_led(MoteDescView desc) {
#ifdef MASK_OF_ANOTHER_FIELD
  return desc.transducers().has(ActuatorMask::kLed);
#endif
  return desc.actuators().has(ActuatorMask::kLed);
}

// The bytes of a view must live at least as long as the view, also those without a name.
int anchor() {
#ifdef TEMPORARY_BYTES
  using Array = const uint8_t[1];
  return RssiBeaconView::parse(Array{1})->anchor_id();
#elif defined(BRACED_BYTES)
  return RssiBeaconView::parse({1, 2, 3})->anchor_id();
#endif
  const uint8_t bytes[] = {1, 2, 3};
  return RssiBeaconView::parse(bytes)->anchor_id();
}

// A builder needs bytes that it may change.
bool build(MutableBytes out, Bytes fixed) {
#ifdef BUILD_OVER_CONST
  return JoinReplyBuilder::create(fixed).has_value();
#endif
  return fixed.empty() || JoinReplyBuilder::create(out).has_value();
}
