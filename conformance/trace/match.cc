#include "conformance/trace/match.h"

#include <algorithm>
#include <cmath>
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

namespace {

constexpr std::size_t kOtherMessage = 1000;

/// One attempt; what it binds counts only if all of it matches.
class Matcher {
 public:
  Matcher(const Concrete& seen, const Bindings& before)
      : seen_(seen), before_(before), covered_(seen.leaves.size(), false) {}

  void message(const Message& pattern) {
    if (pattern.name != "*" && pattern.name != seen_.name) {
      return differ("message", pattern.name, seen_.name);
    }
    if (pattern.form != Message::Form::kFields) return;
    const Shape* shape = Schema::get().find(pattern.name);
    if (!shape) return differ("message", "a known message", pattern.name);
    std::vector<FieldValue> fields;
    try {
      fields = with_paths(pattern, *shape);
    } catch (const TraceError& error) {
      return differ("message", error.what(), print_of(seen_.message));
    }
    for (const FieldValue& field : fields) one(field);
    if (!pattern.open) closed();
  }

  void am(const AmAddresses& addresses) {
    const auto side = [&](const Value& want, std::uint16_t id, const char* path) {
      Leaf leaf{.path = path, .domain = Domain::devid(), .number = id};
      if (!is(want, leaf)) differ(path, describe(want), value_text(leaf.show()));
    };
    if (!seen_.frame) return differ("am", "a frame", seen_.name);
    side(addresses.source, seen_.frame->src, "am source");
    side(addresses.dest, seen_.frame->dest, "am destination");
  }

  void bytes(const std::string& wanted) {
    std::string expected;
    std::string seen;
    put_hex(wanted, expected);
    if (seen_.frame) {
      const std::vector<std::uint8_t> packet = packet_of(*seen_.frame);
      put_hex({reinterpret_cast<const char*>(packet.data()), packet.size()}, seen);
    }
    if (expected != seen) differ("bytes", expected, seen.empty() ? "none" : seen);
  }

  Match take() { return std::move(match_); }
  const Bindings& bound() const { return bound_; }

 private:
  static std::string print_of(const Message& message) {
    std::string text = message.name + "(";
    for (const FieldValue& field : message.fields) {
      text += (text.back() == '(' ? "" : " ") + field.path + '=' + value_text(field.value);
    }
    return text + ')';
  }

  void differ(std::string_view path, std::string expected, std::string seen) {
    match_.differences.push_back({std::string(path), std::move(expected), std::move(seen)});
  }

  // Returns "$q = 7", from the binding.
  std::string describe(const Value& want) const {
    std::string text = value_text(want);
    const auto add = [&](const Value& value) {
      const bool range = value.is(Value::Kind::kRange) && !value.text.empty();
      if (!range && !value.is(Value::Kind::kVariable)) return;
      const Value* bound = find(value.text);
      text += bound ? " ($" + value.text + " = " + value_text(*bound) + ")"
                    : " ($" + value.text + " is not bound)";
    };
    add(want);
    for (const Value& item : want.items) add(item);
    return text;
  }

  void one(const FieldValue& field) {
    if (const Leaf* leaf = seen_.leaf(field.path)) {
      covered_[static_cast<std::size_t>(leaf - seen_.leaves.data())] = true;
      if (!is(field.value, *leaf)) {
        differ(field.path, describe(field.value), value_text(leaf->show()));
      }
      return;
    }
    if (const Part* part = seen_.part(field.path)) {
      std::fill(covered_.begin() + static_cast<std::ptrdiff_t>(part->first),
                covered_.begin() + static_cast<std::ptrdiff_t>(part->end), true);
      if (!is(field.value, *part)) {
        differ(field.path, describe(field.value), value_text(show(*part)));
      }
      return;
    }
    differ(field.path, describe(field.value), "no such field");
  }

  // Checks fields that the pattern leaves out, which must have their only possible value.
  void closed() {
    for (std::size_t i = 0; i < covered_.size(); ++i) {
      const Leaf& leaf = seen_.leaves[i];
      if (covered_[i] || leaf.domain.derived) continue;
      if (leaf.domain.implied < 0) {
        differ(leaf.path, "a value, or '...' in the pattern", value_text(leaf.show()));
      } else if (leaf.number != leaf.domain.implied) {
        differ(leaf.path, value_text(leaf.domain.show(leaf.domain.implied)),
               value_text(leaf.show()));
      }
    }
  }

  bool is(const Value& want, const Leaf& leaf) {
    if (want.is(Value::Kind::kVariable)) return binds(want, leaf.value());
    if (want.is(Value::Kind::kRange) && !want.text.empty()) return near(want, leaf);
    return same(want, leaf) != want.negated;
  }

  // Matches a range that is relative to a variable; if that is unbound it never matches. Behind a
  // field's greatest number comes its least: clocks go round (decision 119).
  bool near(const Value& want, const Leaf& leaf) const {
    const Value* base = find(want.text);
    if (!base || !base->is(Value::Kind::kNumber)) return false;
    if (leaf.domain.kind != Domain::Kind::kNumber) return want.negated;
    const std::int64_t size = leaf.domain.max - leaf.domain.min + 1;
    const std::int64_t beyond = (leaf.number - base->number - want.number) % size;
    return ((beyond + size) % size <= want.max - want.number) != want.negated;
  }

  const Value* find(const std::string& name) const {
    const Value* const value = bound_.find(name);
    return value ? value : before_.find(name);
  }

  // The first use binds.
  bool binds(const Value& want, Value seen) {
    if (const Value* value = find(want.text)) return equal(*value, seen) != want.negated;
    if (want.negated) return false;
    bound_.set(want.text, std::move(seen));
    return true;
  }

  // Text and bytes are equal if their bytes are: an application may be told as bytes what was text.
  static bool equal(const Value& one, Value other) {
    if (one.is(Value::Kind::kBytes) && other.is(Value::Kind::kText)) other.kind = one.kind;
    if (one.is(Value::Kind::kText) && other.is(Value::Kind::kBytes)) other.kind = one.kind;
    return one == other;
  }

  static bool same(const Value& want, const Leaf& leaf) {
    const bool real = leaf.domain.kind == Domain::Kind::kReal;
    const bool number = leaf.domain.kind == Domain::Kind::kNumber;
    switch (want.kind) {
      case Value::Kind::kAny: return true;
      case Value::Kind::kNumber:
        return real ? same_real(static_cast<float>(want.number), leaf)
                    : number && leaf.number == want.number;
      case Value::Kind::kRange:
        return number && leaf.number >= want.number && leaf.number <= want.max;
      case Value::Kind::kReal:
        return real && same_real(std::strtof(want.text.c_str(), nullptr), leaf);
      case Value::Kind::kNames: return number && leaf.domain.number_of(want.text) == leaf.number;
      case Value::Kind::kText:
        if (leaf.domain.characters) return leaf.text == want.text;
        [[fallthrough]];
      case Value::Kind::kBytes:
        return leaf.domain.kind == Domain::Kind::kBytes && leaf.bytes == want.text;
      default: return false;
    }
  }

  // Compares reals: any NaN equals any other; else bit by bit, except for the sign of zero.
  static bool same_real(float want, const Leaf& leaf) {
    const float seen = float_of_bits(static_cast<std::uint32_t>(leaf.number));
    return std::isnan(want) ? std::isnan(seen) : want == seen;
  }

  bool is(const Value& want, const Part& part) {
    if (want.is(Value::Kind::kVariable)) return binds(want, plain(part));
    return same(want, part) != want.negated;
  }

  bool same(const Value& want, const Part& part) {
    if (want.is(Value::Kind::kAny)) return true;
    if (want.is(Value::Kind::kBytes) || want.is(Value::Kind::kText)) {
      return part.kind == Slot::Kind::kStruct && part.bytes == want.text;
    }
    const bool fits = (want.is(Value::Kind::kAddress) && part.kind == Slot::Kind::kAddress) ||
                      (want.is(Value::Kind::kChannel) && part.kind == Slot::Kind::kChannel) ||
                      (want.is(Value::Kind::kList) && part.kind == Slot::Kind::kList);
    if (!fits || want.items.size() != part.end - part.first) return false;
    bool all = true;
    for (std::size_t i = 0; i < want.items.size(); ++i) {
      all = is(want.items[i], seen_.leaves[part.first + i]) && all;
    }
    return all;
  }

  /// Returns the value to bind a variable to.
  Value plain(const Part& part) const {
    if (part.kind == Slot::Kind::kStruct) return Value::bytes(part.bytes);
    Value value{.kind = part.kind == Slot::Kind::kAddress   ? Value::Kind::kAddress
                        : part.kind == Slot::Kind::kChannel ? Value::Kind::kChannel
                                                            : Value::Kind::kList};
    for (std::size_t i = part.first; i < part.end; ++i) {
      value.items.push_back(seen_.leaves[i].value());
    }
    return value;
  }

  Value show(const Part& part) const {
    Value value = plain(part);
    for (std::size_t i = 0; i < value.items.size(); ++i) {
      value.items[i] = seen_.leaves[part.first + i].show();
    }
    return value;
  }

  const Concrete& seen_;
  const Bindings& before_;
  Bindings bound_;  // By this attempt: a case may have bound any number before.
  std::vector<bool> covered_;
  Match match_;
};

}  // namespace

std::size_t Match::distance() const {
  std::size_t sum = differences.size();
  for (const Difference& one : differences) sum += one.path == "message" ? kOtherMessage : 0;
  return sum;
}

std::string Match::text() const {
  std::string text;
  for (const Difference& one : differences) {
    text +=
        (text.empty() ? "" : "; ") + one.path + ": expected " + one.expected + ", seen " + one.seen;
  }
  return text;
}

Message opened(const Message& message) {
  Message copy = message;
  if (copy.form == Message::Form::kFields) copy.open = true;
  return copy;
}

namespace {

// `am(type payload)` matches the frame as such, whatever it decodes to.
Match match_message(const Message& pattern, const Line* line, const Concrete& seen,
                    const Bindings& before, Bindings* bindings) {
  if (pattern.name == kFrameName && seen.name != kFrameName && seen.frame) {
    return match_message(pattern, line, decode_raw(*seen.frame), before, bindings);
  }
  Matcher matcher(seen, before);
  matcher.message(pattern);
  if (line && line->am) matcher.am(*line->am);
  if (line && line->bytes) matcher.bytes(*line->bytes);
  Match match = matcher.take();
  if (!match || !bindings) return match;
  for (const auto& [name, value] : matcher.bound().all()) bindings->set(name, value);
  return match;
}

Match match_line(const Line& line, const Concrete& seen, const Bindings& before,
                 Bindings* bindings) {
  if (is_fault(line.op)) return match_message(opened(line.message), &line, seen, before, bindings);
  return match_message(line.message, &line, seen, before, bindings);
}

}  // namespace

Match match(const Line& line, const Concrete& seen, Bindings& bindings) {
  return match_line(line, seen, bindings, &bindings);
}

Match compare(const Line& line, const Concrete& seen, const Bindings& bindings) {
  return match_line(line, seen, bindings, nullptr);
}

bool may_match(const Message& pattern, std::string_view seen) {
  return pattern.name == "*" || pattern.name == seen || pattern.name == kFrameName;
}

Match match(const Message& pattern, const Concrete& seen, Bindings& bindings) {
  return match_message(pattern, nullptr, seen, bindings, &bindings);
}

Value substituted(const Value& value, const Bindings& bindings, Place place) {
  if (value.is(Value::Kind::kAny)) throw TraceError(place, "expected a value, given '*'");
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
    const std::vector<AppField>& fields = shape.app->fields;
    if (position >= fields.size()) {
      throw TraceError(field.place,
                       shape.name + " has " + std::to_string(fields.size()) + " fields");
    }
    whole.path = fields[position++].name;
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
