// Property: a builder that gets every field of a parsed structure makes its bytes again, whatever
// its room held before; the parts that a view returns are those that parse finds in it.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "codec/generated/oscilloscope/all.h"
#include "codec/generated/rubicon/all.h"
#include "codec/generated/tinyos/all.h"
#include "fuzz/support/every_builder.h"
#include "fuzz/support/require.h"

namespace {

using namespace rubric;
using fuzz::require;

// clang-format off
#define RUBRIC_EACH_STRUCTURE(F)                                                                  \
  F(tinyos, AmHeader) F(tinyos, MacAck) F(tinyos, MacHeader) F(tinyos, SerialFrame)               \
  F(tinyos, SfPacket) F(rubicon, AckJoin) F(rubicon, AppMsg) F(rubicon, AppMsgFromPc)             \
  F(rubicon, BroadcastCmd) F(rubicon, Command) F(rubicon, Complete) F(rubicon, Config)            \
  F(rubicon, Connless) F(rubicon, Data) F(rubicon, Demo) F(rubicon, DemoData)                     \
  F(rubicon, JoinReply) F(rubicon, JoinRequest) F(rubicon, LearningModuleCmd)                     \
  F(rubicon, LearningModuleDown) F(rubicon, LearningModuleFloatCmd)                               \
  F(rubicon, LearningNotification) F(rubicon, LearningOutput) F(rubicon, MoteDesc)                \
  F(rubicon, NetCommand) F(rubicon, NetData) F(rubicon, NetMsg) F(rubicon, NetidCmd)              \
  F(rubicon, RAddr) F(rubicon, RadioIFrame) F(rubicon, RadioTFrame) F(rubicon, ReadUpdates)       \
  F(rubicon, RssiBeacon) F(rubicon, Rubicon) F(rubicon, RubiconAck)                               \
  F(rubicon, RubiconAckSeqOnly) F(rubicon, SerialData) F(rubicon, SerialJoined)                   \
  F(rubicon, SynCreateCmd) F(rubicon, SynapticData) F(rubicon, TransducerUpdate)                  \
  F(rubicon, Updates) F(oscilloscope, Oscilloscope) F(oscilloscope, OscilloscopeMsg)              \
  F(oscilloscope, RadioIFrame) F(oscilloscope, RadioTFrame)
#define RUBRIC_EACH_PAYLOAD(F)                                                                    \
  F(ack_join, AckJoin) F(app_msg, AppMsg) F(app_msg_from_pc, AppMsgFromPc) F(command, Command)    \
  F(config, Config) F(join_reply, JoinReply) F(join_request, JoinRequest)                         \
  F(learning_module_cmd, LearningModuleCmd) F(learning_module_float_cmd, LearningModuleFloatCmd)  \
  F(net_msg, NetMsg) F(oscilloscope_msg, OscilloscopeMsg) F(rssi_beacon, RssiBeacon)              \
  F(serial_data, SerialData)
#define RUBRIC_EACH_BODY(F)                                                                       \
  F(broadcast_cmd, BroadcastCmd) F(demo, Demo) F(demo_data, DemoData)                             \
  F(learning_module_cmd, LearningModuleCmd) F(learning_module_down, LearningModuleDown)           \
  F(learning_module_float_cmd, LearningModuleFloatCmd)                                            \
  F(learning_notification, LearningNotification) F(learning_output, LearningOutput)               \
  F(netid_cmd, NetidCmd) F(read_updates, ReadUpdates) F(rubicon_ack, RubiconAck)                  \
  F(rubicon_ack_seq_only, RubiconAckSeqOnly) F(serial_joined, SerialJoined)                       \
  F(syn_create_cmd, SynCreateCmd) F(synaptic_data, SynapticData) F(updates, Updates)
// clang-format on

#define RUBRIC_CHECK_PAYLOAD(name, Name)                     \
  if constexpr (requires { view.payload_as_##name(); }) {    \
    if (view.payload_kind() == View::PayloadKind::k##Name) { \
      check_part(view.payload_as_##name(), view.payload());  \
    }                                                        \
  }
#define RUBRIC_CHECK_BODY(name, Name)                    \
  if constexpr (requires { view.body_as_##name(); }) {   \
    if (view.body_kind() == View::BodyKind::k##Name) {   \
      check_part(view.body_as_##name(), view.payload()); \
    }                                                    \
  }

template <class Part>
void check_part(const Part& part, Bytes bytes) {
  const Result<Part> parsed = Part::parse(bytes);
  require(parsed && !(*parsed != part), "a part is what parse makes of its bytes");
}

template <class View>
void check_parts(const View& view) {
  RUBRIC_EACH_PAYLOAD(RUBRIC_CHECK_PAYLOAD)
  RUBRIC_EACH_BODY(RUBRIC_CHECK_BODY)
}

template <class View, class Builder>
void check(Bytes bytes, std::uint8_t before) {
  const Result<View> view = View::parse(bytes);
  if (!view) return;
  check_parts(*view);
  std::vector<std::uint8_t> room(view->bytes().size(), before);
  const MutableBytes whole(room.data(), room.size());
  for (std::size_t n = 0; n < View::kMinSizeBytes; ++n) {
    require(!Builder::create(whole.first(n)), "less than the least has no room");
  }
  const auto created = Builder::create(whole);
  require(created.has_value(), "what parse took has room for its builder");
  Builder builder = *created;
  const typename View::Value value = view->to_value();
  fuzz::set_every_field(builder, value);
  fuzz::set_too_much(builder, value);
  const Result<View> made = builder.finish();
  require(made && equal(made->bytes(), view->bytes()), "the builder makes the bytes again");
  require(!(*made != *view) && !(made->to_value() != value), "what is the same is not different");
}

template <class Mask>
void check_mask(std::uint16_t one, std::uint16_t other) {
  using Raw = decltype(Mask().raw());
  const Raw a = static_cast<Raw>(one), b = static_cast<Raw>(other);
  const Mask first(a), second(b);
  require((first | second).raw() == (a | b), "a mask has the bits of both");
  require(first.without(second).raw() == static_cast<Raw>(a & ~b), "less the bits of the other");
  require(first.with(second).without(second) == first.without(second), "once in, then out");
  require(static_cast<Raw>(first) == a && (first != second) == (a != b), "a mask is its bits");
  for (int bit = 0; bit < int{sizeof(Raw)} * 8; ++bit) {
    const auto named = static_cast<typename Mask::Bit>(1u << bit);
    require(first.has(named) == ((a >> bit & 1) != 0), "a mask has the bits that it has");
    require((named | named) == Mask(named), "two bits are a mask");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const Bytes bytes(data, size);
#define RUBRIC_CHECK(protocol, Name) \
  check<protocol::Name##View, protocol::Name##Builder>(bytes, data[size - 1]);
  RUBRIC_EACH_STRUCTURE(RUBRIC_CHECK)
  if (size < 4) return 0;
  check_mask<rubicon::ActuatorMask>(data[0], data[1]);
  check_mask<rubicon::TransducerMask>(load_be16(data), load_be16(data + 2));
  return 0;
}
