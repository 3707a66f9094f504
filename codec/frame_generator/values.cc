#include "codec/frame_generator/values.h"

#include <algorithm>
#include <iterator>

namespace rubric::generate {
namespace {

using reflect::Field;
using reflect::Kind;
using reflect::Span;
using reflect::Valid;
using reflect::ValidKind;
using reflect::Whole;

// Zeros, ones, a denormal, the greatest, infinities, a quiet NaN and a signalling one.
constexpr std::uint32_t kFloats[] = {
    0x00000000, 0x80000000, 0x3F800000, 0xBF800000, 0x00000001,
    0x7F7FFFFF, 0x7F800000, 0xFF800000, 0x7FC00000, 0x7F800001,
};

template <class T, std::size_t kCount>
T one_of(const T (&values)[kCount], Random& random) {
  return values[random.below(kCount)];
}

Whole clamp_to(Span span, Whole value) { return std::clamp(value, span.min, span.max); }

std::int64_t bits_of(Whole value) { return static_cast<std::int64_t>(value); }
std::int64_t between(Span span, Random& random) {
  return random.between(bits_of(span.min), bits_of(span.max));
}

// Returns a value within the span that tends to break things.
Whole notable(Span span, Random& random) {
  switch (random.below(6)) {
    case 0: return span.min;
    case 1: return span.max;
    case 2: return clamp_to(span, span.min + random.between(1, 2));
    case 3: return clamp_to(span, span.max - random.between(1, 2));
    case 4: return clamp_to(span, any_byte(random));
    default: return clamp_to(span, Whole{1} << random.below(span.max > UINT32_MAX ? 64 : 32));
  }
}

std::int64_t one_of_allowed(const Valid& valid, Whole most, Random& random) {
  const std::int64_t chosen = valid.one_of[random.below(valid.one_of_count)];
  return chosen <= most ? chosen : valid.one_of[0];
}

}  // namespace

std::uint8_t any_byte(Random& random) {
  constexpr std::uint8_t kNotable[] = {0x00, 0x01, 0x7D, 0x7E, 0x7F, 0x80, 0xFE, 0xFF};
  return random.chance(0.2) ? one_of(kNotable, random) : static_cast<std::uint8_t>(random.next());
}

Span allowed(const Field& field) {
  const Valid& valid = field.valid;
  if (valid.kind == ValidKind::kOneOf && valid.one_of_count) {
    const auto [least, most] = std::minmax_element(valid.one_of, valid.one_of + valid.one_of_count);
    return {*least, *most};
  }
  return field.limits();
}

bool is_allowed(const Field& field, std::int64_t value) {
  const Valid& valid = field.valid;
  if (valid.kind == ValidKind::kOneOf) {
    const std::int64_t* const end = valid.one_of + valid.one_of_count;
    return std::find(valid.one_of, end, value) != end;
  }
  return field.limits().has(field.whole(value));
}

std::int64_t allowed_value(const Field& field, Whole most, Random& random) {
  if (field.kind == Kind::kFloat) {
    if (random.chance(0.3)) return one_of(kFloats, random);
    return static_cast<std::int64_t>(random.next() >> 32);
  }
  if (field.valid.kind == ValidKind::kOneOf) return one_of_allowed(field.valid, most, random);
  Span span = allowed(field);
  span.max = std::max(span.min, std::min(span.max, most));
  if (field.expect >= 0 && field.expect <= span.max && random.chance(0.8)) return field.expect;
  if (field.enumeration && field.enumeration->count && random.chance(0.5)) {
    const auto& entry = field.enumeration->entries[random.below(field.enumeration->count)];
    return bits_of(clamp_to(span, entry.value));
  }
  return random.chance(0.4) ? bits_of(notable(span, random)) : between(span, random);
}

std::int64_t allowed_value(const Field& field, Random& random) {
  return allowed_value(field, field.held().max, random);
}

bool refused_value(const Field& field, Random& random, std::int64_t& value) {
  if (field.valid.kind == ValidKind::kAny || field.kind == Kind::kFloat) return false;
  const Span all = field.held();
  const Span good = allowed(field);
  const Whole near[] = {good.min - 1, good.max + 1, all.min, all.max};
  constexpr int kTries = 40;  // A rule that refuses but a few values is met by its neighbours.
  for (int i = 0; i < kTries; ++i) {
    const Whole tried = random.chance(0.6) ? near[random.below(std::size(near))]
                                           : field.whole(between(all, random));
    value = bits_of(tried);
    if (all.has(tried) && !is_allowed(field, value)) return true;
  }
  return false;
}

}  // namespace rubric::generate
