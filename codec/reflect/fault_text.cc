#include "codec/reflect/fault_text.h"

#include <cstdio>
#include <iterator>

#include "codec/reflect/text_field.h"
#include "codec/runtime/crc16.h"
#include "codec/runtime/ieee802154_fcs.h"

namespace rubric::reflect {
namespace {

struct FaultText {
  std::string_view name;
  std::string_view sentence;
};

// In the order of Fault.
constexpr FaultText kFaults[] = {
    {"none", "nothing is wrong"},
    {"truncated", "the bytes end before the field does"},
    {"trailing", "there are more bytes than the length says"},
    {"unexpected", "the value is not one of the allowed ones"},
    {"out_of_range", "the value is below its minimum or above its maximum"},
    {"no_room", "the output is too small"},
    {"crc", "the check sum of the serial frame does not match"},
    {"fcs", "the check sum of the radio frame does not match"},
    {"too_short", "the frame is below the smallest possible size"},
    {"too_long", "the frame is beyond the largest possible size"},
    {"aborted", "the sender gave the frame up: an escape comes directly before a flag"},
    {"cut", "the input ends in the middle of it"},
    {"empty", "the packet has no bytes"},
    {"handshake", "the stream does not begin with its handshake"},
    {"container", "this part of the capture file is damaged"},
    {"unsupported", "this is of a kind that is not read here"},
};

std::string hex16(std::int32_t value) {
  char text[8];
  std::snprintf(text, sizeof text, "0x%04x", static_cast<unsigned>(value) & 0xffffU);
  return text;
}

std::string plural(std::int64_t count, const char* noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

std::uint16_t serial_crc(const Packet& packet) {
  std::uint8_t head[2];
  std::size_t size = 0;
  if (packet.kind != kAbsent) head[size++] = static_cast<std::uint8_t>(packet.kind);
  if (packet.serial_seq != kAbsent) head[size++] = static_cast<std::uint8_t>(packet.serial_seq);
  return crc16(packet.bytes, crc16(Bytes(head, size)));
}

std::string allowed(const Field& field) {
  const Valid& valid = field.valid;
  if (valid.kind == ValidKind::kRange) {
    return ", allowed are " + integer_text(field, valid.min) + " to " +
           integer_text(field, valid.max);
  }
  std::string text = valid.one_of_count == 1 ? ", must be " : ", must be one of ";
  for (int i = 0; i < valid.one_of_count; ++i) {
    if (i) text += ", ";
    text += number_text(field, valid.one_of[i]);
  }
  return text;
}

std::string cut_text(const Packet& packet) {
  const std::uint64_t head = std::uint64_t{packet.kind != kAbsent} + (packet.serial_seq != kAbsent);
  const std::uint64_t kept = head + packet.bytes.size();
  return "cut by the capture (" + std::to_string(kept) + " of " +
         std::to_string(kept + packet.dropped_bytes) + " bytes)";
}

std::string hex_error_text(const Frame& frame) {
  const std::string line = "line " + std::to_string(frame.packet->line);
  if (frame.error.fault == Fault::kTooLong) return line + " is too long";
  return line + ", character " + std::to_string(frame.error.offset_bytes + 1) +
         ": expected two hex digits a byte";
}

std::string framing_error_text(const Frame& frame) {
  const Packet& packet = *frame.packet;
  if (packet.cut_by_capture()) return cut_text(packet);
  if (packet.line != 0 && frame.error.requirement == "WIRE-HEX"_rule) return hex_error_text(frame);
  std::string text(fault_sentence(frame.error.fault));
  if (frame.error.fault == Fault::kCrc && packet.crc != kAbsent) {
    text += ": it is " + hex16(packet.crc) + ", the bytes give " + hex16(serial_crc(packet));
  }
  if (frame.error.fault == Fault::kFcs && packet.has_cc24xx_trailer()) {
    text += ", says its sniffer, which puts RSSI and link quality there";
  } else if (frame.error.fault == Fault::kFcs && packet.fcs != kAbsent) {
    const std::uint16_t computed = rubric::fcs(packet.bytes);
    text += ": it is " + hex16(packet.fcs) + ", the bytes give " + hex16(computed);
  }
  if (packet.dropped_bytes) {
    text += "; " + std::to_string(packet.dropped_bytes) + " more bytes are not shown";
  }
  return text;
}

}  // namespace

std::string_view fault_name(Fault fault) {
  const auto i = static_cast<std::size_t>(fault);
  return i < std::size(kFaults) ? kFaults[i].name : "unknown";
}

std::optional<Fault> find_fault(std::string_view name) {
  for (std::size_t i = 0; i < std::size(kFaults); ++i) {
    if (kFaults[i].name == name) return static_cast<Fault>(i);
  }
  return std::nullopt;
}

std::string_view fault_sentence(Fault fault) {
  const auto i = static_cast<std::size_t>(fault);
  return i < std::size(kFaults) ? kFaults[i].sentence : "unknown fault";
}

std::string integer_text(const Field& field, std::int64_t value) {
  return field.is_wide() ? std::to_string(static_cast<std::uint64_t>(value))
                         : std::to_string(value);
}

std::string number_text(const Field& field, std::int64_t value) {
  const char* name = field.enumeration ? enum_name(*field.enumeration, value) : nullptr;
  return integer_text(field, value) + (name ? " (" + std::string(name) + ")" : "");
}

std::string error_text(const Decoded& decoded) {
  const Fault fault = decoded.error.fault;
  const Field* field = decoded.error_field;
  if (fault == Fault::kTrailing) {
    return plural(decoded.error_value, "byte") + " more than the length says";
  }
  if (!field) return std::string(fault_sentence(fault));
  const std::string name = field->name;
  switch (fault) {
    case Fault::kOutOfRange:
    case Fault::kUnexpected:
      return name + " is " + number_text(*field, decoded.error_value) + allowed(*field);
    case Fault::kTruncated:
      return name + " needs " + plural(decoded.error_value, "byte") + ", the bytes end at " +
             std::to_string(decoded.error.offset_bytes);
    default: return name + ": " + std::string(fault_sentence(fault));
  }
}

std::string error_text(const Frame& frame) {
  const bool framing = frame.packet && frame.packet->error.fault != Fault::kNone;
  return framing ? framing_error_text(frame) : error_text(frame.decoded);
}

std::string_view note_name(NoteKind kind) {
  switch (kind) {
    case NoteKind::kUnknownMessage: return "unknown_message";
    case NoteKind::kDoesNotFit: return "does_not_fit";
    case NoteKind::kNotDecoded: return "not_decoded";
    case NoteKind::kRadioOnly: return "radio_only";
    case NoteKind::kNotText: return "not_text";
    case NoteKind::kUnexpectedValue: break;
  }
  return "unexpected_value";
}

std::string note_text(const Note& note) {
  const std::string key = std::to_string(note.value);
  const std::string name = note.field ? note.field->name : "field";
  switch (note.kind) {
    case NoteKind::kUnknownMessage: return name + " is not a message known here, its key is " + key;
    case NoteKind::kDoesNotFit:
      return name + " has the key " + key + " and does not fit " +
             (note.type ? note.type->name : "its message");
    case NoteKind::kRadioOnly:
      return (note.type ? note.type->name : name) + std::string(" does not travel on the serial ") +
             "line: these are the bytes of a radio message in a serial packet's form";
    case NoteKind::kNotDecoded: {
      if (note.value < 0) return "packets of a forwarder carry no message known here";
      char hex[24];
      std::snprintf(hex, sizeof(hex), "%#llx", static_cast<unsigned long long>(note.value));
      return std::string("frames of kind ") + hex + " carry no message known here";
    }
    case NoteKind::kNotText:
      return name + " is not " + (note.field ? encoding_name(*note.field->text) : "text") +
             ", it has the byte " + key;
    case NoteKind::kUnexpectedValue: break;
  }
  if (!note.field) return "value " + key + " is not the expected one";
  return name + " is " + number_text(*note.field, note.value) + ", expected is " +
         number_text(*note.field, note.field->expect);
}

}  // namespace rubric::reflect
