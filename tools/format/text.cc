#include "tools/format/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "codec/reflect/fault_text.h"
#include "codec/reflect/text_field.h"
#include "codec/text/text.h"
#include "tools/format/json_nodes.h"
#include "tools/format/plain_value.h"
#include "tools/format/put.h"
#include "tools/format/record.h"
#include "tools/format/style.h"

namespace rubric::format {
namespace {

using reflect::Decoded;
using reflect::Field;
using reflect::Frame;
using reflect::Kind;
using reflect::Node;
using reflect::NodeKind;

// Prints the bytes of a frame, and the field of each.

constexpr std::size_t kRowBytes = 16;
constexpr std::size_t kLineChars = 100;
constexpr std::string_view kIndent = "        ";
constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";
constexpr int kNobody = -1;
constexpr int kStale = -2;

/// Returns a byte's field, by the order of leaves; kNobody or kStale.
std::vector<int> owners(const Record& record, std::vector<std::string>& names) {
  const Decoded& decoded = record.decoded();
  std::vector<int> owner(decoded.bytes.size(), kNobody);
  std::vector<std::size_t> around;
  for (std::size_t i = 0; i < decoded.node_count(); ++i) {
    const Node& node = decoded[i];
    while (!around.empty() && i >= decoded[around.back()].end) around.pop_back();
    if (node.kind == NodeKind::kStruct || node.kind == NodeKind::kStructArray) {
      around.push_back(i);
      continue;
    }
    // One more name than the field's own is enough: "dest.pid".
    const reflect::Field* outer = around.empty() ? nullptr : decoded[around.back()].field;
    std::string name =
        outer ? fmt::format("{}.{}", outer->name, node.field->name) : std::string(node.field->name);
    for (std::uint32_t k = 0; k < node.size; ++k) {
      owner[node.offset + k] = static_cast<int>(names.size());
    }
    names.push_back(std::move(name));
  }
  for (std::size_t i = 0; i < decoded.stale_count(); ++i) {
    const reflect::Range range = decoded.stale()[i];
    for (std::uint32_t k = 0; k < range.size; ++k) owner[range.offset + k] = kStale;
  }
  return owner;
}

char letter(int owner) {
  if (owner == kStale) return '~';
  return owner < 0 ? ' ' : kLetters[static_cast<std::size_t>(owner) % kLetters.size()];
}

Style style_of(int owner) {
  if (owner == kStale) return Style::kDim;
  return owner < 0 ? Style::kPlain : Style::kField;
}

/// Prints the rows of one frame.
class Dump {
 public:
  Dump(const Record& record, bool color, Buffer& out)
      : record_(record), styled_(out, color), out_(out), owner_(owners(record, names_)) {}

  void print() {
    const std::size_t size = owner_.size();
    for (std::size_t row = 0; row < size; row += kRowBytes) {
      const std::size_t end = std::min(row + kRowBytes, size);
      bytes(row, end);
      if (!styled_.color()) letters(row, end);
    }
    if (!styled_.color()) key();
  }

 private:
  bool is_fault(std::size_t i) const {
    return record_.frame->has_error() && record_.frame->error.offset_bytes == i;
  }

  void bytes(std::size_t row, std::size_t end) {
    const Bytes bytes = record_.packet().bytes;
    out_.append(kIndent);
    styled_.put(Style::kDim, fmt::format("{:04x} ", row));
    for (std::size_t i = row; i < end; ++i) {
      out_.append(i == row + kRowBytes / 2 ? "  " : " ");
      const Style style = is_fault(i) ? Style::kError : style_of(owner_[i]);
      styled_.begin(style, static_cast<std::size_t>(std::max(owner_[i], 0)));
      out_.append(fmt::format("{:02x}", bytes[i]));
      styled_.end();
    }
    const std::size_t missing = kRowBytes - (end - row);
    out_.append(3 * missing + (end - row <= kRowBytes / 2) + 2, ' ');
    for (std::size_t i = row; i < end; ++i) {
      const char c = static_cast<char>(bytes[i]);
      out_.append(c >= ' ' && c <= '~' ? c : '.');
    }
    out_.append('\n');
  }

  void letters(std::size_t row, std::size_t end) {
    std::string line(kIndent);
    line += "     ";
    for (std::size_t i = row; i < end; ++i) {
      line += i == row + kRowBytes / 2 ? "  " : " ";
      line += letter(owner_[i]);
      // A dash where the field continues.
      const bool goes_on = owner_[i] >= 0 && i + 1 < owner_.size() && owner_[i + 1] == owner_[i];
      line += is_fault(i) ? '!' : goes_on ? '-' : ' ';
    }
    while (line.ends_with(' ')) line.pop_back();
    out_.append(line);
    out_.append('\n');
  }

  void key() {
    std::string line(kIndent);
    for (std::size_t i = 0; i < names_.size(); ++i) {
      const std::string entry = fmt::format("{} {}", letter(static_cast<int>(i)), names_[i]);
      if (line.size() + entry.size() > kLineChars) {
        out_.append(line);
        out_.append('\n');
        line = kIndent;
      }
      if (line.size() > kIndent.size()) line += "  ";
      line += entry;
    }
    if (line.size() == kIndent.size()) return;
    out_.append(line);
    out_.append('\n');
  }

  const Record& record_;
  Styled styled_;
  Buffer& out_;
  std::vector<std::string> names_;
  std::vector<int> owner_;
};

// Appends rows of sixteen bytes. With colour a byte has its field's; without, there is a row of
// letters below each, and a key to them at the end. '~' marks stale bytes, '!' the first byte of a
// fault.
void append_hexdump(const Record& record, bool color, Buffer& out) {
  Dump(record, color, out).print();
}

// Prints the fields of a frame on one line: name=value.

/// Bytes of an opaque field or frame that a line shows.
constexpr std::size_t kMaxHexBytes = 24;

struct FieldStyle {
  bool units = false;     ///< Values with a unit are shown converted.
  bool in_turns = false;  ///< Values in the colours of the hex dump.
};

// Appends hex of the first `most` bytes, and their number if there are more.
void append_hex_short(Bytes bytes, std::size_t most, Buffer& out) {
  if (bytes.empty()) return out.append("(empty)");
  const std::size_t shown = std::min(bytes.size(), most);
  out.commit(put_hex(out.reserve(2 * shown), bytes.first(shown)));
  if (shown < bytes.size()) out.append(fmt::format("..({} bytes)", bytes.size()));
}

constexpr std::uint32_t kMaxElements = 24;

/// Prints the nodes of one frame, counting leaves as the hex dump does.
class FieldPrinter {
 public:
  FieldPrinter(const Record& record, FieldStyle style, Styled& styled)
      : decoded_(record.decoded()), style_(style), styled_(styled), out_(styled.out()) {
    turn_ = 0;
    for (std::size_t i = 0; i < record.frame->payload_node; ++i) turn_ += is_leaf(decoded_[i]);
  }

  void message(std::size_t node) {
    for (std::size_t i = node + 1; i < decoded_[node].end; i = decoded_[i].end) member(i);
  }

 private:
  static bool is_leaf(const Node& node) {
    return node.kind == NodeKind::kNumber || node.kind == NodeKind::kNumberArray ||
           node.kind == NodeKind::kBytes;
  }
  bool is_message(const Node& node) const {
    const auto* end = decoded_.path() + decoded_.path_count();
    return node.type && std::find(decoded_.path(), end, node.type) != end;
  }
  bool is_pair(std::size_t node) const {
    return decoded_[node].end == node + 3 && decoded_[node + 1].kind == NodeKind::kNumber &&
           decoded_[node + 2].kind == NodeKind::kNumber;
  }

  void member(std::size_t i) {
    const Node& node = decoded_[i];
    if (node.kind == NodeKind::kStruct && is_message(node)) {
      styled_.put(Style::kDim, "| ");
      message(i);
      return;
    }
    if (node.kind == NodeKind::kStruct && node.end == i + 1) return;  // Cut off before its start.
    name(*node.field, node.kind == NodeKind::kStruct && !is_pair(i) ? "{" : "=");
    value(i);
    out_.append(' ');
  }

  void name(const Field& field, std::string_view behind) {
    styled_.begin(Style::kDim);
    out_.append(field.name);
    out_.append(behind);
    styled_.end();
  }

  // Prints a structure that is no pair after its opening brace.
  void value(std::size_t i) {
    const Node& node = decoded_[i];
    switch (node.kind) {
      case NodeKind::kNumber: leaf([&] { number(*node.field, node.value); }); break;
      case NodeKind::kNumberArray: leaf([&] { numbers(node); }); break;
      case NodeKind::kBytes:
        leaf([&] {
          if (is_text(node.field)) return text(node);
          append_hex_short(decoded_.bytes.sub(node.offset, node.size), kMaxHexBytes, out_);
        });
        break;
      case NodeKind::kStruct: structure(i); break;
      case NodeKind::kStructArray: structures(i); break;
    }
  }

  template <class Print>
  void leaf(Print print) {
    if (style_.in_turns) styled_.begin(Style::kField, turn_);
    ++turn_;
    print();
    if (style_.in_turns) styled_.end();
  }

  void structure(std::size_t i) {
    if (is_pair(i)) {
      value(i + 1);
      out_.append(':');
      value(i + 2);
      return;
    }
    message(i);
    if (out_.view().back() == ' ') out_.shrink(out_.size() - 1);
    styled_.put(Style::kDim, "}");
  }

  void structures(std::size_t i) {
    out_.append('[');
    for (std::size_t k = i + 1; k < decoded_[i].end; k = decoded_[k].end) {
      if (k != i + 1) out_.append(' ');
      if (!is_pair(k)) styled_.put(Style::kDim, "{");
      structure(k);
    }
    out_.append(']');
  }

  void number(const Field& field, std::int64_t value) {
    if (style_.units && field.unit) {
      if (field.kind == Kind::kFloat) {
        out_.append(fmt::format("{:.6g}", converted(field, value)));
      } else {
        out_.commit(put_converted(out_.reserve(kMaxFloatChars), field, value));
      }
      out_.append(field.unit->symbol);
    } else if (field.mask) {
      append_bits(*field.mask, value, out_);
    } else if (const char* name =
                   field.enumeration ? reflect::enum_name(*field.enumeration, value) : nullptr) {
      out_.append(name);
    } else if (field.kind == Kind::kFloat) {
      out_.append(fmt::format("{}", float_of_bits(static_cast<std::uint32_t>(value))));
    } else {
      out_.commit(put_integer(out_.reserve(kMaxIntChars), field, value));
    }
  }

  // Appends the text in quotes, and its bytes if it does not say them all.
  void text(const Node& node) {
    const Bytes bytes = decoded_.bytes.sub(node.offset, node.size);
    out_.append(quoted(reflect::shown_text(*node.field, bytes)));
    if (reflect::says_all(*node.field, bytes)) return;
    out_.append(" (");
    append_hex_short(bytes, kMaxHexBytes, out_);
    out_.append(')');
  }

  void numbers(const Node& node) {
    const std::uint8_t* at = decoded_.bytes.data() + node.offset;
    out_.append('[');
    for (std::uint32_t k = 0; k < node.count && k < kMaxElements; ++k) {
      if (k) out_.append(' ');
      number(*node.field, reflect::load_number(*node.field, at));
      at += node.field->width_bytes;
    }
    if (node.count > kMaxElements) out_.append(fmt::format(" ..{} in all", node.count));
    out_.append(']');
  }

  const Decoded& decoded_;
  const FieldStyle style_;
  Styled& styled_;
  Buffer& out_;
  std::size_t turn_ = 0;
};

// Appends all fields of the outermost message. Structures of two numbers are pairs, "dest=11:2";
// messages within the message follow after a bar.
void append_fields(const Record& record, FieldStyle style, Styled& styled) {
  FieldPrinter(record, style, styled).message(record.frame->payload_node);
}

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
    out.append(text::harmless(record.interface_name));
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

// Appends what the sniffer states, where it states anything, by the names that filters have:
// messages have fields of the same names.
void append_facts(const RadioFacts& facts, Styled& styled) {
  if (!facts.any()) return;
  std::string text;
  if (facts.rssi) text += fmt::format("frame.rssi={} ", *facts.rssi);
  if (facts.lqi != kAbsent) text += fmt::format("frame.lqi={} ", facts.lqi);
  if (facts.channel != kAbsent) text += fmt::format("frame.channel={} ", facts.channel);
  if (facts.slot != kAbsent) text += fmt::format("frame.slot={} ", facts.slot);
  styled.put(Style::kDim, text);
}

void append_error(const Record& record, Styled& styled) {
  const Frame& frame = *record.frame;
  if (!frame.has_error()) return;
  if (!frame.malformed()) return styled.put(Style::kNote, "* " + reflect::error_text(frame));
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

// Breaks the lines from `start` on at blanks, so that they fit so many columns. Escape sequences
// take no column, and a character of UTF-8 takes one.
void wrap(Buffer& out, std::size_t start, std::size_t width) {
  constexpr std::string_view kGoesOn = "          ";
  constexpr std::size_t kNowhere = std::string::npos;
  const std::string text(out.view().substr(start));
  std::string wrapped;
  std::size_t column = 0;
  std::size_t blank = kNowhere;  // The last place in `wrapped` where its last line may be broken.
  std::size_t after_blank = 0;   // The columns after it.
  bool escape = false;
  for (const char c : text) {
    wrapped += c;
    escape = escape || c == '\033';
    const bool shown = !escape && (static_cast<unsigned char>(c) & 0xC0) != 0x80;
    escape = escape && c != 'm';
    column = c == '\n' ? 0 : column + shown;
    after_blank += shown;
    if (c == '\n') blank = kNowhere;
    if (c == ' ' && shown && column > kGoesOn.size()) {
      blank = wrapped.size() - 1;
      after_blank = 0;
    }
    if (column <= width || blank == kNowhere || c == ' ') continue;
    const std::size_t end = wrapped.find_last_not_of(' ', blank) + 1;
    wrapped.replace(end, blank + 1 - end, "\n" + std::string(kGoesOn));
    column = kGoesOn.size() + after_blank;
    blank = kNowhere;
  }
  out.shrink(start);
  out.append(wrapped);
}

}  // namespace

TextFormatter::TextFormatter(const reflect::Protocol& protocol, TextOptions options)
    : options_(std::move(options)), nodes_(protocol, options_.units) {}

void TextFormatter::print(const Record& record, Buffer& out) {
  Styled styled(out, options_.color);
  const std::size_t start = out.size();
  const Frame& frame = *record.frame;
  const bool malformed = frame.malformed();
  styled.put(malformed ? Style::kError : Style::kDim,
             fmt::format("{}{:>5} ", malformed ? '!' : ' ', record.number));
  if (!record.time_text.empty()) {
    out.append(record.time_text);
    out.append(' ');
  } else if (record.time_ns != kNoTime) {
    append_time(record.time_ns, out);
  }
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
    append_facts(record.packet().radio, styled);
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
  if (options_.width != 0) wrap(out, start, options_.width);
  if (options_.hex) append_hexdump(record, options_.color, out);
}

}  // namespace rubric::format
