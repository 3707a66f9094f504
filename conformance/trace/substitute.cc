#include "conformance/trace/substitute.h"

#include <cstdlib>

#include "codec/reflect/suggest.h"
#include "codec/runtime/bytes.h"
#include "conformance/trace/value_text.h"

namespace rubric::trace {
namespace {

std::int64_t other_number(const Domain& domain, std::int64_t number) {
  if (domain.kind == Domain::Kind::kReal) {
    const float real = float_of_bits(static_cast<std::uint32_t>(number));
    return bits_of_float(real == 1.0f ? 2.0f : 1.0f);
  }
  return number < domain.max ? number + 1 : number - 1;
}

std::int64_t plain_number(const Domain& domain, const Value& value, Place place) {
  const bool real = domain.kind == Domain::Kind::kReal;
  if (real && value.is(Value::Kind::kReal)) {
    return bits_of_float(std::strtof(value.text.c_str(), nullptr));
  }
  if (real && value.is(Value::Kind::kNumber)) {
    return bits_of_float(static_cast<float>(value.number));
  }
  if (!real && value.is(Value::Kind::kNumber) && value.number >= domain.min &&
      value.number <= domain.max) {
    return value.number;
  }
  if (!real && value.is(Value::Kind::kNames)) {
    if (const auto number = domain.number_of(value.text)) return *number;
  }
  throw TraceError(place,
                   "expected " + domain.expectation() + ", given '" + value_text(value) + "'");
}

}  // namespace

Value substituted(const Value& value, const Bindings& bindings, Place place) {
  if (value.is(Value::Kind::kAny)) {
    throw TraceError(place, "expected a value, given '*'");
  }
  if (value.is(Value::Kind::kRange) && !value.text.empty() && value.number == value.max) {
    const Value* bound = bindings.find(value.text);
    if (!bound || !bound->is(Value::Kind::kNumber)) {
      throw TraceError(place, "nothing has bound $" + value.text + " to a number");
    }
    Value sum = Value::of((bound->number + value.number) & 0xFFFF);
    sum.negated = value.negated;
    return sum;
  }
  if (value.is(Value::Kind::kRange)) {
    throw TraceError(place, "expected a value, given the range " + value_text(value));
  }
  if (value.is(Value::Kind::kVariable)) {
    const Value* bound = bindings.find(value.text);
    if (!bound) throw TraceError(place, "nothing has bound $" + value.text);
    Value copy = *bound;
    copy.negated = value.negated;
    return copy;
  }
  Value copy = value;
  for (Value& item : copy.items) item = substituted(item, bindings, place);
  return copy;
}

std::int64_t number_in(const Domain& domain, const Value& value, Place place) {
  const std::int64_t number = plain_number(domain, value, place);
  return value.negated ? other_number(domain, number) : number;
}

std::string bytes_in(const Value& value, Place place) {
  if (!value.is(Value::Kind::kBytes) && !value.is(Value::Kind::kText)) {
    throw TraceError(place,
                     "expected bytes (x0a0b) or text in quotes, given '" + value_text(value) + "'");
  }
  std::string bytes = value.text;
  if (!value.negated) return bytes;
  if (bytes.empty()) return std::string(1, '\0');
  bytes.back() = static_cast<char>(bytes.back() ^ 1);
  return bytes;
}

FieldValue with_path(const FieldValue& field, const Shape& shape, std::size_t& position) {
  FieldValue whole = field;
  if (field.path.empty()) {
    if (!shape.app) {
      throw TraceError(field.place, "fields of " + shape.name + " need their names: '" +
                                        value_text(field.value) + "'");
    }
    if (position >= shape.app->field_count) {
      throw TraceError(field.place,
                       shape.name + " has " + std::to_string(shape.app->field_count) + " fields");
    }
    whole.path = shape.app->fields[position++].name;
    return whole;
  }
  std::vector<std::string> candidates;
  whole.path = shape.resolve(field.path, &candidates);
  if (!whole.path.empty()) return whole;
  std::string text = "'" + field.path + "' may mean ";
  if (candidates.empty()) {
    for (const auto& [path, slots] : shape.slots) candidates.push_back(path);
    for (const auto& [tail, paths] : shape.tails) candidates.push_back(tail);
    text = shape.name + " has no field '" + field.path + "'" +
           reflect::did_you_mean(field.path, candidates);
  } else {
    for (const std::string& one : candidates) text += (&one == &candidates[0] ? "" : ", ") + one;
  }
  throw TraceError(field.place, text);
}

std::vector<FieldValue> with_paths(const Message& message, const Shape& shape) {
  std::vector<FieldValue> fields;
  fields.reserve(message.fields.size());
  std::size_t position = 0;
  for (const FieldValue& field : message.fields) {
    fields.push_back(with_path(field, shape, position));
  }
  return fields;
}

}  // namespace rubric::trace
