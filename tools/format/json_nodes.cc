#include "tools/format/json_nodes.h"

#include <bit>
#include <cmath>

#include "tools/format/put.h"

namespace rubric::format {

using reflect::Decoded;
using reflect::Field;
using reflect::Kind;
using reflect::Node;
using reflect::NodeKind;

namespace {

char* put_key(char* at, const FieldPlan& plan) {
  return plan.key.size ? put(at, plan.key) : put(at, std::string_view(plan.long_key));
}

char* put_bits(char* at, const FieldPlan& plan, std::int64_t value) {
  at = plan.bits_open.size ? put(at, plan.bits_open)
                           : put(put(at, std::string_view(plan.bits_key)), "[");
  // Every element brings its comma; the bracket replaces the first one.
  char* const open = --at;
  for (auto bits = static_cast<std::uint32_t>(value); bits; bits &= bits - 1) {
    at = put(at, plan.bits[static_cast<std::size_t>(std::countr_zero(bits))]);
  }
  at += at == open;
  *open = '[';
  *at++ = ']';
  return at;
}

char* put_raw(char* at, const Field& field, std::int64_t value) {
  if (field.kind == Kind::kFloat) return put_float(at, static_cast<std::uint32_t>(value));
  return put_int(at, value);
}

}  // namespace

double converted(const Field& field, std::int64_t raw) {
  const double number = field.kind == Kind::kFloat
                            ? static_cast<double>(float_of_bits(static_cast<std::uint32_t>(raw)))
                            : static_cast<double>(raw);
  const double value = number * field.unit->scale + field.unit->offset;
  // 6340 * 0.01 - 40 is 23.4, not 23.400000000000006.
  constexpr double kSteps = 1e9;
  const double rounded = std::round(value * kSteps) / kSteps;
  return std::isfinite(rounded) && std::abs(rounded) < 1e6 ? rounded : value;
}

char* JsonNodes::value(char* at, const Decoded& decoded, std::size_t node) const {
  const Node& n = decoded[node];
  switch (n.kind) {
    case NodeKind::kStruct: return object(at, decoded, node);
    case NodeKind::kStructArray: return structs(at, decoded, node);
    case NodeKind::kNumberArray: return array(at, plan_.field(n.field), decoded, n);
    case NodeKind::kNumber: return put_raw(at, *n.field, n.value);
    case NodeKind::kBytes: break;
  }
  *at++ = '"';
  at = put_hex(at, decoded.bytes.sub(n.offset, n.size));
  *at++ = '"';
  return at;
}

char* JsonNodes::object(char* at, const Decoded& decoded, std::size_t node) const {
  char* const open = at;
  at = members(at, decoded, node + 1, decoded[node].end);
  at += at == open;
  *open = '{';
  *at++ = '}';
  return at;
}

char* JsonNodes::members(char* at, const Decoded& decoded, std::size_t from,
                         std::size_t end) const {
  for (std::size_t i = from; i < end;) {
    const Node& node = decoded[i];
    const FieldPlan& plan = plan_.field(node.field);
    if (node.kind == NodeKind::kNumber) {
      at = number(at, plan, node.value);
      ++i;
      continue;
    }
    at = value(put_key(at, plan), decoded, i);
    if (plan_.units() && node.kind == NodeKind::kNumberArray && !plan.unit_key.empty()) {
      at = put(at, std::string_view(plan.unit_key));
      char* const open = at;
      for (std::uint32_t k = 0; k < node.count; ++k) {
        *at++ = ',';
        const std::uint8_t* raw = decoded.bytes.data() + node.offset + k * plan.field->width_bytes;
        at = put_double(at, converted(*plan.field, reflect::load_number(*plan.field, raw)));
      }
      at += at == open;
      *open = '[';
      *at++ = ']';
    }
    i = node.end;
  }
  return at;
}

char* JsonNodes::number(char* at, const FieldPlan& plan, std::int64_t value) const {
  if (plan.plain) return put_int(put(at, plan.key), value);
  // An enum with all names: number and name are one ready-made piece.
  const auto slot = static_cast<std::uint64_t>(value - plan.first_value);
  if (slot < plan.members.size() && plan.members[slot].size) return put(at, plan.members[slot]);
  if (plan.enumerated) return put(put_int(put(at, plan.key), value), plan.nameless);
  return number_beside(at, plan, value);
}

char* JsonNodes::number_beside(char* at, const FieldPlan& plan, std::int64_t value) const {
  const Field& field = *plan.field;
  at = put_raw(put_key(at, plan), field, value);
  if (field.enumeration) {
    const char* name = reflect::enum_name(*field.enumeration, value);
    at = put(at, std::string_view(plan.name_key));
    at = name ? put(put(put(at, "\""), std::string_view(name)), "\"") : put(at, "null");
  }
  if (field.mask) at = put_bits(at, plan, value);
  if (!plan.unit_key.empty()) {
    at = put_double(put(at, std::string_view(plan.unit_key)), converted(field, value));
  }
  return at;
}

char* JsonNodes::array(char* at, const FieldPlan& plan, const Decoded& decoded,
                       const Node& node) const {
  const Field& field = *plan.field;
  const std::uint8_t* raw = decoded.bytes.data() + node.offset;
  char* const open = at;
  for (std::uint32_t i = 0; i < node.count; ++i, raw += field.width_bytes) {
    *at++ = ',';
    at = put_raw(at, field, reflect::load_number(field, raw));
  }
  at += at == open;
  *open = '[';
  *at++ = ']';
  return at;
}

char* JsonNodes::structs(char* at, const Decoded& decoded, std::size_t node) const {
  char* const open = at;
  for (std::size_t i = node + 1; i < decoded[node].end; i = decoded[i].end) {
    *at++ = ',';
    at = object(at, decoded, i);
  }
  at += at == open;
  *open = '[';
  *at++ = ']';
  return at;
}

}  // namespace rubric::format
