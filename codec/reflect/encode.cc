#include "codec/reflect/encode.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "codec/reflect/encode_measures.h"
#include "codec/reflect/encode_number.h"
#include "codec/reflect/schema.h"
#include "codec/reflect/text_field.h"

namespace rubric::reflect {
namespace {

using std::to_string;

constexpr std::int64_t kMostPadding = 1 << 16;

/// The end of a part of the output; no limit while its measure is missing.
using Limit = std::optional<std::size_t>;

std::string bytes_text(std::size_t n) { return to_string(n) + (n == 1 ? " byte" : " bytes"); }

}  // namespace

/// One encoding. Structures are written front to back, so that expressions find what they read;
/// only missing measures are filled in later.
class Encoder {
 public:
  Encoder(Bytes stale, std::vector<std::uint8_t>& out, const Switch* more)
      : stale_(stale), out_(out), more_(more), start_(out.size()) {}

  void run(const Type& type, const Value& fields, Tail tail) {
    open_parts_ = tail == Tail::kStale ? 1 : 0;
    structure(type, {}, fields, std::nullopt);
    if (tail == Tail::kStale) append_stale(stale_.size() - stale_used_);
    if (const Measure* measure = measures_.first_missing()) {
      throw EncodeError(measure->path, "is missing: expected " + expectation(*measure->field),
                        measure->field->requirement);
    }
    if (stale_used_ == stale_.size()) return;
    throw EncodeError("stale",
                      "expected " + bytes_text(stale_used_) + ", given " +
                          to_string(stale_.size()) +
                          ": the sizes in the fields leave no room for more",
                      type.requirement);
  }

 private:
  [[noreturn]] void fail(const std::string& problem, ReqId requirement,
                         std::int64_t missing_bytes = 0) const {
    throw EncodeError(path_, problem, requirement, missing_bytes);
  }

  Bytes from(std::size_t base) const { return Bytes(out_.data() + base, out_.size() - base); }

  std::int64_t value_of(const Expr& expr, const Part& in) const {
    if (!expr.floats) return evaluate(expr, from(in.base), in.params.data());
    const auto start_of = [&](int index) -> std::size_t {
      const auto i = static_cast<std::size_t>(index);
      const bool is_there = i < in.starts.size() && in.starts[i] != kNowhere;
      return is_there ? in.starts[i] - in.base : kNowhere;
    };
    return evaluate_floating(expr, from(in.base), start_of, in.params.data());
  }

  /// Returns what the parameters of a type are for one use of it.
  std::vector<std::int64_t> values_of(const Type& type, const Argument* arguments, const Field& f,
                                      const Part& in) {
    std::vector<std::int64_t> out;
    for (int i = 0; arguments && i < type.param_count; ++i) {
      require_given(arguments[i].value, in);
      out.push_back(value_of(arguments[i].value, in));
      if (out.back() >= arguments[i].min && out.back() <= arguments[i].max) continue;
      fail(std::string(type.params[i]) + " of " + type.name + " comes to " + to_string(out.back()),
           f.requirement);
    }
    return out;
  }

  /// Returns whether expressions of the type read fields at places that vary.
  static bool has_floating(const Type& type) {
    return std::any_of(type.fields, type.fields + type.field_count, [](const Field& f) {
      return f.size.floats || f.count.floats || f.condition.floats ||
             (f.choice && f.choice->key.floats);
    });
  }

  void append_stale(std::size_t n) {
    const std::uint8_t* p = stale_.data() + stale_used_;
    out_.insert(out_.end(), p, p + n);
    stale_used_ += n;
  }

  // Requires the number that an expression reads, since something depends on it.
  void require_given(const Expr& expr, const Part& in) {
    if (const Measure* measure = measures_.missing_in(expr, in)) {
      throw EncodeError(measure->path, "is missing, and what follows depends on it",
                        measure->field->requirement);
    }
  }

  /// Makes `expr`, which measures `what` at the present path, equal `actual`.
  void settle(const Expr& expr, const Part& in, std::size_t actual, const std::string& what,
              const Field& measured) {
    Measure* measure = measures_.of(expr, in);
    if (measure && measure->missing) return fill_in(*measure, expr, in, actual, what);
    const std::int64_t given = value_of(expr, in);
    const std::int64_t missing = given - static_cast<std::int64_t>(actual);
    if (missing == 0) return;
    const std::string problem = "expected " + to_string(actual) + ", given " + to_string(given) +
                                ": " + path_ + " has " + what;
    if (!measure) {
      fail("expected " + to_string(given) + ", given " + what, measured.requirement, missing);
    }
    throw EncodeError(measure->path, problem, measured.requirement, missing);
  }

  void fill_in(Measure& measure, const Expr& expr, const Part& in, std::size_t actual,
               const std::string& what) {
    const Field& field = *measure.field;
    const auto wanted = static_cast<std::int64_t>(actual);
    const auto comes_to = [&](std::int64_t value) {
      store_number(field, value, out_.data() + measure.offset);
      return value_of(expr, in);
    };
    // Sizes grow with their measure, so the least value that is large enough is the right one.
    std::int64_t value = 0;
    auto above = static_cast<std::int64_t>(field.held().max);
    while (value < above) {
      const std::int64_t middle = value + (above - value) / 2;
      comes_to(middle) < wanted ? value = middle + 1 : above = middle;
    }
    if (comes_to(value) != wanted) {
      throw EncodeError(measure.path,
                        "expected " + expectation(field) + ", but " + path_ + " has " + what,
                        field.requirement);
    }
    const std::string problem = number_problem(field, value);
    if (!problem.empty()) {
      throw EncodeError(measure.path, problem + ", as " + path_ + " has " + what,
                        field.requirement);
    }
    measure.missing = false;
  }

  // Structures.

  void structure(const Type& type, std::vector<std::int64_t> params, const Value& object,
                 Limit limit) {
    if (!object.is(Value::Kind::kObject)) {
      fail("expected an object with the fields of " + std::string(type.name) + ", given " +
               value_text(object),
           type.requirement);
    }
    Part in{out_.size(), {}, std::move(params)};
    measures_.expect(type, in, 0);
    const bool floats = has_floating(type) || wants_starts_;
    wants_starts_ = false;
    std::size_t used = 0;  // Members of the object that were taken.
    for (std::uint16_t i = 0; i < type.field_count; ++i) {
      const Field& f = type.fields[i];
      if (floats) in.starts.push_back(kNowhere);
      if (f.condition.count) {
        require_given(f.condition, in);
        if (!value_of(f.condition, in)) continue;
      }
      if (floats) {
        in.starts.back() = out_.size() - f.shared_bytes();
        measures_.expect(type, in, static_cast<std::uint16_t>(i + 1));
      }
      if (f.kind == Kind::kBytes && interpreted(type, i, object, in, limit)) {
        ++used;
        continue;
      }
      const std::size_t path_size = push_path(f.name);
      used += one_field(f, object, in, limit) + (converted_beside(f, object) ? 1 : 0);
      path_.resize(path_size);
    }
    if (used != object.keys.size()) unknown_member(type, object, in);
    starts_ = std::move(in.starts);
  }

  std::size_t push_path(std::string_view name) {
    const std::size_t size = path_.size();
    if (size) path_ += '.';
    path_ += name;
    return size;
  }

  // A value converted by the field's unit, "temp_degC" beside "temp", is for readers only.
  static bool converted_beside(const Field& f, const Value& object) {
    return f.unit && object.find(std::string(f.name) + '_' + f.unit->symbol);
  }

  /// Returns how many members of the object it took.
  std::size_t one_field(const Field& f, const Value& object, const Part& in, Limit limit) {
    const Value* value = object.find(f.name);
    if (f.repeat == Repeat::kOnce && f.kind <= Kind::kMask) return number(f, object, value);
    if (f.repeat != Repeat::kOnce) {
      if (!value) fail("is missing: expected an array", f.requirement);
      array(f, *value, in, limit);
      return 1 + (f.enumeration && object.find(std::string(f.name) + "_name"));
    }
    if (f.kind == Kind::kBytes) {
      const Value* bytes = f.text ? object.find(std::string(f.name) + "_hex") : nullptr;
      if (holds_characters(f)) {
        text(f, value, bytes, in, limit);
      } else {
        opaque(f, value, in, limit);
      }
      return (value ? 1 : 0) + (bytes ? 1 : 0);
    }
    if (!value && f.choice && f.extent == Extent::kOwn && chooses_nothing(f, in)) return 0;
    if (!value) fail("is missing: expected an object", f.requirement);
    nested(f, *value, in, limit);
    return 1;
  }

  bool chooses_nothing(const Field& f, const Part& in) {
    require_given(f.choice->key, in);
    return choose(*f.choice, value_of(f.choice->key, in)) == nullptr;
  }

  [[noreturn]] void unknown_member(const Type& type, const Value& object, const Part& in) {
    std::string known;
    for (std::size_t i = 0; i < object.keys.size(); ++i) {
      if (known_member(type, object.keys[i], in)) {
        if (object.find(object.keys[i]) == &object.items[i]) continue;
        push_path(object.keys[i]);
        fail("is given twice", type.requirement);
      }
      for (int k = 0; k < type.field_count; ++k) {
        known += std::string(k ? ", " : "") + type.fields[k].name;
      }
      push_path(object.keys[i]);
      fail("is not a field of " + std::string(type.name) + " here, which has " + known,
           type.requirement);
    }
    fail("expected each field once", type.requirement);
  }

  bool known_member(const Type& type, const std::string& key, const Part& in) {
    for (int i = 0; i < type.field_count; ++i) {
      const Field& f = type.fields[i];
      if (f.condition.count && !value_of(f.condition, in)) continue;
      if (key == f.name || (f.enumeration && key == std::string(f.name) + "_name") ||
          (f.mask && key == std::string(f.name) + "_bits") ||
          (f.text && key == std::string(f.name) + "_hex") ||
          (f.unit && key == std::string(f.name) + '_' + f.unit->symbol)) {
        return true;
      }
    }
    return false;
  }

  // Fields.

  std::size_t number(const Field& f, const Value& object, const Value* value) {
    const NumberResult result = number_of(f, object, value);
    if (!result.problem.empty()) fail(result.problem, f.requirement);
    const std::size_t at = out_.size() - f.shared_bytes();
    out_.resize(at + f.width_bytes);
    if (result.present) store_number(f, result.value, out_.data() + at);
    // Bits are given: others of the same byte would be filled in with them.
    Measure* measure = f.kind == Kind::kBits ? nullptr : measures_.find(at);
    if (measure) {
      measure->field = &f;
      measure->path = path_;
      measure->missing = !result.present;
    } else if (!result.present) {
      fail("is missing: expected " + expectation(f), f.requirement);
    }
    return result.members;
  }

  void opaque(const Field& f, const Value* value, const Part& in, Limit limit) {
    const std::size_t at = out_.size();
    if (value && (!value->is(Value::Kind::kString) || !parse_hex(value->text, out_))) {
      fail("expected hex digits, given " + value_text(*value), f.requirement);
    }
    finish_bytes(f, at, in, limit);
  }

  /// Encodes text, as `value` says, or as the bytes in hex beside it.
  void text(const Field& f, const Value* value, const Value* bytes, const Part& in, Limit limit) {
    const std::size_t at = out_.size();
    if (value && !value->is(Value::Kind::kString)) {
      fail("expected text, given " + value_text(*value), f.requirement);
    }
    if (bytes) {
      if (!bytes->is(Value::Kind::kString) || !parse_hex(bytes->text, out_)) {
        fail("expected hex digits in " + std::string(f.name) + "_hex, given " + value_text(*bytes),
             f.requirement);
      }
      const std::string shown = shown_text(f, from(at));
      if (value && value->text != shown) {
        fail("given " + value_text(*value) + ", but " + f.name + "_hex says \"" + shown +
                 "\"; delete it if the text is meant",
             f.requirement);
      }
    } else {
      const std::string problem =
          append_text(f, value ? value->text : "", room(f, in, limit), out_);
      if (!problem.empty()) fail(problem, f.requirement);
    }
    finish_bytes(f, at, in, limit);
  }

  /// Returns the bytes that a field has to fill; none where its content says how many they are.
  std::optional<std::size_t> room(const Field& f, const Part& in, Limit limit) {
    if (f.extent == Extent::kSize && !measures_.missing_in(f.size, in)) {
      const std::int64_t size = value_of(f.size, in);
      if (size >= 0 && size <= kMostPadding) return static_cast<std::size_t>(size);
    }
    if (f.extent == Extent::kToEnd && limit) return *limit - std::min(*limit, out_.size());
    return std::nullopt;
  }

  void finish_bytes(const Field& f, std::size_t at, const Part& in, Limit limit) {
    const std::size_t size = out_.size() - at;
    if (f.extent == Extent::kTerminated) {
      // What comes after a terminator would be read as the next field.
      const std::size_t end = terminator_at(*f.text, from(at));
      if (end == size ? f.text->may_lack_its_end : end + f.text->unit == size) return;
      fail("expected one byte " + to_string(f.text->terminator) + ", at the end", f.requirement);
    }
    if (f.extent == Extent::kSize) return settle(f.size, in, size, bytes_text(size), f);
    if (limit && out_.size() != *limit) {
      fail("expected " + bytes_text(*limit - std::min(at, *limit)) + ", given " + to_string(size),
           f.requirement);
    }
  }

  void array(const Field& f, const Value& value, const Part& in, Limit limit) {
    if (!value.is(Value::Kind::kArray)) {
      fail("expected an array, given " + value_text(value), f.requirement);
    }
    const std::size_t count = value.items.size();
    if (f.repeat == Repeat::kCount) {
      settle(f.count, in, count, to_string(count) + (count == 1 ? " element" : " elements"), f);
    }
    const std::size_t path_size = path_.size();
    for (std::size_t i = 0; i < count; ++i) {
      path_ += '[' + to_string(i) + ']';
      const std::size_t begin = out_.size();
      wants_starts_ = f.until.floats;
      if (f.kind == Kind::kStruct) {
        structure(*f.type, values_of(*f.type, f.arguments, f, in), value.items[i], limit);
      } else {
        number(f, Value::of_object(), &value.items[i]);
      }
      path_.resize(path_size);
      if (f.repeat == Repeat::kUntil) check_until(f, {begin, starts_, in.params}, i, count);
    }
    if (f.repeat == Repeat::kUntil && count == 0) {
      fail("expected an element or more", f.requirement);
    }
    if (f.repeat == Repeat::kToEnd && limit && out_.size() != *limit) {
      fail("its " + to_string(count) + " elements end at byte " + to_string(out_.size() - start_) +
               ", expected byte " + to_string(*limit - start_),
           f.requirement);
    }
  }

  /// Checks that the last element ends the list, and that no other does.
  void check_until(const Field& f, const Part& element, std::size_t index, std::size_t count) {
    require_given(f.until, element);
    const bool ends = value_of(f.until, element) != 0;
    if (ends == (index + 1 == count)) return;
    fail("element " + to_string(index) +
             (ends ? " ends the list, and others follow"
                   : " is the last, and does not end the list"),
         f.requirement);
  }

  void nested(const Field& f, const Value& value, const Part& in, Limit limit) {
    Chosen inner{f.type, f.arguments};
    if (f.choice) {
      require_given(f.choice->key, in);
      const std::int64_t key = value_of(f.choice->key, in);
      inner = choose_with(*f.choice, key);
      if (!inner.type && more_ && in.base == start_ && value.is(Value::Kind::kObject)) {
        inner.type = choose(*more_, key);
      }
      if (!inner.type) return opaque(f, &value, in, limit);
    }
    if (f.extent == Extent::kOwn) {
      return structure(*inner.type, values_of(*inner.type, inner.arguments, f, in), value, limit);
    }
    part(f, inner, value, in, limit);
  }

  /// Encodes a structure whose size is given elsewhere; stale bytes may follow its content.
  void part(const Field& f, Chosen chosen, const Value& value, const Part& in, Limit limit) {
    const std::size_t at = out_.size();
    Limit end = limit;
    if (f.extent == Extent::kSize) {
      const Measure* measure = measures_.of(f.size, in);
      end = std::nullopt;
      if (!measure || !measure->missing) {
        const std::int64_t size = value_of(f.size, in);
        if (size < 0) fail("its size comes to " + to_string(size), f.requirement);
        end = at + static_cast<std::size_t>(size);
      }
    }
    ++open_parts_;
    structure(*chosen.type, values_of(*chosen.type, chosen.arguments, f, in), value, end);
    --open_parts_;
    const std::size_t rest = stale_.size() - stale_used_;
    if (end && out_.size() < *end && rest >= *end - out_.size()) {
      append_stale(*end - out_.size());
    } else if (!end && open_parts_ == 0) {
      append_stale(rest);
    }
    const std::size_t size = out_.size() - at;
    std::string what = bytes_text(size);
    if (end && out_.size() < *end && !stale_.empty()) {
      what += " and " + to_string(rest) + " stale ones are left";
    }
    if (f.extent == Extent::kSize) return settle(f.size, in, size, what, f);
    if (end && out_.size() != *end) {
      fail("expected " + bytes_text(*end - std::min(at, *end)) + ", given " + what, f.requirement,
           static_cast<std::int64_t>(*end) - static_cast<std::int64_t>(out_.size()));
    }
  }

  // Encodes interpretations. Their key may be their own first byte, so they are tried until one is
  // chosen by its own bytes.

  struct Mark {
    std::size_t size, stale, path;
    Measures measures;
    int open_parts;
  };
  Mark mark() const { return {out_.size(), stale_used_, path_.size(), measures_, open_parts_}; }
  void back_to(const Mark& mark) {
    out_.resize(mark.size);
    stale_used_ = mark.stale;
    path_.resize(mark.path);
    measures_ = mark.measures;
    open_parts_ = mark.open_parts;
  }

  bool interpreted(const Type& type, std::uint16_t index, const Value& object, const Part& in,
                   Limit limit) {
    bool given = false;
    std::optional<EncodeError> error;
    int error_rank = 0;
    for (int k = 0; k < type.interpretation_count; ++k) {
      const Interpretation& candidate = type.interpretations[k];
      const Field& f = candidate.field;
      const Value* value = candidate.overlays == index ? object.find(f.name) : nullptr;
      if (!value || object.find(type.fields[index].name)) continue;
      given = true;
      require_given(f.condition, in);
      if (f.condition.count && !value_of(f.condition, in)) continue;
      const int count = f.choice ? f.choice->count + 1 : 1;
      for (int c = 0; c < count; ++c) {
        Chosen tried{f.type, f.arguments};
        if (f.choice) tried = case_of(*f.choice, c);
        if (!tried.type) continue;
        bool chosen = false;
        const Mark before = mark();
        try {
          push_path(f.name);
          attempt(f, tried, *value, in, limit, chosen);
          path_.resize(before.path);
          if (chosen) return true;
        } catch (const EncodeError& e) {
          // A missing key is taken to be that of whatever is tried.
          const int rank = 2 * chosen + has_members(*tried.type, *value);
          if (rank > error_rank) error = e;
          error_rank = std::max(error_rank, rank);
        }
        back_to(before);
      }
    }
    if (!given) return false;
    if (error) throw *error;
    push_path(type.interpretations[0].field.name);
    fail("no message of " + std::string(type.name) + " has these fields here", type.requirement);
  }

  /// Returns case `index`, that of `_` behind the others.
  static Chosen case_of(const Switch& choice, int index) {
    if (index == choice.count) return {choice.otherwise, choice.otherwise_arguments};
    return {choice.cases[index].type, choice.cases[index].arguments};
  }

  /// Returns whether every member of the object is one of the type's, if only by its beginning.
  static bool has_members(const Type& type, const Value& object) {
    return std::all_of(object.keys.begin(), object.keys.end(), [&](const std::string& key) {
      return std::any_of(type.fields, type.fields + type.field_count,
                         [&](const Field& f) { return key.starts_with(f.name); });
    });
  }

  void attempt(const Field& f, Chosen tried, const Value& value, const Part& in, Limit limit,
               bool& chosen) {
    const auto picks = [&] {
      return !f.choice || choose(*f.choice, value_of(f.choice->key, in)) == tried.type;
    };
    try {
      part(f, tried, value, in, limit);
    } catch (const EncodeError&) {
      chosen = picks();
      throw;
    }
    chosen = picks();
  }

  Bytes stale_;
  std::size_t stale_used_ = 0;
  std::vector<std::uint8_t>& out_;
  const Switch* more_;
  std::size_t start_;
  Measures measures_;
  std::string path_;
  std::vector<std::size_t> starts_;  // Of the fields of the last structure, if it has such.
  bool wants_starts_ = false;        // The next structure has to note them.
  int open_parts_ = 0;  // Parts around the present place whose end may take stale bytes.
};

void encode(const Type& type, const Value& fields, Bytes stale, Tail tail,
            std::vector<std::uint8_t>& out, const Switch* more) {
  Encoder(stale, out, more).run(type, fields, tail);
}

}  // namespace rubric::reflect
