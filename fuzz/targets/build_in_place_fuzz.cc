// Property: a builder in place, by any order of setters that take or refuse, makes what write makes
// of a value with the same fields; bytes after its room stay untouched.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "codec/generated/rubicon/all.h"
#include "codec/generated/tinyos/all.h"
#include "fuzz/support/input.h"
#include "fuzz/support/require.h"

namespace {

using namespace rubric;
using namespace rubric::rubicon;
using fuzz::Input;
using fuzz::require;

constexpr std::uint8_t kUntouched = 0xA5;
constexpr int kStepsMax = 24;

// Calls one setter of the builder, and sets the same in the value if it succeeds.

void step(NetMsgBuilder& out, NetMsg& value, MutableBytes, Input& in) {
  switch (in.below(6)) {
    case 0: return out.set_dest(value.dest = {Pid(in.u16()), Devid(in.u16())});
    case 1: return out.src().set_devid(value.src.devid = Devid(in.u16()));
    case 2: return out.set_seq_num(value.seq_num = in.u16());
    case 3: {
      const std::uint8_t reliable = in.u8();
      if (out.set_reliable(reliable)) value.reliable = reliable;
      return;
    }
    case 4: {  // The bytes that are in the room.
      const std::uint8_t size = in.u8();
      if (out.set_nbytes(size)) value.payload = Bytes(out.payload_room()).first(size);
      return;
    }
    default: {
      const Bytes payload = in.bytes(in.u8());
      if (!out.set_payload(payload)) return;
      value.payload = Bytes(out.payload_room()).first(payload.size());
      require(equal(value.payload, payload), "a payload is copied");
      return;
    }
  }
}

void step(AppMsgBuilder& out, AppMsg& value, MutableBytes, Input& in) {
  const Bytes payload = in.bytes(in.u8());
  switch (in.below(4)) {
    case 0: return out.set_trans_id(value.trans_id = Component(in.u8()));
    case 1: return out.set_app_id(value.app_id = Component(in.u8()));
    case 2:
      if (!out.set_payload_size(payload.size())) return;
      break;
    default:
      if (!out.set_payload(payload)) return;
      break;
  }
  value.payload = Bytes(out.payload_room()).first(payload.size());
}

void step(UpdatesBuilder& out, Updates& value, MutableBytes, Input& in) {
  const std::size_t i = in.u8();
  switch (in.below(3)) {
    case 0: return out.set_type(value.type = AmType(in.u8()));
    case 1:
      if (out.set_output_size(static_cast<std::uint8_t>(i))) {
        value.updates.count = static_cast<std::uint16_t>(i);
      }
      return;
    default:
      if (i >= value.updates.count) return;
      out.updates(i).set_value(value.updates[i].value = in.u16());
      out.updates(i).set_transducer(value.updates[i].transducer = TransducerMask(in.u16()));
      return;
  }
}

void step(SynapticDataBuilder& out, SynapticData& value, MutableBytes, Input& in) {
  const std::size_t i = in.u8();
  const float number = float_of_bits(in.u32());
  if (in.below(2) == 0) {
    if (i < value.values.count) out.set_values(i, value.values[i] = number);
    return;
  }
  const std::vector<float> all(i, number);
  if (!out.set_values(all.data(), i)) return;
  std::copy(all.begin(), all.end(), value.values.items);
  value.values.count = static_cast<std::uint16_t>(i);
}

void step(SynCreateCmdBuilder& out, SynCreateCmd& value, MutableBytes, Input& in) {
  const std::uint8_t i = in.u8();
  switch (in.below(4)) {
    case 0:
      if (out.set_dest_neurons_size(i)) value.dest_neurons_size = i;
      return;
    case 1:
      if (i < 10) out.set_dest_neurons(i, value.dest_neurons[i] = in.u16());
      return;
    case 2: return out.set_params(value.params = static_cast<std::int8_t>(i));
    default: {
      const std::vector<std::uint16_t> all(i, in.u16());
      if (out.set_src_neurons(all.data(), i)) std::copy(all.begin(), all.end(), value.src_neurons);
      return;
    }
  }
}

// In order: the packet's place depends on the kind, and the bytes that it overwrites were another
// field.
void step(tinyos::SerialFrameBuilder& out, tinyos::SerialFrame& value, MutableBytes room,
          Input& in) {
  std::fill(room.data(), room.data() + room.size(), std::uint8_t{0});
  value = {};
  out.set_kind(value.kind = tinyos::SerialKind(static_cast<std::uint8_t>(66 + in.below(5))));
  const bool has_number =
      tinyos::SerialFrameView::parse(Bytes(room).first(1)).error().fault == Fault::kTruncated;
  const std::uint8_t number = in.u8();
  if (has_number && out.set_seq_num(number)) value.seq_num = number;
  const Bytes packet = in.bytes(in.u8());
  require(out.set_packet_size(0), "an empty packet has room");
  if (out.set_packet(packet)) value.packet = packet;
}

template <class Builder, class Value, class View>
void check(Input in) {
  const std::size_t size = in.u8();
  std::vector<std::uint8_t> all(size + 16, 0);
  std::fill(all.begin() + static_cast<std::ptrdiff_t>(size), all.end(), kUntouched);
  const MutableBytes room(all.data(), size);
  Result<Builder> made = Builder::create(room);
  require(made.has_value() == (size >= View::kMinSizeBytes), "the least is room enough");
  if (!made) return;
  Builder builder = *made;
  Value value;
  for (int i = 0; i < kStepsMax && !in.at_end(); ++i) step(builder, value, room, in);

  require(std::all_of(all.begin() + static_cast<std::ptrdiff_t>(size), all.end(),
                      [](std::uint8_t byte) { return byte == kUntouched; }),
          "nothing after the room is written");
  std::vector<std::uint8_t> out(size);
  const auto written = write(value, MutableBytes(out.data(), size));
  const Result<View> finished = builder.finish();
  require(written.has_value() == finished.has_value(), "builder and write take the same");
  if (!written) return require(written.error() == finished.error(), "for the same reason");
  require(equal(*written, finished->bytes()), "builder and write make the same bytes");
  require(finished->stale().empty(), "a view is as large as what was built");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Input in(data, size);
  check<NetMsgBuilder, NetMsg, NetMsgView>(in);
  check<AppMsgBuilder, AppMsg, AppMsgView>(in);
  check<UpdatesBuilder, Updates, UpdatesView>(in);
  check<SynapticDataBuilder, SynapticData, SynapticDataView>(in);
  check<SynCreateCmdBuilder, SynCreateCmd, SynCreateCmdView>(in);
  check<tinyos::SerialFrameBuilder, tinyos::SerialFrame, tinyos::SerialFrameView>(in);
  return 0;
}
