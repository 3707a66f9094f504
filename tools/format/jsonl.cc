#include "tools/format/jsonl.h"

#include <fmt/format.h>

#include <algorithm>

#include "codec/reflect/fault_text.h"
#include "codec/text/text.h"
#include "tools/format/plain_value.h"
#include "tools/format/put.h"

namespace rubric::format {
namespace {

using reflect::Decoded;
using reflect::Frame;

/// For all members that are numbers, or text of bounded length.
constexpr std::size_t kFixedRoom = 2048;

char* put_or_null(char* at, std::int32_t value) {
  return value == kAbsent ? put(at, "null") : put_uint(at, static_cast<std::uint32_t>(value));
}

// `{"kind":69,"kind_name":"packet_noack","serial_seq":` for each kind; the last is for none.
struct KindPieces {
  static constexpr std::size_t kNone = 256;
  Piece pieces[kNone + 1];
  KindPieces() {
    for (std::size_t kind = 0; kind <= kNone; ++kind) {
      const std::string number = kind == kNone ? "null" : std::to_string(kind);
      const std::string_view name = serial_kind_name(static_cast<std::int32_t>(kind));
      pieces[kind].set(fmt::format("{{\"kind\":{},\"kind_name\":{}", number,
                                   name.empty() ? "null" : fmt::format("\"{}\"", name)));
    }
  }
};

char* put_hdlc(char* at, const Packet& packet) {
  static const KindPieces kKinds;
  const bool known = packet.kind >= 0 && packet.kind < 256;
  at = put(at, kKinds.pieces[known ? static_cast<std::size_t>(packet.kind) : KindPieces::kNone]);
  at = put_or_null(put(at, ",\"serial_seq\":"), packet.serial_seq);
  at = put_or_null(put(at, ",\"crc\":"), packet.crc);
  at = put_or_null(put(at, ",\"dispatch\":"), dispatch_of(packet));
  if (packet.error.fault == Fault::kAborted) at = put(at, ",\"aborted\":true");
  return at;
}

char* put_facts(char* at, const RadioFacts& facts) {
  if (facts.rssi) at = put_double(put(at, ",\"rssi\":"), *facts.rssi);
  const auto number = [&](const char* key, std::int64_t value) {
    if (value != kAbsent) at = put_int(put(at, std::string_view(key)), value);
  };
  number(",\"lqi\":", facts.lqi);
  number(",\"channel\":", facts.channel);
  number(",\"slot\":", facts.slot);
  return at;
}

char* put_radio(char* at, const Frame& frame) {
  const reflect::MacHeader& mac = frame.mac;
  const bool far = mac.has_addresses;
  at = put_or_null(put(at, "{\"fcf\":"), mac.present ? mac.fcf : kAbsent);
  at = put_or_null(put(at, ",\"dsn\":"), mac.present ? mac.dsn : kAbsent);
  at = put_or_null(put(at, ",\"destpan\":"), far ? mac.destpan : kAbsent);
  at = put_or_null(put(at, ",\"dest\":"), far ? mac.dest : kAbsent);
  at = put_or_null(put(at, ",\"src\":"), far ? mac.src : kAbsent);
  at = put_or_null(put(at, ",\"network\":"), network_of(frame));
  at = put_or_null(put(at, ",\"fcs\":"), frame.packet->fcs);
  return frame.packet->radio.any() ? put_facts(at, frame.packet->radio) : at;
}

char* put_framing(char* at, const Frame& frame) {
  const Packet& packet = *frame.packet;
  switch (packet.framing) {
    case Framing::kHdlc: at = put_hdlc(put(at, ",\"framing\":\"hdlc\",\"frame\":"), packet); break;
    case Framing::kSf:
      at = put(at, ",\"framing\":\"sf\",\"frame\":{\"dispatch\":");
      at = put_or_null(at, dispatch_of(packet));
      break;
    case Framing::kRadio:
      at = put_radio(put(at, ",\"framing\":\"radio\",\"frame\":"), frame);
      break;
    case Framing::kBare: at = put(at, ",\"framing\":\"bare\",\"frame\":{"); break;
  }
  if (packet.dropped_bytes) {
    if (at[-1] != '{') *at++ = ',';
    at = put_uint(put(at, "\"dropped\":"), packet.dropped_bytes);
  }
  *at++ = '}';
  return at;
}

char* put_am(char* at, const reflect::ActiveMessage& am) {
  if (!am.present) return put(at, ",\"am\":null");
  at = put_uint(put(at, ",\"am\":{\"dest\":"), am.dest);
  at = put_uint(put(at, ",\"src\":"), am.src);
  at = put_uint(put(at, ",\"length\":"), am.length);
  at = put_uint(put(at, ",\"group\":"), am.group);
  at = put_uint(put(at, ",\"type\":"), am.type);
  *at++ = '}';
  return at;
}

// Names are ASCII identifiers, which the spec's compiler enforces.
std::string make_path_text(const Decoded& decoded) {
  const std::size_t count = decoded.path_count();
  if (count == 0) return ",\"message\":null,\"path\":[]";
  std::string text = fmt::format(",\"message\":\"{}\",\"path\":", decoded.message()->name);
  for (std::size_t i = 0; i < count; ++i) {
    text += fmt::format("{}\"{}\"", i ? "," : "[", decoded.path()[i]->name);
  }
  return text + "]";
}

char* put_stale_and_raw(char* at, const Decoded& decoded) {
  at = put(at, ",\"stale\":\"");
  for (std::size_t i = 0; i < decoded.stale_count(); ++i) {
    const reflect::Range range = decoded.stale()[i];
    at = put_hex(at, decoded.bytes.sub(range.offset, range.size));
  }
  at = put_hex(put(at, "\",\"raw\":\""), decoded.bytes);
  *at++ = '"';
  return at;
}

// Notes and errors are rare and made of text: they may cost.
void append_text_member(Buffer& out, std::string_view key, std::string_view text) {
  out.append(key);
  char* at = out.reserve(6 * text.size() + 2);
  out.commit(text::put_json_string(at, text));
}

void append_uint(Buffer& out, std::uint64_t value) {
  out.commit(put_uint(out.reserve(kMaxIntChars), value));
}

void append_notes(const Decoded& decoded, Buffer& out) {
  out.append(",\"notes\":[");
  for (std::size_t i = 0; i < decoded.note_count(); ++i) {
    const reflect::Note& note = decoded.notes()[i];
    if (i) out.append(',');
    append_text_member(out, "{\"note\":", reflect::note_name(note.kind));
    out.append(",\"offset\":");
    append_uint(out, note.offset);
    append_text_member(out, ",\"text\":", reflect::note_text(note));
    out.append('}');
  }
  out.append(']');
}

void append_error(const Frame& frame, Buffer& out) {
  append_text_member(out, ",\"error\":{\"fault\":", reflect::fault_name(frame.error.fault));
  out.append(",\"offset\":");
  append_uint(out, frame.error.offset_bytes);
  if (frame.error.requirement == ReqId::kNone) {
    out.append(",\"requirement\":null");
  } else {
    const char* id = reflect::requirement(frame.error.requirement).id;
    append_text_member(out, ",\"requirement\":", id);
  }
  append_text_member(out, ",\"text\":", reflect::error_text(frame));
  out.append('}');
}

}  // namespace

JsonlFormatter::JsonlFormatter(const reflect::Protocol& protocol, bool units,
                               std::vector<Path> fields)
    : nodes_(protocol, units), fields_(std::move(fields)) {}

const std::string& JsonlFormatter::path_text(const Decoded& decoded) {
  constexpr std::size_t kSlots = 64;
  if (path_texts_.empty()) path_texts_.resize(kSlots);
  const std::size_t count = decoded.path_count();
  const reflect::Type* const* path = decoded.path();
  const auto address = reinterpret_cast<std::uintptr_t>(decoded.message());
  PathText& known = path_texts_[(address / alignof(reflect::Type) + count) % kSlots];
  if (known.count == count && !known.text.empty() && std::equal(path, path + count, known.path)) {
    return known.text;
  }
  known.count = count;
  std::copy(path, path + count, known.path);
  known.text = make_path_text(decoded);
  return known.text;
}

void JsonlFormatter::print(const Record& record, Buffer& out) {
  if (!fields_.empty()) return print_selected(record, out);
  const Frame& frame = *record.frame;
  const Packet& packet = record.packet();
  const Decoded& decoded = record.decoded();
  const std::string& path = path_text(decoded);
  char* at = out.reserve(kFixedRoom + 6 * record.interface_name.size() + path.size() +
                         nodes_.room(decoded));
  at = put_uint(put(at, "{\"schema\":\"rubric.decode/1\",\"index\":"), record.index);
  at = put_uint(put(at, ",\"offset\":"), packet.offset_bytes);
  at = put(at, ",\"time\":");
  if (!record.time_text.empty()) {
    at = text::put_json_string(at, record.time_text);
  } else {
    at = record.time_ns == kNoTime ? put(at, "null") : put_time(at, record.time_ns);
  }
  at = put(at, ",\"interface\":");
  at = record.interface_name.empty() ? put(at, "null")
                                     : text::put_json_string(at, record.interface_name);
  switch (packet.direction) {
    case Direction::kInbound: at = put(at, ",\"direction\":\"inbound\""); break;
    case Direction::kOutbound: at = put(at, ",\"direction\":\"outbound\""); break;
    case Direction::kUnknown: at = put(at, ",\"direction\":null"); break;
  }
  at = put(put_am(put_framing(at, frame), frame.am), std::string_view(path));
  at = put(at, ",\"fields\":");
  const std::size_t root = frame.payload_node;
  const bool has_fields = frame.has_payload && root < decoded.node_count() &&
                          decoded[root].kind == reflect::NodeKind::kStruct;
  at = has_fields ? nodes_.value(at, decoded, root) : put(at, "null");
  if (decoded.note_count()) {
    out.commit(at);
    append_notes(decoded, out);
    at = out.reserve(kFixedRoom + 4 * decoded.bytes.size());
  } else {
    at = put(at, ",\"notes\":[]");
  }
  at = put_stale_and_raw(at, decoded);
  if (!frame.has_error()) {
    out.commit(put(at, ",\"error\":null}\n"));
    return;
  }
  out.commit(at);
  append_error(frame, out);
  out.append("}\n");
}

void JsonlFormatter::print_selected(const Record& record, Buffer& out) const {
  out.append("{\"schema\":\"rubric.decode/1\",\"index\":");
  append_uint(out, record.index);
  for (const Path& path : fields_) {
    if (path.text() == "index") continue;
    append_text_member(out, ",", path.text());
    out.append(':');
    append_json_value(path, record, nodes_, out);
  }
  out.append("}\n");
}

namespace {

void append_json_bits(const reflect::Field& field, std::int64_t value, Buffer& out) {
  const char* separator = "[";
  for (int bit = 0; bit < field.mask->width_bits; ++bit) {
    if (!(value >> bit & 1)) continue;
    out.append(separator);
    separator = ",";
    const char* name = field.mask->bit_names[bit];
    append_text_member(out, {}, name ? std::string(name) : "bit" + std::to_string(bit));
  }
  out.append(*separator == '[' ? "[]" : "]");
}

void append_json(const Value& value, const Record& record, const JsonNodes& nodes, Buffer& out) {
  switch (value.kind) {
    case Value::Kind::kAbsent: out.append("null"); break;
    case Value::Kind::kInteger:
    case Value::Kind::kTime:
    case Value::Kind::kUnit: append_plain_value(value, record, nodes, out); break;
    case Value::Kind::kReal: {
      char* const at = out.reserve(kMaxFloatChars);
      out.commit(value.field ? put_float(at, bits_of_float(static_cast<float>(value.real)))
                             : put_double(at, value.real));
      break;
    }
    case Value::Kind::kText: append_text_member(out, {}, value.text); break;
    case Value::Kind::kBits: append_json_bits(*value.field, value.integer, out); break;
    case Value::Kind::kBytes: {
      out.append('"');
      out.commit(put_hex(out.reserve(2 * value.bytes.size()), value.bytes));
      out.append('"');
      break;
    }
    case Value::Kind::kNode: {
      char* at = out.reserve(nodes.room(record.decoded()));
      out.commit(nodes.value(at, record.decoded(), value.node));
      break;
    }
  }
}

}  // namespace

void append_json_value(const Path& path, const Record& record, const JsonNodes& nodes,
                       Buffer& out) {
  const bool list = path.is_list();
  std::size_t count = 0;
  if (list) out.append('[');
  auto each = [&](const Value& value) {
    if (count++) out.append(',');
    append_json(value, record, nodes, out);
    return list;
  };
  path.visit_first(record, each);
  if (list) {
    out.append(']');
  } else if (count == 0) {
    out.append("null");
  }
}

}  // namespace rubric::format
