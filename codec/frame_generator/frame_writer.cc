#include "codec/frame_generator/frame_writer.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "codec/frame_generator/draft.h"
#include "codec/frame_generator/frame_generator.h"
#include "codec/frame_generator/routes.h"
#include "codec/frame_generator/values.h"
#include "codec/generated/tinyos/enums.h"
#include "codec/reflect/decode.h"
#include "codec/reflect/encode_number.h"
#include "codec/reflect/text_field.h"

namespace rubric::generate {
namespace {

using reflect::Expr;
using reflect::Extent;
using reflect::Field;
using reflect::Interpretation;
using reflect::Kind;
using reflect::Repeat;
using reflect::Type;

constexpr std::int64_t kMostEmpty = 16;

std::uint32_t index32(std::size_t n) { return static_cast<std::uint32_t>(n); }

// Returns the load of the one number that the expression is; null if it is more.
const reflect::ExprStep* lone_step(const Expr& expr) {
  return expr.count == 1 && is_load(expr.steps[0].op) ? &expr.steps[0] : nullptr;
}

std::uint32_t element_bytes(const Field& f) {
  return f.kind == Kind::kStruct ? f.type->max_size : f.width_bytes;
}

/// One attempt. Chance may lead to something impossible (a count that leaves no room, application
/// numbers that happen to name another message): then it fails, and the next one may not.
class FrameWriter {
 public:
  FrameWriter(const reflect::Route& route, bool radio, std::size_t max_bytes, Random& random)
      : route_(route), max_bytes_(max_bytes), random_(random) {
    draft_.radio = radio;
    draft_.bare = is_bare(route);
  }

  bool write(const Type& carrier) {
    reached_ = same_message(route_.type, &carrier);
    if (reached_) draft_.path.push_back(&carrier);
    return structure(carrier, kNone, max_bytes_, true) && reached_;
  }

  Draft& draft() { return draft_; }

 private:
  /// The structure that a field is written into.
  struct Place {
    const Type& type;
    std::uint32_t scope;
    std::size_t base;
    std::size_t end;  ///< None of its bytes is after this.
    bool hard;
    const std::int64_t* params;  ///< Those of the type, null if it has none.
  };

  std::size_t size() const { return draft_.bytes.size(); }
  Bytes from(std::size_t base) const {
    return Bytes(draft_.bytes.data() + base, draft_.bytes.size() - base);
  }
  std::size_t left(const Place& place) const { return place.end - size(); }
  bool goes_on() const { return !reached_ && route_.offset >= size(); }

  std::uint32_t add_part(PartKind kind, const Field& f, const Place& place) {
    const std::uint32_t index = index32(draft_.parts.size());
    draft_.parts.push_back(
        {kind, &f, place.scope, index32(size()), 0, 1, kNone, index + 1, false, place.hard});
    return index;
  }

  void close_part(std::uint32_t part) {
    Part& closed = draft_.parts[part];
    closed.size = index32(size()) - closed.at;
    closed.last_inside = index32(draft_.parts.size());
  }

  std::uint32_t measure_of(const Expr& expr, const Place& place) const {
    const reflect::ExprStep* const load = lone_step(expr);
    if (!load) return kNone;
    if (load->from != 0) return part_of(load->from - 1, place);
    const std::size_t at = place.base + static_cast<std::size_t>(load->value);
    for (std::uint32_t i = 0; i < draft_.parts.size(); ++i) {
      if (draft_.parts[i].kind == PartKind::kNumber && draft_.parts[i].at == at) return i;
    }
    return kNone;
  }

  /// Returns the number that field `index` of a structure is.
  std::uint32_t part_of(int index, const Place& place) const {
    for (std::uint32_t i = 0; i < draft_.parts.size(); ++i) {
      const Part& part = draft_.parts[i];
      const bool is_it = part.scope == place.scope && part.field == &place.type.fields[index];
      if (is_it && part.kind == PartKind::kNumber) return i;
    }
    return kNone;
  }

  std::int64_t value_of(const Expr& expr, const Place& place) const {
    if (!expr.floats) return reflect::evaluate(expr, from(place.base), place.params);
    const auto start_of = [&](int index) -> std::size_t {
      const std::uint32_t part = part_of(index, place);
      return part == kNone ? reflect::kNowhere : draft_.parts[part].at - place.base;
    };
    return reflect::evaluate_floating(expr, from(place.base), start_of, place.params);
  }

  /// Returns whether the expression is the number `f` alone, which comes next.
  bool is_alone(const Expr& expr, const Field& f, const Place& place) const {
    const reflect::ExprStep* const load = lone_step(expr);
    if (!load) return false;
    if (load->from != 0) return &place.type.fields[load->from - 1] == &f;
    return load->value == static_cast<std::int32_t>(size() - place.base);
  }

  /// Writes a structure into another one, which says what its parameters are.
  bool call(const Type& type, const reflect::Argument* arguments, std::size_t room,
            const Place& place) {
    std::int64_t values[reflect::kMaxParams] = {};
    for (int i = 0; arguments && i < type.param_count; ++i) {
      values[i] = value_of(arguments[i].value, place);
      if (values[i] < arguments[i].min || values[i] > arguments[i].max) return false;
    }
    return structure(type, place.scope, room, place.hard, values);
  }

  bool structure(const Type& type, std::uint32_t parent, std::size_t room, bool hard,
                 const std::int64_t* params = nullptr) {
    const std::size_t base = size();
    draft_.scopes.push_back({parent, index32(base), kNone, &type});
    const std::size_t end = base + std::min<std::size_t>(room, type.max_size);
    const Place place{type, index32(draft_.scopes.size() - 1), base, end, hard, params};
    for (std::uint16_t i = 0; i < type.field_count; ++i) {
      const Field& f = type.fields[i];
      if (f.condition.count && !value_of(f.condition, place)) continue;
      if (!field(f, i, place) || size() > end) return false;
    }
    return true;
  }

  bool field(const Field& f, std::uint16_t index, const Place& place) {
    if (f.repeat != Repeat::kOnce) return array(f, place);
    if (f.width_bytes != 0) return number(f, place);
    if (f.kind == Kind::kStruct) return nested(f, place);
    return is_interpreted(place.type, index) ? interpreted(f, index, place) : opaque(f, place);
  }

  // Numbers.

  bool number(const Field& f, const Place& place) {
    if (left(place) + f.shared_bytes() < f.width_bytes) return false;
    std::int64_t value = 0;
    const bool given = f.kind != Kind::kBits && forced(f, size(), value);
    if (given && !is_allowed(f, value)) return false;
    // The measure of a structure is corrected when the structure is written.
    if (!given) {
      value = measures_room(f, place) ? static_cast<std::int64_t>(allowed(f).min)
                                      : allowed_value(f, most_for(f, place), random_);
    }
    const std::uint32_t part = add_part(PartKind::kNumber, f, place);
    draft_.parts[part].at -= f.shared_bytes();
    put(f, value);
    close_part(part);
    return true;
  }

  bool forced(const Field& f, std::size_t at, std::int64_t& value) {
    for (int i = 0; i < route_.choice_count; ++i) {
      const reflect::RouteChoice& choice = route_.choices[i];
      if (choice.offset != at || choice.width_bytes != f.width_bytes) continue;
      value = choice.value;
      return true;
    }
    if (!draft_.radio || at != 0) return false;
    using tinyos::FrameControl;
    const bool asks = random_.chance(0.5);
    value = static_cast<std::int64_t>(asks ? FrameControl::kDataAckRequest : FrameControl::kData);
    return true;
  }

  // Returns the most that a number may be so that the array which it counts has room.
  reflect::Whole most_for(const Field& f, const Place& place) const {
    const std::size_t behind = left(place) + f.shared_bytes() - f.width_bytes;
    for (const Field* g = &f + 1; g < place.type.fields + place.type.field_count; ++g) {
      if (g->repeat == Repeat::kCount && is_alone(g->count, f, place)) {
        return behind / element_bytes(*g);
      }
      if (g->extent == Extent::kSize && is_alone(g->size, f, place)) return behind;
    }
    return f.held().max;
  }

  bool measures_room(const Field& f, const Place& place) const {
    for (const Field* g = &f + 1; g < place.type.fields + place.type.field_count; ++g) {
      if (g->kind == Kind::kStruct && g->repeat == Repeat::kOnce && g->extent == Extent::kSize &&
          is_alone(g->size, f, place)) {
        return true;
      }
    }
    return false;
  }

  void put(const Field& f, std::int64_t value) {
    const std::size_t at = size() - f.shared_bytes();
    draft_.bytes.resize(at + f.width_bytes);
    reflect::store_number(f, value, draft_.bytes.data() + at);
  }

  // Arrays and bytes.

  bool array(const Field& f, const Place& place) {
    if (f.repeat == Repeat::kUntil) return until(f, place);
    const std::size_t width = element_bytes(f);
    if (f.kind == Kind::kStruct && f.type->min_size != width) return varying(f, place);
    const std::uint32_t part = add_part(PartKind::kArray, f, place);
    draft_.parts[part].element_bytes = index32(width);
    std::size_t room = left(place);
    if (f.extent == Extent::kSize) {
      const std::int64_t bytes = value_of(f.size, place);
      if (bytes < 0 || static_cast<std::size_t>(bytes) > room) return false;
      room = static_cast<std::size_t>(bytes);
    }
    std::size_t count = room / width;
    if (f.repeat == Repeat::kCount) {
      const std::int64_t wanted = value_of(f.count, place);
      if (wanted < 0 || static_cast<std::size_t>(wanted) > count) return false;
      count = static_cast<std::size_t>(wanted);
      draft_.parts[part].measure = measure_of(f.count, place);
    } else if (f.extent == Extent::kSize) {
      if (count * width != room) return false;
      draft_.parts[part].measure = measure_of(f.size, place);
      draft_.parts[part].element_bytes = 1;  // The measure counts bytes.
    } else {
      count = random_.below(random_.chance(0.7) ? std::min<std::size_t>(count, 12) + 1 : count + 1);
      draft_.parts[part].open = true;
    }
    for (std::size_t i = 0; i < count; ++i) {
      if (f.kind != Kind::kStruct) {
        put(f, allowed_value(f, random_));
        continue;
      }
      const std::size_t begin = size();
      if (!call(*f.type, f.arguments, width, place) || size() != begin + width) return false;
    }
    close_part(part);
    return true;
  }

  bool varying(const Field& f, const Place& place) {
    const bool counted = f.repeat == Repeat::kCount;
    const std::int64_t count =
        counted ? value_of(f.count, place) : static_cast<std::int64_t>(random_.below(4));
    for (std::int64_t i = 0; i < count; ++i) {
      const std::size_t begin = size();
      if (!counted) draft_.ends.push_back(index32(begin));
      const bool good = call(*f.type, f.arguments, left(place), place);
      if (!good || (size() == begin && i > kMostEmpty)) return false;
    }
    if (!counted) {  // Bytes behind the last element would be one more.
      const std::uint32_t part = add_part(PartKind::kArray, f, place);
      draft_.parts[part].element_bytes = 1;
      draft_.parts[part].open = true;
      close_part(part);
    }
    return count >= 0;
  }

  // Writes elements up to one for which the condition holds; chance may not come upon such a one.
  bool until(const Field& f, const Place& place) {
    const bool numbers = f.kind != Kind::kStruct;
    const Type& type = numbers ? place.type : *f.type;
    const std::uint32_t part = add_part(PartKind::kArray, f, place);
    for (bool done = false; !done;) {
      const std::size_t begin = size();
      const std::uint32_t scope = index32(draft_.scopes.size());
      if (numbers && left(place) < f.width_bytes) return false;
      if (numbers) {
        put(f, random_.chance(0.3) ? 0 : allowed_value(f, random_));
      } else if (!call(type, f.arguments, left(place), place) || size() == begin) {
        return false;
      }
      done = value_of(f.until, {type, scope, begin, size(), place.hard, place.params}) != 0;
    }
    close_part(part);
    return true;
  }

  void noise(std::size_t bytes) {
    for (std::size_t i = 0; i < bytes; ++i) draft_.bytes.push_back(any_byte(random_));
  }

  // Writes characters in all the bytes, or fewer and their end.
  void text(const Field& f, std::size_t bytes) {
    const bool ends = f.extent == Extent::kTerminated;
    const std::size_t all = bytes / f.text->unit;
    const std::size_t begin = size();
    std::string content;
    for (std::size_t i = 0, most = all - ends - random_.below(all - ends + 1); i < most; ++i) {
      const auto c = static_cast<char>(random_.between(' ', '~'));
      if (c != f.text->terminator && c != f.text->padding) content += c;
    }
    const bool fills = f.text->terminator < 0 && f.text->padding < 0;
    if (fills) content.resize(all, '.');
    reflect::append_text(f, content, ends ? std::nullopt : std::optional(bytes), draft_.bytes);
    if (!ends) draft_.bytes.resize(begin + bytes);  // Half a character may be left.
  }

  bool opaque(const Field& f, const Place& place) {
    const std::uint32_t part = add_part(PartKind::kBytes, f, place);
    std::size_t bytes = random_.below(std::min<std::size_t>(left(place), 24) + 1);
    if (f.extent == Extent::kSize) {
      const std::int64_t wanted = value_of(f.size, place);
      if (wanted < 0 || static_cast<std::size_t>(wanted) > left(place)) return false;
      bytes = static_cast<std::size_t>(wanted);
      draft_.parts[part].measure = measure_of(f.size, place);
    } else if (f.extent == Extent::kTerminated) {
      const std::size_t unit = f.text->unit;
      if (left(place) < unit) return false;
      bytes = unit * (random_.below(std::min<std::size_t>(left(place), 24) / unit) + 1);
    } else {
      draft_.parts[part].open = true;
      if (random_.chance(0.1)) bytes = left(place);
    }
    f.text ? text(f, bytes) : noise(bytes);
    close_part(part);
    return true;
  }

  // Structures within structures.

  bool nested(const Field& f, const Place& place) {
    reflect::Chosen inner{f.type, f.arguments};
    if (f.choice) {
      inner = reflect::choose_with(*f.choice, value_of(f.choice->key, place));
      // A route that chooses leads to a message.
      if (!inner.type) {
        return route_.choice_count == 0 && (f.extent == Extent::kOwn || opaque(f, place));
      }
      draft_.path.push_back(inner.type);
    }
    if (same_message(inner.type, route_.type) && size() == route_.offset) reached_ = true;
    if (f.extent == Extent::kOwn) return call(*inner.type, inner.arguments, left(place), place);
    const std::uint32_t part = add_part(PartKind::kRoom, f, place);
    if (f.extent == Extent::kSize) return sized(f, inner, part, place);
    draft_.parts[part].open = true;
    if (!call(*inner.type, inner.arguments, left(place), place)) return false;
    if (!takes_all(part + 1)) stale(left(place));
    close_part(part);
    return true;
  }

  bool sized(const Field& f, reflect::Chosen inner, std::uint32_t part, const Place& place) {
    const std::uint32_t measure = measure_of(f.size, place);
    if (measure == kNone) return fixed(f, inner, part, place);
    const Field& number = *draft_.parts[measure].field;
    const reflect::Span span = allowed(number);
    const std::size_t begin = size();
    const std::size_t room = std::min(left(place), static_cast<std::size_t>(span.max));
    const std::size_t scope = draft_.scopes.size();
    if (!call(*inner.type, inner.arguments, room, place)) return false;
    if (!takes_all(part + 1)) {
      stale(begin + room - size());
      const auto least = static_cast<std::size_t>(std::max<reflect::Whole>(span.min, 0));
      if (size() - begin < least) noise(least - (size() - begin));
    }
    const auto bytes = static_cast<std::int64_t>(size() - begin);
    if (!is_allowed(number, bytes)) return false;
    reflect::store_number(number, bytes, draft_.bytes.data() + draft_.parts[measure].at);
    draft_.scopes[scope].end = index32(size());
    draft_.parts[part].measure = measure;
    close_part(part);
    return true;
  }

  // Fills the bytes that something other than one number says the structure has.
  bool fixed(const Field& f, reflect::Chosen inner, std::uint32_t part, const Place& place) {
    const std::int64_t bytes = value_of(f.size, place);
    if (bytes < 0 || static_cast<std::size_t>(bytes) > left(place)) return false;
    const std::size_t end = size() + static_cast<std::size_t>(bytes);
    const std::size_t scope = draft_.scopes.size();
    if (!call(*inner.type, inner.arguments, end - size(), place)) return false;
    noise(end - size());
    draft_.scopes[scope].end = index32(size());
    close_part(part);
    return true;
  }

  // Returns whether bytes after the last ones written would belong to it.
  bool takes_all(std::uint32_t first_part) const {
    for (std::size_t i = first_part; i < draft_.parts.size(); ++i) {
      const Part& part = draft_.parts[i];
      if (part.open && part.at + part.size == size()) return true;
    }
    return false;
  }

  void stale(std::size_t room) {
    if (room == 0 || !random_.chance(0.25)) return;
    const std::size_t most = random_.chance(0.3) ? room : std::min<std::size_t>(room, 8);
    noise(1 + random_.below(most));
  }

  // Interpretations.

  bool is_interpreted(const Type& type, std::uint16_t index) const {
    for (int i = 0; i < type.interpretation_count; ++i) {
      if (type.interpretations[i].overlays == index) return true;
    }
    return false;
  }

  bool interpreted(const Field& f, std::uint16_t index, const Place& place) {
    const std::uint32_t part = add_part(PartKind::kBytes, f, place);
    draft_.parts[part].open = true;
    const std::size_t at = size();
    const bool good = goes_on() ? inside(index, place)
                                : (noise(random_.below(std::min<std::size_t>(left(place), 16) + 1)),
                                   stays_opaque(index, at, place));
    if (!good) return false;
    close_part(part);
    return true;
  }

  bool inside(std::uint16_t index, const Place& place) {
    // The key of the choice is mostly the first byte, and the route has it.
    const std::size_t at = size();
    for (int i = 0; i < route_.choice_count; ++i) {
      const reflect::RouteChoice& choice = route_.choices[i];
      if (choice.offset < at) continue;
      draft_.bytes.resize(std::max<std::size_t>(size(), choice.offset + choice.width_bytes));
      Field raw{.width_bytes = choice.width_bytes, .little_endian = choice.little_endian};
      reflect::store_number(raw, choice.value, draft_.bytes.data() + choice.offset);
    }
    const Type* wanted = nullptr;
    for (int i = 0; !wanted && i < place.type.interpretation_count; ++i) {
      const Interpretation& one = place.type.interpretations[i];
      const Type* type = one.overlays == index ? reading(one, from(place.base)) : nullptr;
      if (same_message(type, route_.type) || (type && route_.offset > at)) wanted = type;
    }
    draft_.bytes.resize(at);
    if (!wanted) return false;
    draft_.path.push_back(wanted);
    if (same_message(wanted, route_.type) && at == route_.offset) reached_ = true;
    const auto first = index32(draft_.parts.size());
    if (!structure(*wanted, place.scope, left(place), false)) return false;
    if (!takes_all(first)) stale(left(place));
    draft_.body = {
        wanted, &place.type, index, index32(place.base), first - 1, index32(draft_.parts.size())};
    const bool before = true;  // None that is tried before it may fit as well.
    return !may_fit_another(place.type, index, from(place.base), size() - at, wanted, before);
  }

  bool stays_opaque(std::uint16_t index, std::size_t at, const Place& place) const {
    return !may_fit_another(place.type, index, from(place.base), size() - at, nullptr, false);
  }

  const reflect::Route& route_;
  std::size_t max_bytes_;
  Random& random_;
  Draft draft_;
  bool reached_ = false;
};

}  // namespace

bool write_frame(const reflect::Route& route, const Type& carrier, bool radio,
                 std::size_t max_bytes, Random& random, Draft& out) {
  FrameWriter writer(route, radio, max_bytes, random);
  if (!writer.write(carrier)) return false;
  out = std::move(writer.draft());
  return true;
}

std::uint32_t Draft::limit(std::uint32_t scope) const {
  const Scope& s = scopes[scope];
  std::uint32_t end = s.end;
  if (end == kNone && s.parent == kNone) end = static_cast<std::uint32_t>(bytes.size());
  if (end == kNone) end = limit(s.parent);
  return end - s.base > s.type->max_size ? s.base + s.type->max_size : end;
}

std::uint32_t Draft::first_cut(std::uint32_t limit, std::uint32_t from, std::uint32_t to,
                               const std::vector<std::uint32_t>& passed, bool hard) const {
  for (std::uint32_t i = from; i < to; ++i) {
    const Part& part = parts[i];
    if ((hard && !part.hard) || part.at + part.size <= limit) continue;
    if (std::find(passed.begin(), passed.end(), i) != passed.end()) continue;
    // The rest of an open array must still be whole elements.
    if (!part.open || (limit - part.at) % part.element_bytes != 0) return i;
  }
  return kNone;
}

}  // namespace rubric::generate
