#include "tools/commands/run/names.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <stdexcept>

#include "codec/reflect/decode.h"
#include "codec/reflect/encode.h"
#include "codec/reflect/registry.h"
#include "conformance/node/sizes.h"

namespace rubric::run {
namespace {

const reflect::Protocol& rubicon() { return *reflect::find_protocol("rubicon"); }

const reflect::MaskTable& mask(std::string_view name) {
  const reflect::Protocol& protocol = rubicon();
  int i = 0;
  while (name != protocol.masks[i]->name) ++i;
  return *protocol.masks[i];
}

const reflect::EnumTable& mote_types() {
  const reflect::Protocol& protocol = rubicon();
  int i = 0;
  while (std::string_view("mote_type") != protocol.enums[i]->name) ++i;
  return *protocol.enums[i];
}

bool parse_number(const std::string& text, std::uint32_t max, std::uint32_t& out) {
  const char* const end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, out);
  return error == std::errc() && at == end && out <= max;
}

std::uint32_t bits_of(const std::string& text, const reflect::MaskTable& table) {
  std::uint32_t bits = 0;
  if (text.empty() || parse_number(text, (1u << table.width_bits) - 1, bits)) return bits;
  std::string known;
  for (int bit = 0; bit < table.width_bits; ++bit) {
    if (table.bit_names[bit] != nullptr) known += fmt::format(" {}", table.bit_names[bit]);
  }
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string name = text.substr(begin, end - begin);
    const int bit = reflect::mask_bit(table, name);
    if (bit < 0) throw std::invalid_argument(fmt::format("'{}' is none of:{}", name, known));
    bits |= 1u << bit;
    begin = end + 1;
  }
  return bits;
}

std::vector<std::string> names_of(std::uint32_t bits, const reflect::MaskTable& table) {
  std::vector<std::string> out;
  for (int bit = 0; bit < table.width_bits; ++bit) {
    if ((bits >> bit & 1u) == 0) continue;
    const char* const name = table.bit_names[bit];
    out.push_back(name != nullptr ? name : fmt::format("bit{}", bit));
  }
  return out;
}

}  // namespace

std::uint8_t mote_type_of(const std::string& text) {
  std::uint32_t number = 0;
  if (parse_number(text, 255, number)) return static_cast<std::uint8_t>(number);
  const reflect::EnumTable& table = mote_types();
  std::string known;
  for (int i = 0; i < table.count; ++i) {
    if (text == table.entries[i].name) return static_cast<std::uint8_t>(table.entries[i].value);
    known += fmt::format(" {}", table.entries[i].name);
  }
  throw std::invalid_argument(fmt::format("'{}' is none of:{}", text, known));
}

std::uint16_t transducers_of(const std::string& text) {
  return static_cast<std::uint16_t>(bits_of(text, mask("transducer_mask")));
}

std::uint8_t actuators_of(const std::string& text) {
  return static_cast<std::uint8_t>(bits_of(text, mask("actuator_mask")));
}

std::string mote_type_name(std::uint8_t type) {
  const char* const name = reflect::enum_name(mote_types(), type);
  return name != nullptr ? name : std::to_string(type);
}

std::vector<std::string> transducer_names(std::uint16_t bits) {
  return names_of(bits, mask("transducer_mask"));
}

std::vector<std::string> actuator_names(std::uint8_t bits) {
  return names_of(bits, mask("actuator_mask"));
}

const reflect::Unit* unit_of(const std::string& transducer) {
  const reflect::Type& type = *reflect::find_type(rubicon(), "demo_data");
  for (int i = 0; i < type.field_count; ++i) {
    if (transducer == type.fields[i].name) return type.fields[i].unit;
  }
  return nullptr;
}

std::string refusal_text(node::Refusal refusal) {
  switch (refusal) {
    case node::Refusal::kNone: break;
    case node::Refusal::kTooLong:
      return fmt::format("more than {} bytes of data", node::kAppDataMax);
    case node::Refusal::kNotJoined: return "the mote has not joined";
    case node::Refusal::kNoWay: return "no line of this node leads there";
    case node::Refusal::kAwaiting: return "as many acknowledgements are awaited as can be";
    case node::Refusal::kOff: return "the line is switched off";
    case node::Refusal::kFull: return "the outgoing buffer is full";
  }
  return "the node refused it";
}

}  // namespace rubric::run
