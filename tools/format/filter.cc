#include "tools/format/filter.h"

#include <fmt/format.h>

#include <algorithm>

#include "codec/text/text.h"

namespace rubric::format {
namespace {

using ValueKind = Value::Kind;

template <class T>
bool compare(Compare op, const T& a, const T& b) {
  switch (op) {
    case Compare::kEq: return a == b;
    case Compare::kNe: return a != b;
    case Compare::kLt: return a < b;
    case Compare::kLe: return a <= b;
    case Compare::kGt: return a > b;
    case Compare::kGe: return a >= b;
  }
  return false;
}

bool is_hex_of(std::string_view text, Bytes bytes) {
  if (text.size() != 2 * bytes.size()) return false;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    const char high = kDigits[bytes[i] >> 4];
    const char low = kDigits[bytes[i] & 15];
    if ((text[2 * i] | 0x20) != (high | 0x20) || (text[2 * i + 1] | 0x20) != (low | 0x20)) {
      return false;
    }
  }
  return true;
}

reflect::Whole whole_of(const Value& value) {
  return value.field ? value.field->whole(value.integer) : value.integer;
}

double number_of(const Value& value) {
  constexpr double kNanoseconds = 1e9;
  if (value.kind == ValueKind::kReal || value.kind == ValueKind::kUnit) return value.real;
  const auto integer = static_cast<double>(whole_of(value));
  return value.kind == ValueKind::kTime ? integer / kNanoseconds : integer;
}

bool is_number(const Value& value) {
  return value.kind == ValueKind::kInteger || value.kind == ValueKind::kReal ||
         value.kind == ValueKind::kUnit || value.kind == ValueKind::kTime ||
         value.kind == ValueKind::kBits;
}

bool is_whole(const Value& value) {
  return value.kind == ValueKind::kInteger || value.kind == ValueKind::kBits;
}

bool is_float(const Value& value) { return value.kind == ValueKind::kReal && value.field; }

bool compare_number(Compare op, const Value& value, const Operand& operand) {
  if (!is_number(value)) return false;
  if (is_whole(value)) return compare(op, 2 * whole_of(value), operand.halves);
  // A field of binary32 is compared with the nearest binary32, so that 0.1 means what it prints.
  if (is_float(value)) {
    return compare(op, static_cast<float>(value.real), static_cast<float>(operand.real));
  }
  return compare(op, number_of(value), operand.real);
}

bool compare_text(Compare op, const Value& value, const std::string& text) {
  bool equal = false;
  if (value.kind == ValueKind::kBytes) {
    equal = is_hex_of(text, value.bytes);
  } else {
    equal = value.text == text;
  }
  return op == Compare::kEq ? equal : !equal;
}

std::int64_t mask_of(const Term& term, const Value& value) {
  std::int64_t mask = term.mask;
  if (!value.field || !value.field->mask) return mask;
  const reflect::MaskTable& table = *value.field->mask;
  for (const std::string& name : term.mask_bits) {
    for (int bit = 0; bit < table.width_bits; ++bit) {
      const char* known = table.bit_names[bit];
      if (known ? name == known : name == fmt::format("bit{}", bit)) mask |= std::int64_t{1} << bit;
    }
  }
  return mask;
}

}  // namespace

// A caret below a longer expression points at nothing on a terminal.
constexpr std::size_t kMaxShown = 1000;

std::string FilterError::explain(std::string_view expression) const {
  if (expression.size() > kMaxShown) return fmt::format("{} (character {})", what(), position_ + 1);
  // Unprintable or non-ASCII characters would shift the caret.
  std::string shown(expression);
  for (char& c : shown) {
    if (c < ' ' || c > '~') c = '?';
  }
  return fmt::format("{}\n  {}\n  {:>{}}", text::harmless(what()), shown, '^', position_ + 1);
}

bool Filter::holds(std::size_t index, const Record& record) const {
  const Term& term = terms_[index];
  const auto part_holds = [&](std::size_t part) { return holds(part, record); };
  switch (term.kind) {
    case Term::Kind::kAny: return std::any_of(term.parts.begin(), term.parts.end(), part_holds);
    case Term::Kind::kAll: return std::all_of(term.parts.begin(), term.parts.end(), part_holds);
    case Term::Kind::kNot: return !part_holds(term.parts[0]);
    case Term::Kind::kPresent: return present(term, record);
    case Term::Kind::kCompare: return compares(term, record);
  }
  return false;
}

bool Filter::present(const Term& term, const Record& record) const {
  bool found = false;
  auto each = [&](const Value& value) {
    const bool empty = value.kind == ValueKind::kBytes && value.bytes.empty();
    found = term.masked ? is_number(value) && (value.integer & mask_of(term, value)) != 0 : !empty;
    return !found;
  };
  paths_[term.path].visit(record, each);
  return found;
}

bool Filter::compares(const Term& term, const Record& record) const {
  if (term.operand.kind == Operand::Kind::kPath) return compares_with_path(term, record);
  const bool negative = term.compare == Compare::kNe;
  const Compare op = negative ? Compare::kEq : term.compare;
  bool any_value = false;
  bool any_holds = false;
  auto each = [&](const Value& found) {
    Value value = found;
    if (term.masked) value.integer &= mask_of(term, value);
    any_value = true;
    any_holds = term.operand.kind == Operand::Kind::kText
                    ? compare_text(op, value, term.operand.text)
                    : compare_number(op, value, term.operand);
    return !any_holds;
  };
  paths_[term.path].visit(record, each);
  return negative ? any_value && !any_holds : any_holds;
}

bool Filter::compares_with_path(const Term& term, const Record& record) const {
  const bool negative = term.compare == Compare::kNe;
  const Compare op = negative ? Compare::kEq : term.compare;
  bool any_value = false;
  bool any_holds = false;
  auto each = [&](const Value& left) {
    auto other = [&](const Value& right) {
      any_value = true;
      if (is_number(left) && is_number(right)) {
        Value value = left;
        if (term.masked) value.integer &= mask_of(term, value);
        any_holds = is_whole(value) && is_whole(right)
                        ? compare(op, whole_of(value), whole_of(right))
                        : compare(op, number_of(value), number_of(right));
      } else if (left.kind == ValueKind::kBytes && right.kind == ValueKind::kBytes) {
        any_holds = op == Compare::kEq && equal(left.bytes, right.bytes);
      } else if (left.kind == ValueKind::kText && right.kind == ValueKind::kText) {
        any_holds = op == Compare::kEq && left.text == right.text;
      }
      return !any_holds;
    };
    paths_[term.operand.path].visit(record, other);
    return !any_holds;
  };
  paths_[term.path].visit(record, each);
  return negative ? any_value && !any_holds : any_holds;
}

}  // namespace rubric::format
