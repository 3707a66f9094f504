#include "tools/encode/record.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <optional>
#include <string>

#include "codec/containers/link_record.h"
#include "codec/generated/tinyos/tables.h"
#include "codec/reflect/decode.h"
#include "codec/reflect/encode_number.h"
#include "codec/reflect/fault_text.h"
#include "codec/runtime/hdlc.h"
#include "tools/encode/carriers.h"
#include "tools/encode/members.h"

namespace rubric::encode {
namespace {

using reflect::Decoded;
using reflect::Field;
using reflect::Kind;
using reflect::Node;
using reflect::NodeKind;
using reflect::Type;
using reflect::Value;
using reflect::value_text;

// Compares two decodings of what should be the same frame.

struct Difference {
  std::string path;  ///< Path of the first field that differs, from the outermost structure.
  std::string in_a;  ///< Its value there, as text.
  std::string in_b;
};

std::string hex(Bytes bytes) { return fmt::format("\"{:02x}\"", fmt::join(bytes, "")); }

std::string plain_number(const Field& field, std::int64_t value) {
  if (field.kind != Kind::kFloat) return reflect::integer_text(field, value);
  return std::to_string(float_of_bits(static_cast<std::uint32_t>(value)));
}

bool same_number(const Field& field, std::int64_t a, std::int64_t b) {
  if (a == b || field.kind != Kind::kFloat) return a == b;
  const float x = float_of_bits(static_cast<std::uint32_t>(a));
  const float y = float_of_bits(static_cast<std::uint32_t>(b));
  return x == y || (std::isnan(x) && std::isnan(y));
}

std::string describe(const Decoded& decoded, const Node& node) {
  switch (node.kind) {
    case NodeKind::kNumber: return plain_number(*node.field, node.value);
    case NodeKind::kBytes: return hex(decoded.bytes.sub(node.offset, node.size));
    case NodeKind::kStruct: return std::string("a ") + node.type->name;
    default: return std::to_string(node.count) + " elements";
  }
}

/// Walks two lists of nodes in step.
class Walk {
 public:
  Walk(const Decoded& a, const Decoded& b) : a_(a), b_(b) {}

  std::optional<Difference> node(std::size_t i, std::size_t k, const std::string& path) {
    const Node& a = a_[i];
    const Node& b = b_[k];
    const bool same_shape = a.kind == b.kind && a.type == b.type && a.count == b.count;
    if (!same_shape) return differ(path, describe(a_, a), describe(b_, b));
    switch (a.kind) {
      case NodeKind::kNumber:
        if (same_number(*a.field, a.value, b.value)) return std::nullopt;
        return differ(path, describe(a_, a), describe(b_, b));
      case NodeKind::kNumberArray: return numbers(a, b, path);
      case NodeKind::kBytes:
        if (equal(a_.bytes.sub(a.offset, a.size), b_.bytes.sub(b.offset, b.size))) {
          return std::nullopt;
        }
        return differ(path, describe(a_, a), describe(b_, b));
      default: return children(i, k, path);
    }
  }

  std::optional<Difference> stale() {
    const auto text = [](const Decoded& decoded) {
      std::string all = "\"";
      for (std::size_t i = 0; i < decoded.stale_count(); ++i) {
        const reflect::Range range = decoded.stale()[i];
        const std::string part = hex(decoded.bytes.sub(range.offset, range.size));
        all.append(part, 1, part.size() - 2);
      }
      return all + '"';
    };
    if (text(a_) == text(b_)) return std::nullopt;
    return differ("stale", text(a_), text(b_));
  }

 private:
  static Difference differ(const std::string& path, std::string a, std::string b) {
    return {path, std::move(a), std::move(b)};
  }

  std::optional<Difference> numbers(const Node& a, const Node& b, const std::string& path) {
    const Field& field = *a.field;
    for (std::uint32_t i = 0; i < a.count; ++i) {
      const std::size_t at = i * field.width_bytes;
      const std::int64_t x = reflect::load_number(field, a_.bytes.data() + a.offset + at);
      const std::int64_t y = reflect::load_number(field, b_.bytes.data() + b.offset + at);
      if (same_number(field, x, y)) continue;
      return differ(path + '[' + std::to_string(i) + ']', plain_number(field, x),
                    plain_number(field, y));
    }
    return std::nullopt;
  }

  std::optional<Difference> children(std::size_t i, std::size_t k, const std::string& path) {
    std::size_t x = i + 1;
    std::size_t y = k + 1;
    const bool is_array = a_[i].kind == NodeKind::kStructArray;
    for (std::size_t n = 0; x < a_[i].end && y < b_[k].end; ++n) {
      const Field* field = a_[x].field;
      const std::string inner = is_array ? path + '[' + std::to_string(n) + ']'
                                         : path + (path.empty() ? "" : ".") + field->name;
      if (field != b_[y].field) return differ(inner, "this field", b_[y].field->name);
      if (auto found = node(x, y, inner)) return found;
      x = a_[x].end;
      y = b_[y].end;
    }
    if (x < a_[i].end) return differ(path + '.' + a_[x].field->name, describe(a_, a_[x]), "none");
    if (y < b_[k].end) return differ(path + '.' + b_[y].field->name, "none", describe(b_, b_[y]));
    return std::nullopt;
  }

  const Decoded& a_;
  const Decoded& b_;
};

// Returns the first difference in order of the bytes, stale bytes last. Floats are the same if
// they are the same number or both none, since text keeps no more of them.
std::optional<Difference> first_difference(const Decoded& a, const Decoded& b) {
  Walk walk(a, b);
  if (a.node_count() && b.node_count()) {
    if (auto found = walk.node(0, 0, {})) return found;
  }
  return walk.stale();
}

constexpr std::int64_t kFrameTypeMask = 7;  // IEEE 802.15.4-2006, section 7.2.1.1.1.
constexpr std::int64_t kFrameTypeAck = 2;

std::string sentence(const std::string& path, const std::string& problem, ReqId rule) {
  std::string text = path.empty() ? problem : path + ": " + problem;
  if (rule != ReqId::kNone) text += std::string(" (") + reflect::requirement(rule).id + ')';
  return text;
}

// Returns the members of an object that may be missing or null.
const Value& object_of(const Value& line, std::string_view key) {
  static const Value kNothing = Value::of_object();
  const Value* value = given(line, key);
  if (!value) return kNothing;
  if (value->is(Value::Kind::kObject)) return *value;
  throw RecordError(std::string(key), "expected an object or null, given " + value_text(*value));
}

RecordError no_raw(const std::string& why) { return RecordError("raw", "is missing, and " + why); }

Value without_nulls(const Value& object) {
  Value kept = Value::of_object();
  for (std::size_t i = 0; i < object.keys.size(); ++i) {
    if (!object.items[i].is(Value::Kind::kNull)) kept.set(object.keys[i], object.items[i]);
  }
  return kept;
}

std::int32_t narrow(std::optional<std::int64_t> value) {
  return value ? static_cast<std::int32_t>(*value) : kAbsent;
}

void read_serial(const Value& frame, bool whole, Packet& packet) {
  packet.kind = narrow(integer_of(frame, "frame", "kind", 0xff));
  if (packet.kind == kAbsent && !frame.find("kind")) packet.kind = kSerialPacketNoAck;
  packet.serial_seq = narrow(integer_of(frame, "frame", "serial_seq", 0xff));
  const bool has_seq = serial_kind_has_seq(packet.kind);
  if (packet.serial_seq != kAbsent && !has_seq) {
    throw RecordError("frame.serial_seq",
                      "expected none, as frames of kind " + std::to_string(packet.kind) +
                          " have none, given " + std::to_string(packet.serial_seq),
                      "WIRE-SERIAL-SEQ"_rule);
  }
  if (whole && has_seq && packet.serial_seq == kAbsent) {
    throw RecordError("frame.serial_seq",
                      "is missing: expected a number from 0 to 255, as frames of kind " +
                          std::to_string(packet.kind) + " have one",
                      "WIRE-SERIAL-SEQ"_rule);
  }
}

// Returns the link type under which a capture file keeps a malformed radio frame as it is.
std::uint16_t link_type_for(Fault fault, ReqId rule, const Packet& packet) {
  if (packet.framing != Framing::kRadio) return 0;
  if (rule == "WIRE-RADIO-TAP"_rule) return kLinkRadioTap;
  if (fault == Fault::kCut) return kLinkRadioNoFcs;
  return fault == Fault::kTooLong && packet.fcs == kAbsent ? kLinkRadioNoFcs : kLinkRadioFcs;
}

void read_facts(const Value& frame, RadioFacts& facts) {
  const Value* const rssi = given(frame, "rssi");
  if (rssi && rssi->is(Value::Kind::kInteger)) facts.rssi = static_cast<float>(rssi->integer);
  if (rssi && rssi->is(Value::Kind::kReal)) facts.rssi = std::strtof(rssi->text.c_str(), nullptr);
  facts.lqi = static_cast<std::int16_t>(narrow(integer_of(frame, "frame", "lqi", 0xff)));
  facts.channel = narrow(integer_of(frame, "frame", "channel", 0xffff));
  facts.slot = integer_of(frame, "frame", "slot", INT64_MAX).value_or(kAbsent);
}

void read_around(const Value& line, OwnedPacket& out) {
  Packet& packet = out.packet;
  packet = Packet{};
  packet.framing = framing_of(line);
  packet.direction = direction_of(line);
  packet.time_ns = time_of(line.find("time"));
  packet.offset_bytes =
      static_cast<std::uint64_t>(integer_of(line, "", "offset", INT64_MAX).value_or(0));
  out.interface_name = text_of(line, "interface");
  out.comment = text_of(line, "comment");
  const Fault fault = fault_of(line);
  const Value& frame = object_of(line, "frame");
  packet.dropped_bytes =
      static_cast<std::uint64_t>(integer_of(frame, "frame", "dropped", INT64_MAX).value_or(0));
  if (packet.framing == Framing::kHdlc) read_serial(frame, !is_framing_fault(fault), packet);
  if (packet.framing == Framing::kHdlc || packet.framing == Framing::kRadio) {
    const char* key = packet.framing == Framing::kHdlc ? "crc" : "fcs";
    (packet.framing == Framing::kHdlc ? packet.crc : packet.fcs) =
        narrow(integer_of(frame, "frame", key, 0xffff));
  }
  if (packet.framing == Framing::kRadio) read_facts(frame, packet.radio);
  if (is_framing_fault(fault)) {
    const ReqId rule = reflect::find_requirement(text_of(object_of(line, "error"), "requirement"));
    packet.error = Error{fault, 0, rule};
    packet.link_type = link_type_for(fault, rule, packet);
  }
}

// Settles the check sum. A missing one is computed. One that does not fit, without an error that
// says so, was most likely forgotten when something else was changed.
void settle_check_sum(const Value& line, OwnedPacket& out) {
  if (out.packet.framing != Framing::kHdlc && out.packet.framing != Framing::kRadio) return;
  if (is_framing_fault(out.packet.error.fault)) return;
  const bool serial = out.packet.framing == Framing::kHdlc;
  const char* key = serial ? "crc" : "fcs";
  std::int32_t& sum = serial ? out.packet.crc : out.packet.fcs;
  const std::int32_t computed = check_sum(out.view());
  if (!object_of(line, "frame").find(key)) sum = computed;
  if (sum == computed || (sum == kAbsent && !serial)) return;
  constexpr std::int32_t kGoodCrc = 0x8000;
  if (!serial && out.packet.has_cc24xx_trailer() && (sum & kGoodCrc) != 0) {
    out.packet.link_type = kLinkRadioFcs;
    return;
  }
  throw RecordError(std::string("frame.") + key,
                    "expected " + std::to_string(computed) + ", given " +
                        (sum == kAbsent ? "none" : std::to_string(sum)) + "; delete \"" + key +
                        "\" to have it computed, or let \"error\" name the fault \"" + key + '"',
                    serial ? "WIRE-SERIAL-CRC"_rule : "WIRE-RADIO-FCS"_rule);
}

// Returns where in a line the place `path` of the packet's structure is.
std::string place_of(const std::string& path, bool is_whole) {
  return is_whole && !path.empty() && path != "stale" ? "fields." + path : path_in_line(path);
}

void read_hex(const Value& line, std::string_view key, std::vector<std::uint8_t>& out) {
  out.clear();
  const std::string_view text = text_of(line, key);
  if (reflect::parse_hex(text, out)) return;
  throw RecordError(std::string(key),
                    "expected hex digits, two a byte, given \"" + std::string(text) + '"');
}

}  // namespace

RecordError::RecordError(const std::string& path, const std::string& problem, ReqId rule)
    : std::runtime_error(sentence(path, problem, rule)) {}

RecordReader::RecordReader(const reflect::Protocol& protocol) : protocol_(protocol) {}

void RecordReader::read(const Value& line, OwnedPacket& out) {
  if (!line.is(Value::Kind::kObject)) {
    throw RecordError("", "expected an object, given " + value_text(line));
  }
  const std::string_view schema = text_of(line, "schema");
  if (schema != kSchema) {
    throw RecordError("schema", "expected \"" + std::string(kSchema) + "\", given " +
                                    (schema.empty() ? "none" : '"' + std::string(schema) + '"'));
  }
  read_around(line, out);
  read_hex(line, "stale", stale_);
  if (!given(line, "raw")) {
    out.bytes.clear();
    build(line, out, out.bytes);
    return settle_check_sum(line, out);
  }
  read_hex(line, "raw", out.bytes);
  settle_check_sum(line, out);
  if (given(line, "fields") && !given(line, "error")) compare(line, out);
}

const Type* RecordReader::bare_type(const Value& line) const {
  const Value* path = given(line, "path");
  const bool has_path = path && path->is(Value::Kind::kArray) && !path->items.empty();
  const std::string_view name = has_path ? path->items[0].text : text_of(line, "message");
  return name.empty() ? nullptr : reflect::find_type(protocol_, name);
}

RecordReader::Plan RecordReader::plan_radio(const Value& line, const Value& am) const {
  const Value& frame = object_of(line, "frame");
  const Value* fields = given(line, "fields");
  const auto fcf = integer_of(frame, "frame", "fcf", 0xffff);
  if (fcf && (*fcf & kFrameTypeMask) == kFrameTypeAck) {
    Value values = Value::of_object();
    values.set("fcf", Value::of_integer(*fcf));
    if (const Value* dsn = given(frame, "dsn")) values.set("dsn", *dsn);
    return {reflect::find_carrier(tinyos::tables::kProtocol, "radio_ack"), std::move(values),
            nullptr, false};
  }
  for (const char* carrier : {"radio_beacon", "radio_command"}) {
    const Type* type = reflect::find_carrier(protocol_, carrier);
    if (type && fields && type == bare_type(line)) return {type, *fields, nullptr, true};
  }
  const bool has_network = !frame.find("network") || given(frame, "network");
  const Type* type = reflect::find_carrier(protocol_, has_network ? "radio_i" : "radio_t");
  if (type && fields && !reflect::has_tinyos_headers(*type)) return {type, *fields, nullptr, true};
  const Value payload = fields ? *fields : Value{};
  return {type, radio_values(with_am_type(line, am, type), frame, has_network, payload), nullptr,
          false};
}

// Returns the parts of the frame, without raw.
RecordReader::Plan RecordReader::plan(const Value& line, Framing framing) const {
  const Value* fields = given(line, "fields");
  const Value am = without_nulls(object_of(line, "am"));
  if (framing == Framing::kBare) {
    const Type* message = bare_type(line);
    if (!message || !fields) throw no_raw("there are no fields of a known message");
    return {message, *fields, nullptr, true};
  }
  const bool nothing = !fields && am.keys.empty();
  // A radio acknowledgement is only a frame control field and a number.
  if (nothing && (framing != Framing::kRadio || !given(object_of(line, "frame"), "fcf") ||
                  given(object_of(line, "frame"), "dest"))) {
    throw no_raw("there are neither fields nor am");
  }
  Plan made;
  if (framing == Framing::kRadio) {
    made = plan_radio(line, am);
  } else {
    made.type = reflect::find_carrier(protocol_, "serial");
    if (made.type && fields && !reflect::has_tinyos_headers(*made.type)) {
      return {made.type, *fields, nullptr, true};
    }
    made.more = reflect::payload_choice(protocol_, "radio_i");
    made.values = serial_values(with_am_type(line, am, made.type), object_of(line, "frame"),
                                fields ? *fields : Value{});
  }
  if (!made.type) throw no_raw(std::string(protocol_.id) + " does not travel in these frames");
  return made;
}

// Adds the AM type that a named message implies.
Value RecordReader::with_am_type(const Value& line, Value am, const Type* carrier) const {
  const Type* message = bare_type(line);
  if (!message || !carrier || given(am, "type")) return am;
  if (const auto am_type = am_type_on(*carrier, *message)) {
    am.set("type", Value::of_integer(*am_type));
  }
  return am;
}

bool RecordReader::build(const Value& line, const OwnedPacket& around,
                         std::vector<std::uint8_t>& out) const {
  const Framing framing = around.packet.framing;
  const bool is_bare = framing == Framing::kBare;
  // An acknowledgement of the serial line has no packet.
  if (framing == Framing::kHdlc && !given(line, "fields") && object_of(line, "am").keys.empty()) {
    return false;
  }
  const Plan made = plan(line, framing);
  try {
    reflect::encode(*made.type, made.values, Bytes(stale_.data(), stale_.size()),
                    is_bare ? reflect::Tail::kStale : reflect::Tail::kFault, out, made.more);
  } catch (const reflect::EncodeError& error) {
    throw RecordError(place_of(error.path(), made.is_whole), error.problem(), error.requirement());
  }
  return made.is_whole;
}

void RecordReader::compare(const Value& line, const OwnedPacket& out) {
  built_.clear();
  const bool is_whole = build(line, out, built_);
  if (built_ == out.bytes) return;
  Packet packet = out.view();
  const bool bare = packet.framing == Framing::kBare;
  const reflect::FrameDecoder decoder(protocol_, bare ? bare_type(line) : nullptr);
  decoder.decode(packet, from_raw_);
  packet.bytes = Bytes(built_.data(), built_.size());
  decoder.decode(packet, from_fields_);
  const auto found = first_difference(from_fields_.decoded, from_raw_.decoded);
  if (!found) return;
  throw RecordError(place_of(found->path, is_whole),
                    "given " + found->in_a + ", but \"raw\" says " + found->in_b +
                        "; delete \"raw\" if the fields are meant");
}

}  // namespace rubric::encode
