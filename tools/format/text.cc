#include "tools/format/text.h"

#include <fmt/format.h>

#include "codec/reflect/fault_text.h"
#include "tools/format/hexdump.h"
#include "tools/format/plain_value.h"
#include "tools/format/put.h"
#include "tools/format/text_fields.h"

namespace rubric::format {
namespace {

using reflect::Frame;

constexpr std::uint16_t kAmBroadcast = 0xffff;

// Fills up to `column` characters since `start`, and one more space.
void pad(Buffer& out, std::size_t start, std::size_t column) {
  const std::size_t used = out.size() - start;
  out.append(used < column ? column - used + 1 : 1, ' ');
}

// Appends microseconds, unless there is more to show.
void append_time(std::int64_t time_ns, Buffer& out) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const std::int64_t seconds = time_ns / kSecond;
  const std::int64_t rest = time_ns % kSecond;
  const char* sign = time_ns < 0 ? "-" : "";
  const auto whole = static_cast<std::uint64_t>(seconds < 0 ? -seconds : seconds);
  const auto part = static_cast<std::uint64_t>(rest < 0 ? -rest : rest);
  const std::string text = part % 1000 ? fmt::format("{}{}.{:09}", sign, whole, part)
                                       : fmt::format("{}{}.{:06}", sign, whole, part / 1000);
  out.append(fmt::format("{:>11} ", text));
}

void append_origin(const Record& record, Buffer& out) {
  const Packet& packet = record.packet();
  const bool named = !record.interface_name.empty();
  if (named) {
    const std::size_t start = out.size();
    append_harmless(record.interface_name, out);
    pad(out, start, 8);
  }
  switch (packet.direction) {
    case Direction::kInbound: out.append("<- "); break;
    case Direction::kOutbound: out.append("-> "); break;
    case Direction::kUnknown: out.append(named ? "   " : ""); break;
  }
}

void append_framing(const Packet& packet, Buffer& out) {
  const std::size_t start = out.size();
  out.append(framing_name(packet.framing));
  if (packet.serial_seq != kAbsent) out.append(fmt::format("#{}", packet.serial_seq));
  pad(out, start, packet.framing == Framing::kSf ? 2 : 6);
}

void append_addresses(const Frame& frame, Buffer& out) {
  if (frame.packet->framing == Framing::kBare) return;
  const std::size_t start = out.size();
  if (frame.am.present) {
    const std::string dest =
        frame.am.dest == kAmBroadcast ? "bcast" : std::to_string(frame.am.dest);
    out.append(fmt::format("{:>3}>{}", frame.am.src, dest));
  }
  pad(out, start, 9);
}

// Returns the kind of a frame that holds no known message.
std::string other_name(const Frame& frame) {
  const Packet& packet = *frame.packet;
  if (packet.framing == Framing::kHdlc && dispatch_of(packet) == kAbsent) {
    const std::string_view kind = serial_kind_name(packet.kind);
    if (!kind.empty()) return std::string(kind);
    return packet.kind == kAbsent ? "frame" : fmt::format("kind {}", packet.kind);
  }
  if (frame.am.present) return fmt::format("am {}", frame.am.type);
  if (packet.framing == Framing::kRadio && frame.mac.present) {
    return fmt::format("802.15.4 fcf 0x{:04x}", frame.mac.fcf);
  }
  return "bytes";
}

void append_message(const Record& record, Styled& styled) {
  const reflect::Decoded& decoded = record.decoded();
  const std::size_t count = decoded.path_count();
  std::size_t width = 0;
  for (std::size_t i = 0; i + 1 < count; ++i) {
    const std::string outer = fmt::format("{}/", decoded.path()[i]->name);
    styled.put(Style::kDim, outer);
    width += outer.size();
  }
  const std::string name = count ? std::string(decoded.message()->name) : other_name(*record.frame);
  styled.put(count ? Style::kMessage : Style::kPlain, name);
  width += name.size();
  constexpr std::size_t kColumn = 23;
  styled.out().append(width < kColumn ? kColumn - width + 1 : 1, ' ');
}

void append_opaque(const Record& record, Styled& styled) {
  const Frame& frame = *record.frame;
  const reflect::Decoded& decoded = record.decoded();
  Bytes bytes = record.packet().bytes;
  if (frame.has_payload && decoded.node_count() > frame.payload_node) {
    const reflect::Node& node = decoded[frame.payload_node];
    bytes = decoded.bytes.sub(node.offset, node.size);
  }
  if (record.packet().framing == Framing::kRadio && decoded.message()) {
    styled.out().append(fmt::format("dsn={} ", frame.mac.dsn));
    return;
  }
  if (!bytes.empty()) append_hex_short(bytes, kMaxHexBytes, styled.out());
  if (!bytes.empty()) styled.out().append(' ');
}

void append_stale(const Record& record, Styled& styled) {
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < record.decoded().stale_count(); ++i) {
    bytes += record.decoded().stale()[i].size;
  }
  if (bytes) styled.put(Style::kDim, fmt::format("+{} stale ", bytes));
}

void append_notes(const Record& record, Styled& styled) {
  for (std::size_t i = 0; i < record.decoded().note_count(); ++i) {
    const reflect::Note& note = record.decoded().notes()[i];
    styled.put(Style::kNote, fmt::format("* {} at {}: {} ", reflect::note_name(note.kind),
                                         note.offset, reflect::note_text(note)));
  }
}

void append_error(const Record& record, Styled& styled) {
  const Frame& frame = *record.frame;
  if (!frame.malformed()) return;
  styled.put(Style::kError, fmt::format("!! {} at {}: {} ", reflect::fault_name(frame.error.fault),
                                        frame.error.offset_bytes, reflect::error_text(frame)));
}

void append_rule(const Record& record, Styled& styled) {
  const Frame& frame = *record.frame;
  if (!frame.malformed() || frame.error.requirement == ReqId::kNone) return;
  const reflect::Requirement& rule = reflect::requirement(frame.error.requirement);
  styled.out().append(8, ' ');
  styled.put(Style::kError, rule.id);
  styled.out().append(fmt::format(" {}: {}\n", rule.level, rule.sentence));
}

void end_line(Buffer& out) {
  std::size_t size = out.size();
  while (size && out.view()[size - 1] == ' ') --size;
  out.shrink(size);
  out.append('\n');
}

}  // namespace

TextFormatter::TextFormatter(const reflect::Protocol& protocol, TextOptions options)
    : options_(std::move(options)), nodes_(protocol, options_.units) {}

void TextFormatter::print(const Record& record, Buffer& out) {
  Styled styled(out, options_.color);
  const Frame& frame = *record.frame;
  const bool malformed = frame.malformed();
  styled.put(malformed ? Style::kError : Style::kDim,
             fmt::format("{}{:>5} ", malformed ? '!' : ' ', record.number));
  if (record.time_ns != kNoTime) append_time(record.time_ns, out);
  if (options_.fields.empty()) {
    append_origin(record, out);
    append_framing(record.packet(), out);
    append_addresses(frame, out);
    append_message(record, styled);
    const bool fields = frame.has_payload && frame.payload_node < record.decoded().node_count() &&
                        record.decoded()[frame.payload_node].type != nullptr;
    if (fields) {
      append_fields(record, {options_.units, options_.hex && options_.color}, styled);
    } else {
      append_opaque(record, styled);
    }
    append_stale(record, styled);
    append_notes(record, styled);
  } else {
    for (const Path& path : options_.fields) {
      if (path.text() == "number" || path.text() == "time") continue;
      styled.put(Style::kDim, path.text() + "=");
      append_plain_values(path, record, nodes_, out);
      out.append(' ');
    }
  }
  append_error(record, styled);
  end_line(out);
  append_rule(record, styled);
  if (options_.hex) append_hexdump(record, options_.color, out);
}

}  // namespace rubric::format
