#include "codec/frame_generator/values.h"

#include <algorithm>
#include <iterator>

namespace rubric::generate {
namespace {

using reflect::Field;
using reflect::Kind;
using reflect::Valid;
using reflect::ValidKind;

// Zeros, ones, a denormal, the greatest, infinities, a quiet NaN and a signalling one.
constexpr std::uint32_t kFloats[] = {
    0x00000000, 0x80000000, 0x3F800000, 0xBF800000, 0x00000001,
    0x7F7FFFFF, 0x7F800000, 0xFF800000, 0x7FC00000, 0x7F800001,
};

// The numbers around the greatest that int64 and a double of a whole number have, and the greatest.
constexpr std::uint64_t kWide[] = {
    0x7FFFFFFFFFFFFFFF,
    0x8000000000000000,
    0x20000000000001,
    0xFFFFFFFFFFFFFFFF,
};

template <class T, std::size_t kCount>
T one_of(const T (&values)[kCount], Random& random) {
  return values[random.below(kCount)];
}

std::int64_t clamp_to(Span span, std::int64_t value) {
  return std::clamp(value, span.min, span.max);
}

// Returns a value within the span that tends to break things.
std::int64_t notable(Span span, Random& random) {
  switch (random.below(6)) {
    case 0: return span.min;
    case 1: return span.max;
    case 2: return clamp_to(span, span.min + random.between(1, 2));
    case 3: return clamp_to(span, span.max - random.between(1, 2));
    case 4: return clamp_to(span, any_byte(random));
    default: return clamp_to(span, std::int64_t{1} << random.below(32));
  }
}

std::int64_t one_of_allowed(const Valid& valid, std::int64_t most, Random& random) {
  const std::int64_t chosen = valid.one_of[random.below(valid.one_of_count)];
  return chosen <= most ? chosen : valid.one_of[0];
}

}  // namespace

std::uint8_t any_byte(Random& random) {
  constexpr std::uint8_t kNotable[] = {0x00, 0x01, 0x7D, 0x7E, 0x7F, 0x80, 0xFE, 0xFF};
  return random.chance(0.2) ? one_of(kNotable, random) : static_cast<std::uint8_t>(random.next());
}

Span held(const Field& field) {
  const int bits = field.kind == Kind::kBits ? field.bit_width : 8 * field.width_bytes;
  // Of 64 bits without a sign, what an int64 holds: those that have no rule get more elsewhere.
  const std::uint64_t most = ~std::uint64_t{0} >> (64 - bits + field.is_wide());
  if (field.kind != Kind::kSint) return {0, static_cast<std::int64_t>(most)};
  return {-static_cast<std::int64_t>(most / 2) - 1, static_cast<std::int64_t>(most / 2)};
}

Span allowed(const Field& field) {
  const Valid& valid = field.valid;
  if (valid.kind == ValidKind::kRange) {
    return {valid.min, valid.max < valid.min ? held(field).max : valid.max};
  }
  if (valid.kind == ValidKind::kOneOf && valid.one_of_count) {
    const auto [least, most] = std::minmax_element(valid.one_of, valid.one_of + valid.one_of_count);
    return {*least, *most};
  }
  return held(field);
}

bool is_allowed(const Field& field, std::int64_t value) {
  const Valid& valid = field.valid;
  if (valid.kind == ValidKind::kOneOf) {
    const std::int64_t* const end = valid.one_of + valid.one_of_count;
    return std::find(valid.one_of, end, value) != end;
  }
  const Span span = allowed(field);
  return value >= span.min && value <= span.max;
}

std::int64_t allowed_value(const Field& field, std::int64_t most, Random& random) {
  if (field.kind == Kind::kFloat) {
    if (random.chance(0.3)) return one_of(kFloats, random);
    return static_cast<std::int64_t>(random.next() >> 32);
  }
  if (field.valid.kind == ValidKind::kOneOf) return one_of_allowed(field.valid, most, random);
  if (field.is_wide() && field.valid.kind == ValidKind::kAny && random.chance(0.4)) {
    return static_cast<std::int64_t>(random.chance(0.5) ? random.next() : one_of(kWide, random));
  }
  Span span = allowed(field);
  span.max = std::max(span.min, std::min(span.max, most));
  if (field.expect >= 0 && field.expect <= span.max && random.chance(0.8)) return field.expect;
  if (field.enumeration && field.enumeration->count && random.chance(0.5)) {
    const auto& entry = field.enumeration->entries[random.below(field.enumeration->count)];
    return clamp_to(span, entry.value);
  }
  return random.chance(0.4) ? notable(span, random) : random.between(span.min, span.max);
}

std::int64_t allowed_value(const Field& field, Random& random) {
  return allowed_value(field, held(field).max, random);
}

bool refused_value(const Field& field, Random& random, std::int64_t& value) {
  if (field.valid.kind == ValidKind::kAny || field.kind == Kind::kFloat) return false;
  const Span all = held(field);
  const Span good = allowed(field);
  const auto after = static_cast<std::int64_t>(static_cast<std::uint64_t>(good.max) + 1);
  const auto before = static_cast<std::int64_t>(static_cast<std::uint64_t>(good.min) - 1);
  const std::int64_t near[] = {before, after, all.min, all.max};
  constexpr int kTries = 40;  // A rule that refuses but a few values is met by its neighbours.
  for (int i = 0; i < kTries; ++i) {
    value =
        random.chance(0.6) ? near[random.below(std::size(near))] : random.between(all.min, all.max);
    if (value >= all.min && value <= all.max && !is_allowed(field, value)) return true;
  }
  return false;
}

}  // namespace rubric::generate
