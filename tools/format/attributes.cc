#include "tools/format/attributes.h"

#include "codec/reflect/fault_text.h"
#include "tools/format/message_types.h"

namespace rubric::format {
namespace {

using Names = std::vector<std::string>;
using reflect::Protocol;

bool integer(Visitor visit, std::int64_t value) { return visit(Value::of_integer(value)); }
bool integer_or_absent(Visitor visit, std::int32_t value) {
  return value == kAbsent || integer(visit, value);
}
bool text(Visitor visit, std::string_view value) {
  return value.empty() || visit(Value::of_text(value));
}
bool time(Visitor visit, std::int64_t time_ns) {
  if (time_ns == kNoTime) return true;
  Value value = Value::of_integer(time_ns);
  value.kind = Value::Kind::kTime;
  return visit(value);
}

bool kind(const Record& r, Visitor visit) {
  const std::int32_t kind = r.packet().kind;
  return kind == kAbsent || visit(Value::of_integer(kind, serial_kind_name(kind)));
}

bool stale(const Record& r, Visitor visit) {
  for (std::size_t i = 0; i < r.decoded().stale_count(); ++i) {
    const reflect::Range range = r.decoded().stale()[i];
    const Bytes bytes = r.packet().bytes.sub(range.offset, range.size);
    if (!visit(Value::of_bytes(bytes))) return false;
  }
  return true;
}

bool stale_bytes(const Record& r, Visitor visit) {
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < r.decoded().stale_count(); ++i) sum += r.decoded().stale()[i].size;
  return integer(visit, sum);
}

bool path(const Record& r, Visitor visit) {
  for (std::size_t i = 0; i < r.decoded().path_count(); ++i) {
    if (!text(visit, r.decoded().path()[i]->name)) return false;
  }
  return true;
}

bool notes(const Record& r, Visitor visit) {
  for (std::size_t i = 0; i < r.decoded().note_count(); ++i) {
    if (!text(visit, reflect::note_name(r.decoded().notes()[i].kind))) return false;
  }
  return true;
}

bool fault(const Record& r, Visitor visit) {
  return !r.frame->has_error() || text(visit, reflect::fault_name(r.frame->error.fault));
}

void message_names(const Protocol& protocol, Names& names) {
  for (const reflect::Type* type : message_types(protocol)) names.emplace_back(type->name);
  names.emplace_back("mac_ack");
}
void framing_names(const Protocol&, Names& names) {
  for (const Framing framing : {Framing::kHdlc, Framing::kSf, Framing::kRadio, Framing::kBare}) {
    names.emplace_back(framing_name(framing));
  }
}
void direction_names(const Protocol&, Names& names) {
  names.insert(names.end(), {"inbound", "outbound"});
}
void kind_names(const Protocol&, Names& names) {
  for (int kind = 0; kind < 256; ++kind) {
    if (!serial_kind_name(kind).empty()) names.emplace_back(serial_kind_name(kind));
  }
}
void note_names(const Protocol&, Names& names) {
  for (const reflect::NoteKind kind :
       {reflect::NoteKind::kUnknownMessage, reflect::NoteKind::kDoesNotFit,
        reflect::NoteKind::kUnexpectedValue, reflect::NoteKind::kNotDecoded,
        reflect::NoteKind::kRadioOnly, reflect::NoteKind::kNotText}) {
    names.emplace_back(reflect::note_name(kind));
  }
}
void fault_names(const Protocol&, Names& names) {
  for (int i = 1; i <= static_cast<int>(Fault::kUnsupported); ++i) {
    names.emplace_back(reflect::fault_name(static_cast<Fault>(i)));
  }
}

bool rssi(const Record& r, Visitor visit) {
  const std::optional<float> rssi = r.packet().radio.rssi;
  return !rssi || visit(Value::of_real(*rssi));
}
template <auto kFact>
bool of_radio(const Record& r, Visitor visit) {
  const auto fact = r.packet().radio.*kFact;
  return fact == kAbsent || integer(visit, fact);
}

template <auto kNumber>
bool of_packet(const Record& r, Visitor visit) {
  return integer_or_absent(visit, r.packet().*kNumber);
}
template <auto kNumber>
bool of_mac(const Record& r, Visitor visit) {
  return !r.frame->mac.present || integer(visit, r.frame->mac.*kNumber);
}
template <auto kNumber>
bool of_mac_addresses(const Record& r, Visitor visit) {
  return !r.frame->mac.has_addresses || integer(visit, r.frame->mac.*kNumber);
}
template <auto kNumber>
bool of_am(const Record& r, Visitor visit) {
  return !r.frame->am.present || integer(visit, r.frame->am.*kNumber);
}

constexpr Attribute kAttributes[] = {
    {"index",
     [](const Record& r, Visitor v) { return integer(v, static_cast<std::int64_t>(r.index)); }},
    {"number",
     [](const Record& r, Visitor v) { return integer(v, static_cast<std::int64_t>(r.number)); }},
    {"offset",
     [](const Record& r, Visitor v) {
       return integer(v, static_cast<std::int64_t>(r.packet().offset_bytes));
     }},
    {"time",
     [](const Record& r, Visitor v) {
       return r.time_text.empty() ? time(v, r.time_ns) : text(v, r.time_text);
     }},
    {"interface", [](const Record& r, Visitor v) { return text(v, r.interface_name); }, nullptr,
     true},
    {"direction",
     [](const Record& r, Visitor v) { return text(v, direction_name(r.packet().direction)); },
     direction_names},
    {"framing",
     [](const Record& r, Visitor v) { return text(v, framing_name(r.packet().framing)); },
     framing_names},
    {"frame.kind", kind, kind_names},
    {"frame.kind_name",
     [](const Record& r, Visitor v) { return text(v, serial_kind_name(r.packet().kind)); },
     kind_names},
    {"frame.serial_seq", of_packet<&Packet::serial_seq>},
    {"frame.crc", of_packet<&Packet::crc>},
    {"frame.dispatch",
     [](const Record& r, Visitor v) { return integer_or_absent(v, dispatch_of(r.packet())); }},
    {"frame.fcf", of_mac<&reflect::MacHeader::fcf>},
    {"frame.dsn", of_mac<&reflect::MacHeader::dsn>},
    {"frame.destpan", of_mac_addresses<&reflect::MacHeader::destpan>},
    {"frame.dest", of_mac_addresses<&reflect::MacHeader::dest>},
    {"frame.src", of_mac_addresses<&reflect::MacHeader::src>},
    {"frame.network",
     [](const Record& r, Visitor v) { return integer_or_absent(v, network_of(*r.frame)); }},
    {"frame.fcs", of_packet<&Packet::fcs>},
    {"frame.rssi", rssi},
    {"frame.lqi", of_radio<&RadioFacts::lqi>},
    {"frame.channel", of_radio<&RadioFacts::channel>},
    {"frame.slot", of_radio<&RadioFacts::slot>},
    {"am.dest", of_am<&reflect::ActiveMessage::dest>},
    {"am.src", of_am<&reflect::ActiveMessage::src>},
    {"am.length", of_am<&reflect::ActiveMessage::length>},
    {"am.group", of_am<&reflect::ActiveMessage::group>},
    {"am.type", of_am<&reflect::ActiveMessage::type>},
    {"message",
     [](const Record& r, Visitor v) {
       const reflect::Type* message = r.decoded().message();
       return !message || text(v, message->name);
     },
     message_names},
    {"path", path, message_names},
    {"notes", notes, note_names},
    {"stale", stale, nullptr, true},
    {"stale_bytes", stale_bytes},
    {"raw", [](const Record& r, Visitor v) { return v(Value::of_bytes(r.packet().bytes)); },
     nullptr, true},
    {"error", fault, fault_names},
    {"error.fault", fault, fault_names},
    {"error.offset",
     [](const Record& r, Visitor v) {
       return !r.frame->has_error() || integer(v, r.frame->error.offset_bytes);
     }},
    {"error.requirement",
     [](const Record& r, Visitor v) {
       return !r.frame->has_error() || text(v, reflect::requirement(r.frame->error.requirement).id);
     },
     nullptr, true},
    {"error.text",
     [](const Record& r, Visitor v) {
       return !r.frame->has_error() || text(v, reflect::error_text(*r.frame));
     },
     nullptr, true},
};

}  // namespace

const Attribute* find_attribute(std::string_view name) {
  for (const Attribute& attribute : kAttributes) {
    if (attribute.name == name) return &attribute;
  }
  return nullptr;
}

std::vector<std::string_view> attribute_names() {
  std::vector<std::string_view> names;
  for (const Attribute& attribute : kAttributes) names.push_back(attribute.name);
  return names;
}

}  // namespace rubric::format
