#include "tools/encode/carriers.h"

#include "codec/containers/crc16_fast.h"
#include "codec/reflect/encode_number.h"
#include "codec/runtime/crc16.h"
#include "tools/encode/members.h"
#include "tools/encode/record.h"

namespace rubric::encode {

using reflect::Field;
using reflect::Type;
using reflect::Value;
using reflect::value_text;

const Field& payload_field(const Type& carrier) { return carrier.fields[carrier.field_count - 1]; }

std::optional<std::int64_t> am_type_on(const Type& carrier, const Type& message) {
  const Field& payload = payload_field(carrier);
  if (!payload.choice) return std::nullopt;
  for (int i = 0; i < payload.choice->count; ++i) {
    const reflect::SwitchCase& c = payload.choice->cases[i];
    if (c.type == &message) return c.key;
  }
  return std::nullopt;
}

namespace {

// The fields of TinyOS frames have the names of the lines' members, but other places.
constexpr std::string_view kRadioMembers[] = {"fcf", "dsn", "destpan", "dest", "src"};

void put_payload(const Value& payload, Value& values) {
  // Without fields the payload is empty: an empty row of opaque bytes.
  values.set("payload", payload.is(Value::Kind::kNull) ? Value::of_string("") : payload);
}

// Checks numbers that radio frames contain twice, or in a part of a longer number.
void check_agreement(const Value& am, std::string_view key, const Value& frame,
                     std::string_view frame_key, std::int64_t mask) {
  const Value* in_am = given(am, key);
  const Value* in_frame = given(frame, frame_key);
  if (!in_am || !in_frame || !in_frame->is(Value::Kind::kInteger)) return;
  if (in_am->is(Value::Kind::kInteger) && in_am->integer == (in_frame->integer & mask)) return;
  throw RecordError("am." + std::string(key),
                    "expected " + std::to_string(in_frame->integer & mask) + " as frame." +
                        std::string(frame_key) + " says, given " + value_text(*in_am));
}

}  // namespace

Value serial_values(const Value& am, const Value& frame, const Value& payload) {
  Value header = Value::of_object();
  if (const Value* dispatch = given(frame, "dispatch")) header.set("dispatch", *dispatch);
  for (std::size_t i = 0; i < am.keys.size(); ++i) header.set(am.keys[i], am.items[i]);
  Value values = Value::of_object();
  values.set("am", std::move(header));
  put_payload(payload, values);
  return values;
}

Value radio_values(const Value& am, const Value& frame, bool has_network, const Value& payload) {
  check_agreement(am, "dest", frame, "dest", 0xffff);
  check_agreement(am, "src", frame, "src", 0xffff);
  check_agreement(am, "group", frame, "destpan", 0xff);
  Value mac = Value::of_object();
  for (const std::string_view key : kRadioMembers) {
    const Value* value = given(frame, key);
    if (!value) value = given(am, key == "destpan" ? "group" : key);
    if (value) mac.set(key, *value);
  }
  Value values = Value::of_object();
  values.set("mac", std::move(mac));
  if (has_network) {
    if (const Value* network = given(frame, "network")) values.set("network", *network);
  }
  if (const Value* type = given(am, "type")) values.set("type", *type);
  put_payload(payload, values);
  return values;
}

std::string path_in_line(std::string_view path) {
  const auto moved = [&](std::string_view from, std::string_view to) {
    return std::string(to) + std::string(path.substr(from.size()));
  };
  if (path == "payload") return "fields";
  if (path.starts_with("payload.")) return moved("payload", "fields");
  if (path.starts_with("mac.")) return moved("mac", "frame");
  if (path == "am.dispatch") return "frame.dispatch";
  if (path == "network") return "frame.network";
  if (path == "type") return "am.type";
  return std::string(path);
}

std::int32_t check_sum(const Packet& packet) {
  if (packet.framing == Framing::kRadio) return fcs_fast(packet.bytes);
  std::uint8_t head[2];
  std::size_t head_size = 0;
  if (packet.kind != kAbsent) head[head_size++] = static_cast<std::uint8_t>(packet.kind);
  if (packet.serial_seq != kAbsent) {
    head[head_size++] = static_cast<std::uint8_t>(packet.serial_seq);
  }
  return crc16(packet.bytes, crc16(Bytes(head, head_size)));
}

}  // namespace rubric::encode
