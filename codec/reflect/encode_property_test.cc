// Random trees of values of every message: encoding and decoding gives back the same tree.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <map>
#include <string>

#include "codec/reflect/encode.h"
#include "codec/reflect/encode_number.h"
#include "codec/reflect/registry.h"

namespace rubric::reflect {
namespace {

std::int64_t pick(std::int64_t min, std::int64_t max) {
  return min +
         static_cast<std::int64_t>(*rc::gen::resize(
             100, rc::gen::inRange<std::uint64_t>(0, static_cast<std::uint64_t>(max - min) + 1)));
}
bool chance(int percent) { return pick(0, 99) < percent; }

/// Grows a tree of values of a type, and the same tree as decoding shows it: every number there, by
/// its value.
class Grower {
 public:
  struct Trees {
    Value given = Value::of_object();
    Value shown = Value::of_object();
  };

  Trees structure(const Type& type, std::size_t room) {
    Trees trees;
    const std::size_t base = bytes_.size();
    for (std::uint16_t i = 0; i < type.field_count; ++i) {
      const Field& f = type.fields[i];
      if (f.condition.count && !evaluate(f.condition, from(base))) continue;
      const std::size_t left = room - (bytes_.size() - base);
      if (f.kind == Kind::kBytes && interpretation(type, i, base, left, trees)) continue;
      field(type, f, base, left, trees);
    }
    return trees;
  }

  std::vector<std::uint8_t> bytes_;  // The bytes grown so far, for expressions.

 private:
  Bytes from(std::size_t base) const { return Bytes(bytes_.data() + base, bytes_.size() - base); }

  void put(Trees& trees, const Field& f, Value given, Value shown) {
    trees.given.set(f.name, std::move(given));
    trees.shown.set(f.name, std::move(shown));
  }

  void field(const Type& type, const Field& f, std::size_t base, std::size_t room, Trees& trees) {
    if (f.repeat != Repeat::kOnce) return array(f, base, room, trees);
    if (f.kind <= Kind::kMask) return number(type, f, base, trees);
    if (f.kind == Kind::kBytes) {
      const auto size = f.extent == Extent::kSize
                            ? evaluate(f.size, from(base))
                            : pick(0, static_cast<std::int64_t>(std::min<std::size_t>(room, 9)));
      std::string hex;
      for (std::int64_t i = 0; i < size; ++i) {
        const auto byte = static_cast<std::uint8_t>(pick(0, 255));
        bytes_.push_back(byte);
        hex += "0123456789abcdef"[byte >> 4];
        hex += "0123456789abcdef"[byte & 15];
      }
      return put(trees, f, Value::of_string(hex), Value::of_string(hex));
    }
    const Type* chosen = f.choice ? choose(*f.choice, evaluate(f.choice->key, from(base))) : f.type;
    const std::size_t at = bytes_.size();
    Trees inner = structure(*chosen, room);
    put(trees, f, std::move(inner.given), std::move(inner.shown));
    if (f.extent == Extent::kSize) settle(f, base, bytes_.size() - at, trees);
  }

  // Settles a size that was grown at random, before there was anything to measure.
  void settle(const Field& f, std::size_t base, std::size_t size, Trees& trees) {
    const auto at = base + static_cast<std::size_t>(f.size.steps[0].value);
    ASSERT_EQ(f.size.count, 1);
    bytes_[at] = static_cast<std::uint8_t>(size);
    const auto correct = [&](Value& object) {
      for (std::size_t i = 0; i < object.keys.size(); ++i) {
        if (object.keys[i] == measures_[at]) {
          object.items[i] = Value::of_integer(static_cast<std::int64_t>(size));
        }
      }
    };
    correct(trees.given);
    correct(trees.shown);
  }

  void array(const Field& f, std::size_t base, std::size_t room, Trees& trees) {
    std::int64_t count = 0;
    if (f.repeat == Repeat::kCount) {
      count = evaluate(f.count, from(base));
    } else {
      count = pick(0, static_cast<std::int64_t>(std::min<std::size_t>(room / f.width_bytes, 10)));
    }
    Value given = Value::of_array({});
    Value shown = Value::of_array({});
    for (std::int64_t i = 0; i < count; ++i) {
      if (f.kind == Kind::kStruct) {
        Trees inner = structure(*f.type, room);
        given.items.push_back(std::move(inner.given));
        shown.items.push_back(std::move(inner.shown));
      } else {
        const std::int64_t value = some_value(f);
        append(f, value);
        given.items.push_back(plain(f, value));
        shown.items.push_back(plain(f, value));
      }
    }
    put(trees, f, std::move(given), std::move(shown));
  }

  static Value plain(const Field& f, std::int64_t value) {
    if (f.kind != Kind::kFloat) return Value::of_integer(value);
    char text[32];
    std::snprintf(text, sizeof(text), "%.9g",
                  static_cast<double>(float_of_bits(static_cast<std::uint32_t>(value))));
    return Value::of_real(text);
  }

  static std::int64_t some_value(const Field& f) {
    if (f.kind == Kind::kFloat) {
      return bits_of_float(static_cast<float>(pick(-1000000, 1000000)) / 512);
    }
    if (f.valid.kind == ValidKind::kOneOf) {
      return f.valid.one_of[pick(0, f.valid.one_of_count - 1)];
    }
    if (f.valid.kind == ValidKind::kRange) return pick(f.valid.min, f.valid.max);
    if (f.enumeration && chance(70)) {
      return f.enumeration->entries[pick(0, f.enumeration->count - 1)].value;
    }
    const int bits = 8 * f.width_bytes;
    const std::int64_t half = std::int64_t{1} << (bits - 1);
    return f.kind == Kind::kSint ? pick(-half, half - 1) : pick(0, 2 * half - 1);
  }

  void append(const Field& f, std::int64_t value) {
    bytes_.resize(bytes_.size() + f.width_bytes);
    store_number(f, value, bytes_.data() + bytes_.size() - f.width_bytes);
  }

  // Returns whether a size or count of the same structure reads the number at this offset.
  static bool is_measure(const Type& type, std::size_t offset) {
    for (int i = 0; i < type.field_count; ++i) {
      for (const Expr* expr : {&type.fields[i].size, &type.fields[i].count}) {
        if (expr->count == 1 && expr->steps[0].op != Op::kConst &&
            static_cast<std::size_t>(expr->steps[0].value) == offset) {
          return true;
        }
      }
    }
    return false;
  }

  void number(const Type& type, const Field& f, std::size_t base, Trees& trees) {
    const std::size_t at = bytes_.size();
    const auto forced = forced_.find(at);
    const std::int64_t value = forced != forced_.end() ? forced->second : some_value(f);
    append(f, value);
    trees.shown.set(f.name, plain(f, value));
    if (is_measure(type, at - base)) {
      measures_[at] = f.name;
      if (chance(50)) trees.given.set(f.name, Value::of_integer(value));
      return;
    }
    if (f.expect >= 0 && f.expect == value && chance(30)) return;
    spell(f, value, trees.given);
  }

  // Spells a number in one of its possible ways.
  static void spell(const Field& f, std::int64_t value, Value& given) {
    const std::string beside = std::string(f.name) + (f.mask ? "_bits" : "_name");
    Value other;
    if (f.enumeration && enum_name(*f.enumeration, value)) {
      other = Value::of_string(enum_name(*f.enumeration, value));
    } else if (f.mask) {
      other = Value::of_array({});
      for (int bit = f.mask->width_bits - 1; bit >= 0; --bit) {
        if (!(value >> bit & 1)) continue;
        const char* name = f.mask->bit_names[bit];
        other.items.push_back(Value::of_string(name ? name : "bit" + std::to_string(bit)));
      }
    }
    const std::int64_t way = other.is(Value::Kind::kNull) ? 0 : pick(0, 3);
    if (way == 0 || way == 3) given.set(f.name, plain(f, value));
    if (way == 1) given.set(f.name, other);
    if (way >= 2) given.set(beside, other);
  }

  // Grows the first interpretation that decoding would take; returns false if the bytes stay
  // opaque.
  bool interpretation(const Type& type, std::uint16_t index, std::size_t base, std::size_t room,
                      Trees& trees) {
    for (int k = 0; k < type.interpretation_count; ++k) {
      const Interpretation& candidate = type.interpretations[k];
      const Field& f = candidate.field;
      if (candidate.overlays != index) continue;
      if (f.condition.count && !evaluate(f.condition, from(base))) continue;
      const Type* chosen = f.type;
      if (f.choice) {
        const auto at = base + static_cast<std::size_t>(f.choice->key.steps[0].value);
        const auto c = pick(0, f.choice->count - (f.choice->otherwise ? 0 : 1));
        std::int64_t key = c < f.choice->count ? f.choice->cases[c].key : 0;
        while (c == f.choice->count && choose(*f.choice, key) != f.choice->otherwise) ++key;
        chosen = choose(*f.choice, key);
        forced_[at] = key;
      }
      Trees inner = structure(*chosen, room);
      put(trees, f, std::move(inner.given), std::move(inner.shown));
      return true;
    }
    return false;
  }

  std::map<std::size_t, std::int64_t> forced_;   // Keys that were chosen before they grow.
  std::map<std::size_t, std::string> measures_;  // Names of sizes, by their place.
};

// Returns decoded nodes as a tree.
Value tree_of(const Decoded& decoded, std::size_t i) {
  const Node& node = decoded[i];
  const auto number = [&](std::int64_t value) {
    if (node.field->kind != Kind::kFloat) return Value::of_integer(value);
    char text[32];
    std::snprintf(text, sizeof(text), "%.9g",
                  static_cast<double>(float_of_bits(static_cast<std::uint32_t>(value))));
    return Value::of_real(text);
  };
  Value value;
  switch (node.kind) {
    case NodeKind::kNumber: return number(node.value);
    case NodeKind::kNumberArray:
      value = Value::of_array({});
      for (std::uint32_t k = 0; k < node.count; ++k) {
        const std::uint8_t* at = decoded.bytes.data() + node.offset + k * node.field->width_bytes;
        value.items.push_back(number(load_number(*node.field, at)));
      }
      return value;
    case NodeKind::kBytes: {
      std::string hex;
      for (const std::uint8_t byte : decoded.bytes.sub(node.offset, node.size)) {
        hex += "0123456789abcdef"[byte >> 4];
        hex += "0123456789abcdef"[byte & 15];
      }
      return Value::of_string(hex);
    }
    case NodeKind::kStruct: value = Value::of_object(); break;
    case NodeKind::kStructArray: value = Value::of_array({}); break;
  }
  for (std::size_t k = i + 1; k < node.end; k = decoded[k].end) {
    if (value.is(Value::Kind::kArray)) {
      value.items.push_back(tree_of(decoded, k));
    } else {
      value.set(decoded[k].field->name, tree_of(decoded, k));
    }
  }
  return value;
}

std::string dump(const Value& value) {
  std::string text;
  switch (value.kind) {
    case Value::Kind::kArray:
    case Value::Kind::kObject:
      for (std::size_t i = 0; i < value.items.size(); ++i) {
        text += (i ? ", " : "") + (value.keys.empty() ? "" : value.keys[i] + ": ") +
                dump(value.items[i]);
      }
      return value.is(Value::Kind::kArray) ? '[' + text + ']' : '{' + text + '}';
    default: return value_text(value);
  }
}

void round_trip(const Type& type) {
  Grower grower;
  const Grower::Trees trees = grower.structure(type, std::min<std::uint32_t>(type.max_size, 200));
  std::vector<std::uint8_t> bytes;
  std::vector<std::uint8_t> stale(static_cast<std::size_t>(chance(30) ? pick(1, 9) : 0), 0xee);
  // Nothing can be stale after a structure that reaches to the end.
  if (type.max_size == UINT32_MAX || type.interpretation_count) stale.clear();
  const Field& last = type.fields[type.field_count - 1];
  if (last.repeat == Repeat::kToEnd || last.extent == Extent::kToEnd) stale.clear();
  try {
    encode(type, trees.given, Bytes(stale.data(), stale.size()), Tail::kStale, bytes);
  } catch (const EncodeError& error) {
    RC_FAIL(std::string(error.what()) + " in " + dump(trees.given));
  }
  Decoded decoded;
  decode(type, Bytes(bytes.data(), bytes.size()), Tail::kStale, true, decoded);
  RC_ASSERT(decoded.error.fault == Fault::kNone);
  RC_ASSERT(dump(tree_of(decoded, 0)) == dump(trees.shown));
  RC_ASSERT((decoded.stale_count() ? decoded.stale()[0].size : 0u) == stale.size());
}

class EncodeProperty : public testing::TestWithParam<const Type*> {};

TEST_P(EncodeProperty, DecodeGivesTheSameTree) {
  EXPECT_TRUE(rc::check([] { round_trip(*GetParam()); }));
}

std::vector<const Type*> messages() {
  std::vector<const Type*> all;
  for (const Protocol* protocol : protocols()) {
    for (int i = 0; i < protocol->type_count; ++i) {
      bool is_carrier = false;
      for (int c = 0; c < protocol->carrier_count; ++c) {
        is_carrier = is_carrier || protocol->carriers[c].type == protocol->types[i];
      }
      if (!is_carrier) all.push_back(protocol->types[i]);
    }
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(Messages, EncodeProperty, testing::ValuesIn(messages()),
                         [](const auto& row) { return std::string(row.param->id); });

}  // namespace
}  // namespace rubric::reflect
