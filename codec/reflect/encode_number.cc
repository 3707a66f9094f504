#include "codec/reflect/encode_number.h"

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>

#include "codec/reflect/encode.h"
#include "codec/reflect/fault_text.h"

namespace rubric::reflect {
namespace {

using std::to_string;

constexpr std::string_view kBitPrefix = "bit";

std::string quoted(std::string_view name) { return '"' + std::string(name) + '"'; }

NumberResult problem(std::string text) { return {.problem = std::move(text)}; }

NumberResult good(std::int64_t value) { return {.present = true, .value = value}; }

NumberResult float_of(const Value& value) {
  float number = 0;
  if (value.is(Value::Kind::kInteger)) {
    number = static_cast<float>(value.integer);
  } else if (value.is(Value::Kind::kReal)) {
    number = std::strtof(value.text.c_str(), nullptr);
    if (std::isinf(number)) {
      return problem("expected a number that binary32 can hold, given " + value.text);
    }
  } else if (value.is(Value::Kind::kString) && value.text == "NaN") {
    number = std::numeric_limits<float>::quiet_NaN();
  } else if (value.is(Value::Kind::kString) && value.text == "Infinity") {
    number = std::numeric_limits<float>::infinity();
  } else if (value.is(Value::Kind::kString) && value.text == "-Infinity") {
    number = -std::numeric_limits<float>::infinity();
  } else {
    return problem("expected a number, \"NaN\", \"Infinity\" or \"-Infinity\", given " +
                   value_text(value));
  }
  return good(bits_of_float(number));
}

NumberResult bits_of(const Field& f, const Value& value) {
  std::int64_t mask = 0;
  for (const Value& item : value.items) {
    const int bit = item.is(Value::Kind::kString) ? mask_bit(*f.mask, item.text) : -1;
    if (bit < 0) {
      std::string names;
      for (int i = 0; i < f.mask->width_bits; ++i) {
        const char* name = f.mask->bit_names[i];
        names += (i ? ", " : "") + (name ? std::string(name) : "bit" + to_string(i));
      }
      return problem("expected bits of " + std::string(f.mask->name) + " (" + names + "), given " +
                     value_text(item));
    }
    mask |= std::int64_t{1} << bit;
  }
  return good(mask);
}

NumberResult named(const Field& f, const std::string& name) {
  std::int64_t value = 0;
  if (enum_value(*f.enumeration, name, value)) return good(value);
  std::string names;
  constexpr int kShown = 12;
  for (int i = 0; i < f.enumeration->count && i < kShown; ++i) {
    names += std::string(i ? ", " : "") + f.enumeration->entries[i].name;
  }
  if (f.enumeration->count > kShown) names += ", ...";
  return problem("expected a name of " + std::string(f.enumeration->name) + " (" + names +
                 "), given " + quoted(name));
}

NumberResult plain(const Field& f, const Value& value) {
  if (f.kind == Kind::kFloat) return float_of(value);
  // Numbers above int64 come as they are written.
  if (f.is_wide() && value.is(Value::Kind::kReal)) {
    std::uint64_t number = 0;
    const char* const end = value.text.data() + value.text.size();
    const auto [stop, error] = std::from_chars(value.text.data(), end, number);
    if (error == std::errc{} && stop == end) return good(static_cast<std::int64_t>(number));
  }
  if (value.is(Value::Kind::kInteger) && !(f.is_wide() && value.integer < 0)) {
    const std::string text = number_problem(f, value.integer);
    return text.empty() ? good(value.integer) : problem(text);
  }
  if (f.enumeration && value.is(Value::Kind::kString)) return named(f, value.text);
  if (f.mask && value.is(Value::Kind::kArray)) return bits_of(f, value);
  return problem("expected " + expectation(f) + ", given " + value_text(value));
}

/// Compares "x" with the "x_name" or "x_bits" beside it.
NumberResult beside(const Field& f, const std::string& key, const Value& other,
                    const NumberResult* given) {
  // Decoding shows null for a value without a name.
  if (other.is(Value::Kind::kNull) && given) return *given;
  NumberResult result;
  if (f.mask && !other.is(Value::Kind::kArray)) {
    result = problem("expected an array of bit names, given " + value_text(other));
  } else if (!f.mask && !other.is(Value::Kind::kString)) {
    result = problem("expected a name, given " + value_text(other));
  } else {
    result = plain(f, other);
  }
  if (!result.problem.empty()) {
    result.problem = key + ": " + result.problem;
  } else if (given && given->value != result.value) {
    return problem("is given as " + integer_text(f, given->value) + ", but " + key + " says " +
                   integer_text(f, result.value) +
                   "; expected one of them alone, or both the same");
  }
  return result;
}

/// Returns the only possible value if none is given.
std::optional<std::int64_t> implied(const Field& f) {
  if (f.expect >= 0) return f.expect;
  if (f.valid.kind == ValidKind::kOneOf && f.valid.one_of_count == 1) return f.valid.one_of[0];
  if (f.valid.kind == ValidKind::kRange && f.valid.min == f.valid.max) return f.valid.min;
  return std::nullopt;
}

}  // namespace

NumberResult number_of(const Field& f, const Value& object, const Value* value) {
  NumberResult result;
  std::size_t members = 0;
  if (value) {
    ++members;
    result = plain(f, *value);
    if (!result.problem.empty()) return result;
  }
  if (f.enumeration || f.mask) {
    const std::string key = std::string(f.name) + (f.mask ? "_bits" : "_name");
    if (const Value* other = object.find(key)) {
      ++members;
      result = beside(f, key, *other, value ? &result : nullptr);
      if (!result.problem.empty()) return result;
    }
  }
  if (!result.present) {
    if (const auto only = implied(f)) result = good(*only);
  }
  if (result.present && f.kind != Kind::kFloat) result.problem = number_problem(f, result.value);
  result.members = members;
  return result;
}

std::string number_problem(const Field& f, std::int64_t value) {
  if (f.valid.kind == ValidKind::kOneOf) {
    for (int i = 0; i < f.valid.one_of_count; ++i) {
      if (f.valid.one_of[i] == value) return {};
    }
  } else if (f.limits().has(f.whole(value))) {
    return {};
  }
  return "expected " + expectation(f) + ", given " + integer_text(f, value);
}

std::string expectation(const Field& f) {
  if (f.kind == Kind::kFloat) return "a number";
  if (f.valid.kind == ValidKind::kOneOf) {
    std::string values;
    for (int i = 0; i < f.valid.one_of_count; ++i) {
      values += (i ? " or " : "") + to_string(f.valid.one_of[i]);
    }
    return values;
  }
  const auto end = [&](Whole value) { return integer_text(f, static_cast<std::int64_t>(value)); };
  std::string text = "a number from " + end(f.limits().min) + " to " + end(f.limits().max);
  if (f.enumeration) text += " or a name of " + std::string(f.enumeration->name);
  if (f.mask) text += " or an array of bits of " + std::string(f.mask->name);
  return text;
}

namespace {

/// Leaves the bits beside the field's as they are.
void store_bits(const Field& f, std::uint64_t value, std::uint8_t* at) {
  for (int bit = 0; bit < f.bit_width; ++bit) {
    const int place = bit + f.bit_shift;
    const int byte = f.little_endian ? place / 8 : f.width_bytes - 1 - place / 8;
    const auto one = static_cast<std::uint8_t>(1U << place % 8);
    at[byte] = static_cast<std::uint8_t>(value >> bit & 1 ? at[byte] | one : at[byte] & ~one);
  }
}

}  // namespace

void store_number(const Field& f, std::int64_t value, std::uint8_t* at) {
  if (f.kind == Kind::kBits) return store_bits(f, static_cast<std::uint64_t>(value), at);
  const auto raw = static_cast<std::uint32_t>(value);
  switch (f.width_bytes) {
    case 1: return store_u8(at, static_cast<std::uint8_t>(raw));
    case 2: {
      const auto half = static_cast<std::uint16_t>(raw);
      return f.little_endian ? store_le16(at, half) : store_be16(at, half);
    }
    case 8: {
      const auto high = static_cast<std::uint32_t>(static_cast<std::uint64_t>(value) >> 32);
      f.little_endian ? store_le32(at, raw) : store_be32(at, high);
      return f.little_endian ? store_le32(at + 4, high) : store_be32(at + 4, raw);
    }
    default: return f.little_endian ? store_le32(at, raw) : store_be32(at, raw);
  }
}

std::string value_text(const Value& value) {
  switch (value.kind) {
    case Value::Kind::kNull: return "null";
    case Value::Kind::kBool: return value.integer ? "true" : "false";
    case Value::Kind::kInteger: return to_string(value.integer);
    case Value::Kind::kReal: return value.text;
    case Value::Kind::kString: return quoted(value.text);
    case Value::Kind::kArray: return "an array";
    case Value::Kind::kObject: return "an object";
  }
  return {};
}

bool enum_value(const EnumTable& table, std::string_view name, std::int64_t& value) {
  for (int i = 0; i < table.count; ++i) {
    if (name == table.entries[i].name) {
      value = table.entries[i].value;
      return true;
    }
  }
  return false;
}

int mask_bit(const MaskTable& table, std::string_view name) {
  for (int i = 0; i < table.width_bits; ++i) {
    if (table.bit_names[i] && name == table.bit_names[i]) return i;
  }
  if (!name.starts_with(kBitPrefix)) return -1;
  int bit = -1;
  const char* end = name.data() + name.size();
  const auto [stop, error] = std::from_chars(name.data() + kBitPrefix.size(), end, bit);
  return error == std::errc{} && stop == end && bit >= 0 && bit < table.width_bits ? bit : -1;
}

bool parse_hex(std::string_view text, std::vector<std::uint8_t>& out) {
  int high = -1;
  for (const char c : text) {
    int digit = 0;
    if (c == ' ' && high < 0) continue;
    if (c >= '0' && c <= '9') {
      digit = c - '0';
    } else if (c >= 'a' && c <= 'f') {
      digit = c - 'a' + 10;
    } else if (c >= 'A' && c <= 'F') {
      digit = c - 'A' + 10;
    } else {
      return false;
    }
    if (high < 0) {
      high = digit;
    } else {
      out.push_back(static_cast<std::uint8_t>(high << 4 | digit));
      high = -1;
    }
  }
  return high < 0;
}

}  // namespace rubric::reflect
