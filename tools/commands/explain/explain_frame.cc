#include "tools/commands/explain/explain_frame.h"

#include <fmt/format.h>

#include <algorithm>

#include "codec/containers/crc16_fast.h"
#include "codec/containers/link_record.h"
#include "codec/containers/serial_frame.h"
#include "codec/generated/tinyos/am_header.h"
#include "codec/generated/tinyos/enums.h"
#include "codec/generated/tinyos/mac_ack.h"
#include "codec/generated/tinyos/mac_header.h"
#include "codec/reflect/fault_text.h"
#include "codec/reflect/text_field.h"
#include "codec/runtime/hdlc.h"
#include "tools/commands/explain/table.h"
#include "tools/commands/explain/type_text.h"
#include "tools/encode/carriers.h"
#include "tools/format/json_nodes.h"
#include "tools/format/plain_value.h"
#include "tools/format/record.h"

namespace rubric::explain {

using reflect::Decoded;
using reflect::Field;
using reflect::Frame;
using reflect::Kind;
using reflect::Node;
using reflect::NodeKind;

namespace {

using ByteList = std::vector<std::uint8_t>;

constexpr std::size_t kShownBytes = 8;

std::string hex(Bytes bytes) {
  const std::size_t shown = std::min(bytes.size(), kShownBytes);
  return fmt::format("{:02x}{}", fmt::join(bytes.first(shown), " "),
                     shown < bytes.size() ? " ..." : "");
}

std::string count_text(std::size_t bytes) {
  return fmt::format("{} byte{}", bytes, bytes == 1 ? "" : "s");
}

std::string value_text(const Field& field, std::int64_t value) {
  if (field.kind == Kind::kFloat) {
    return fmt::format("{}", float_of_bits(static_cast<std::uint32_t>(value)));
  }
  if (field.kind == Kind::kMask) return fmt::format("{:#x}", value);
  return reflect::integer_text(field, value);
}

std::string meaning(const Field& field, std::int64_t value) {
  std::string text;
  if (field.enumeration) {
    const char* name = reflect::enum_name(*field.enumeration, value);
    if (name) text = name;
  }
  if (field.mask) text = bits_text(*field.mask, value);
  if (field.unit) {
    char number[format::kMaxFloatChars];
    const char* const end = format::put_converted(number, field, value);
    text = fmt::format("{} {}", std::string_view(number, static_cast<std::size_t>(end - number)),
                       field.unit->symbol);
  }
  const std::string doc = first_sentence(field.doc);
  if (doc.empty()) return text;
  return text.empty() ? doc : fmt::format("{}; {}", text, doc);
}

/// The rows of one frame.
class Rows {
 public:
  explicit Rows(const Frame& frame) : decoded_(frame.decoded), packet_(*frame.packet) {
    table_.align_right(0);
  }

  std::string text() {
    head();
    if (decoded_.node_count()) {
      if (packet_.framing == Framing::kBare) section(decoded_[0]);
      children(0, "");
    }
    rest();
    tail();
    return table_.text_within(kColumns, 2);
  }

  std::uint32_t head_bytes() const { return head_bytes_; }

 private:
  void add(std::size_t offset, Bytes bytes, std::string field, std::string value,
           std::string what) {
    table_.add(
        {std::to_string(offset), hex(bytes), std::move(field), std::move(value), std::move(what)});
  }

  void head() {
    if (packet_.framing != Framing::kHdlc) return;
    const auto byte = [&](const char* name, std::int32_t value, std::string what) {
      if (value == kAbsent) return;
      const auto raw = static_cast<std::uint8_t>(value);
      add(head_bytes_++, Bytes(&raw, 1), name, std::to_string(value), std::move(what));
    };
    const std::string_view kind = format::serial_kind_name(packet_.kind);
    byte("kind", packet_.kind,
         kind.empty() ? "Packet kind, unknown." : std::string(kind) + "; Packet kind.");
    byte("seq_num", packet_.serial_seq, "Sequence number of the serial line.");
  }

  void section(const Node& node) {
    table_.add({"", "", node.type->id, "", first_sentence(node.type->doc)});
    indent_ = "  ";
  }

  void children(std::size_t parent, const std::string& prefix) {
    std::size_t n = 0;
    for (std::size_t i = parent + 1; i < decoded_[parent].end; i = decoded_[i].end, ++n) {
      const bool in_array = decoded_[parent].kind == NodeKind::kStructArray;
      add_node(i, in_array ? fmt::format("{}[{}]", prefix, n)
                           : prefix + (prefix.empty() ? "" : ".") + decoded_[i].field->name);
    }
  }

  void add_node(std::size_t i, const std::string& path) {
    const Node& node = decoded_[i];
    const Bytes bytes = decoded_.bytes.sub(node.offset, node.size);
    const std::size_t at = head_bytes_ + node.offset;
    done_ = std::max(done_, node.offset + (node.end == i + 1 ? node.size : 0));
    switch (node.kind) {
      case NodeKind::kNumber:
        return add(at, bytes, indent_ + path, value_text(*node.field, node.value),
                   meaning(*node.field, node.value));
      case NodeKind::kNumberArray: {
        std::string values;
        for (std::uint32_t k = 0; k < node.count; ++k) {
          values +=
              (k ? " " : "") +
              value_text(*node.field, reflect::load_number(
                                          *node.field, bytes.data() + k * node.field->width_bytes));
        }
        return add(at, bytes, indent_ + path, values, first_sentence(node.field->doc));
      }
      case NodeKind::kBytes:
        if (format::is_text(node.field)) {
          return add(at, bytes, indent_ + path,
                     format::quoted(reflect::shown_text(*node.field, bytes)),
                     first_sentence(node.field->doc));
        }
        return add(at, bytes, indent_ + path, count_text(bytes.size()),
                   "Opaque. " + first_sentence(node.field->doc));
      case NodeKind::kStructArray:
        if (node.count == 0) return add(at, bytes, indent_ + path, "none", {});
        return children(i, path);
      case NodeKind::kStruct: break;
    }
    // A chosen message begins names of its own.
    if (!is_message(node)) return children(i, path);
    section(node);
    children(i, "");
  }

  bool is_message(const Node& node) const {
    const auto* begin = decoded_.path();
    const auto* end = begin + decoded_.path_count();
    return std::find(begin, end, node.type) != end;
  }

  // Adds rows for the field that broke a rule, the bytes after it, and stale bytes.
  void rest() {
    const Error& error = decoded_.error;
    const std::size_t size = decoded_.bytes.size();
    if (error.fault != Fault::kNone && error.offset_bytes < size) {
      const Field* field = decoded_.error_field;
      const std::size_t width =
          field && field->kind <= Kind::kMask
              ? std::min<std::size_t>(field->width_bytes, size - error.offset_bytes)
              : 0;
      if (width) {
        const Bytes bytes = decoded_.bytes.sub(error.offset_bytes, width);
        add(head_bytes_ + error.offset_bytes, bytes, "! " + std::string(field->name),
            std::to_string(decoded_.error_value), "breaks a rule, see below");
      }
      done_ = std::max(done_, static_cast<std::uint32_t>(error.offset_bytes + width));
    }
    for (std::size_t i = 0; i < decoded_.stale_count(); ++i) {
      const reflect::Range range = decoded_.stale()[i];
      add(head_bytes_ + range.offset, decoded_.bytes.sub(range.offset, range.size), "(stale)",
          count_text(range.size), "Behind the meant content; they mean nothing.");
      done_ = std::max(done_, range.offset + range.size);
    }
    if (done_ < size) {
      add(head_bytes_ + done_, decoded_.bytes.from(done_), "(not decoded)",
          count_text(size - done_), {});
    }
  }

  void tail() {
    const bool serial = packet_.framing == Framing::kHdlc;
    const std::int32_t sum = serial ? packet_.crc : packet_.fcs;
    if (sum == kAbsent) return;
    const std::uint8_t raw[] = {static_cast<std::uint8_t>(sum),
                                static_cast<std::uint8_t>(sum >> 8)};
    const std::int32_t computed = encode::check_sum(packet_);
    add(head_bytes_ + packet_.bytes.size(), raw, serial ? "crc" : "fcs",
        fmt::format("{:#06x}", sum),
        sum == computed ? "Check sum, right."
                        : fmt::format("Check sum, should be {:#06x}.", computed));
  }

  const Decoded& decoded_;
  const Packet& packet_;
  Table table_{{"offset", "bytes", "field", "value", "meaning"}};
  std::string indent_;
  std::uint32_t head_bytes_ = 0;
  std::uint32_t done_ = 0;
};

std::string rule_text(ReqId id) {
  if (id == ReqId::kNone) return {};
  const reflect::Requirement& rule = reflect::requirement(id);
  return wrapped(fmt::format("{} ({}): {}", rule.id, rule.level, rule.sentence), 4) +
         fmt::format("    Source: {}\n", rule.source);
}

// Returns why opaque bytes do not fit the message that their key names.
std::string misfit_text(Bytes bytes, const reflect::Type& type) {
  Decoded decoded;
  reflect::decode(type, bytes, reflect::Tail::kStale, true, decoded);
  if (decoded.error.fault == Fault::kNone) return {};  // Its room is what it does not fit.
  return wrapped(fmt::format("As {} it is malformed at its byte {}: {}.", type.id,
                             decoded.error.offset_bytes, reflect::error_text(decoded)),
                 2) +
         rule_text(decoded.error.requirement);
}

constexpr std::size_t kFcsBytes = 2;

Bytes view(const ByteList& bytes) { return {bytes.data(), bytes.size()}; }

// Removes the flags around and the escapes within, as on the line itself.
ByteList without_flags(const ByteList& given) {
  ByteList content;
  std::size_t begin = 0;
  std::size_t end = given.size();
  while (begin < end && given[begin] == kHdlcFlag) ++begin;
  while (end > begin && given[end - 1] == kHdlcFlag) --end;
  if (begin == 0 && end == given.size()) return given;
  bool escaping = false;
  for (std::size_t i = begin; i < end; ++i) {
    if (given[i] == kHdlcEscape && !escaping) {
      escaping = true;
      continue;
    }
    content.push_back(static_cast<std::uint8_t>(given[i] ^ (escaping ? kHdlcXor : 0)));
    escaping = false;
  }
  return content;
}

GivenFrame serial(const ByteList& given) {
  GivenFrame frame{.bytes = without_flags(given)};
  frame.what = "a serial frame, from its kind byte to its CRC";
  decode_serial_content(view(frame.bytes), frame.packet);
  return frame;
}

bool is_am(const ByteList& bytes) {
  using Header = tinyos::AmHeaderLayout;
  constexpr std::size_t kHeaderBytes = tinyos::AmHeaderView::kMaxSizeBytes;
  return bytes.size() >= kHeaderBytes &&
         Header::DispatchAt::load(bytes.data()) == tinyos::Dispatch::kActiveMessage &&
         Header::LengthAt::load(bytes.data()) == bytes.size() - kHeaderBytes;
}

GivenFrame packet(const ByteList& given) {
  GivenFrame frame{.bytes = given, .what = "a serial packet, from its dispatch byte on"};
  const bool counted = given.size() > 1 && given[0] == given.size() - 1;
  if (!is_am(given) && counted && is_am(ByteList(given.begin() + 1, given.end()))) {
    frame.bytes.erase(frame.bytes.begin());
    frame.what = "a serial forwarder packet, its length byte taken off";
  }
  frame.packet.framing = Framing::kSf;
  frame.packet.bytes = view(frame.bytes);
  return frame;
}

bool has_fcs(const ByteList& given) {
  Packet packet;
  decode_radio_record(view(given), kLinkRadioFcs, packet);
  return given.size() > kFcsBytes && packet.fcs == fcs_fast(packet.bytes);
}

GivenFrame radio(const ByteList& given) {
  GivenFrame frame{.bytes = given};
  const bool fcs = has_fcs(given);
  frame.what = fcs ? "an 802.15.4 frame with its FCS" : "an 802.15.4 frame without FCS";
  decode_radio_record(view(frame.bytes), fcs ? kLinkRadioFcs : kLinkRadioNoFcs, frame.packet);
  return frame;
}

bool begins_as_radio(const ByteList& given) {
  using tinyos::FrameControl;
  const auto start = tinyos::MacAckView::parse(view(given));
  if (!start) return false;
  if (start->fcf() == static_cast<std::uint16_t>(FrameControl::kAck)) {
    return given.size() <= tinyos::MacAckView::kMaxSizeBytes + kFcsBytes;
  }
  constexpr auto kShape = static_cast<unsigned>(tinyos::FrameControlPart::kShape);
  return (start->fcf() & kShape) == static_cast<unsigned>(FrameControl::kData) &&
         given.size() > tinyos::MacHeaderView::kMaxSizeBytes;
}

GivenFrame bare(const ByteList& given) {
  GivenFrame frame{.bytes = given};
  frame.packet.framing = Framing::kBare;
  frame.packet.bytes = view(frame.bytes);
  return frame;
}

}  // namespace

std::string explain_frame(const Frame& frame) {
  Rows rows(frame);
  std::string out = rows.text();
  for (std::size_t i = 0; i < frame.decoded.note_count(); ++i) {
    const reflect::Note& note = frame.decoded.notes()[i];
    out += wrapped(fmt::format("Note at byte {}: {}.", rows.head_bytes() + note.offset,
                               reflect::note_text(note)),
                   2);
    if (note.kind == reflect::NoteKind::kDoesNotFit && note.type) {
      out += misfit_text(frame.decoded.bytes.from(note.offset), *note.type);
    }
  }
  if (!frame.malformed()) return out;
  out +=
      wrapped(fmt::format("Malformed at byte {}: {}.", rows.head_bytes() + frame.error.offset_bytes,
                          reflect::error_text(frame)),
              2);
  return out + rule_text(frame.error.requirement);
}

std::optional<GivenFrame> take_frame(const ByteList& given, std::string_view framing) {
  if (framing == "hdlc") return serial(given);
  if (framing == "sf") return packet(given);
  if (framing == "radio") return radio(given);
  if (framing == "bare") return bare(given);
  const ByteList content = without_flags(given);
  if (given.size() != content.size()) return serial(given);
  if (check_serial_content(view(given)).fault == Fault::kNone) return serial(given);
  if (begins_as_radio(given) && has_fcs(given)) return radio(given);
  const GivenFrame as_packet = packet(given);
  if (is_am(as_packet.bytes)) return packet(given);
  if (begins_as_radio(given)) return radio(given);
  if (given.empty()) return std::nullopt;
  const std::uint8_t first = given[0];
  const bool is_kind =
      first == kSerialAck || first == kSerialPacketAck || first == kSerialPacketNoAck;
  if (is_kind) return serial(given);
  if (first == 0) return packet(given);
  return std::nullopt;
}

}  // namespace rubric::explain
