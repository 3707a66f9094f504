// Makes the bench's calls of the application.
#include "conformance/adapters/firmware/bench/bench.h"

namespace rubric {
namespace firmware {
namespace {

Address address_at(const uint8_t* p) { return {load_be16(p), load_be16(p + 2)}; }

Descriptor descriptor_at(const uint8_t* p) {
  Descriptor descriptor;
  descriptor.mote_type = static_cast<rubicon::MoteType>(p[0]);
  descriptor.transducers = rubicon::TransducerMask(load_be16(p + 1));
  descriptor.actuators = rubicon::ActuatorMask(p[3]);
  return descriptor;
}

}  // namespace

void Bench::result(bool success) {
  begin(EventCode::kOpResult, 1);
  board_.put(success);
}

void Bench::result(ChannelResult result) {
  begin(EventCode::kChannelResult, 5);
  put32(result.id);
  board_.put(result.success);
}

void Bench::call(CallCode code, Bytes arguments) {
  const uint8_t* const p = arguments.data();
  switch (code) {
    case CallCode::kJoin: return node_.join(descriptor_at(p));
    case CallCode::kSend: {
      const uint16_t seq_num = node_.send(address_at(p), p[4], p[5] != 0, arguments.from(6));
      begin(EventCode::kSendResult, 2);
      return put16(seq_num);
    }
    case CallCode::kInterface:
    case CallCode::kGetInterface: return call_on_lines(code, arguments);
    case CallCode::kStartAll: node_.start_all(); return result(true);
    case CallCode::kStopAll: node_.stop_all(); return result(true);
    case CallCode::kSetTimeStep: return result(node_.set_time_step(load_be16(p)));
    case CallCode::kSetIslandId: return result(node_.set_island(load_be16(p)));
    case CallCode::kGetClock: begin(EventCode::kClock, 4); return put32(node_.clock_ms());
    default: return call_on_channel(code, p);
  }
}

void Bench::call_on_lines(CallCode code, Bytes arguments) {
  const uint8_t number = arguments[0];
  if (number >= kLines) return result(false);
  const Line line = static_cast<Line>(number);
  if (code == CallCode::kInterface) return result(node_.set_interface(line, arguments[1] != 0));
  begin(EventCode::kInterfaceState, 2);
  board_.put(number);
  board_.put(node_.interface_is_on(line));
}

void Bench::call_on_channel(CallCode code, const uint8_t* p) {
  const ChannelId id = load_be32(p);
  const Mode mode = p[5] == 0 ? Mode::kReliable : Mode::kPowerSave;
  switch (code) {
    case CallCode::kCreateOut: return result(node_.create_out(address_at(p), p[4], mode));
    case CallCode::kCreateIn: return result(node_.create_in(address_at(p), p[4], mode));
    case CallCode::kDispose: return result(node_.dispose(id));
    case CallCode::kStart: return result(node_.start_channel(id));
    case CallCode::kStop: return result(node_.stop_channel(id));
    case CallCode::kWriteOutput:
      return result(node_.write_output(id, p[4], float_of_bits(load_be32(p + 5))));
    case CallCode::kReadInput: {
      const InputValue input = node_.read_input(id, p[4]);
      begin(EventCode::kInputValue, 5);
      put32(bits_of_float(input.value));
      return board_.put(input.success);
    }
    default: return;
  }
}

}  // namespace firmware
}  // namespace rubric
