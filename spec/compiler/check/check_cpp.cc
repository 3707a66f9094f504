// Checks for what generated C++ cannot hold: names that collide, arrays that are too long, tails
// that may be absent. emit_cpp prints whatever this accepts.
#include <algorithm>
#include <array>
#include <map>

#include "spec/compiler/check/check.h"
#include "spec/compiler/emit/cpp/emit_cpp_layout.h"
#include "spec/compiler/emit/cpp_text.h"

namespace rubricc {
namespace {

constexpr std::uint64_t kElementsMax = 65535;  // The count of the runtime's Array has 16 bits.
constexpr std::uint64_t kNumbersMax = 4096;    // Nested structures are laid out number by number.

// Members of views and builders, and names in their bodies: a field of that name would hide it.
constexpr std::array<std::string_view, 36> kMembers{
    "at_most",    "bits_of_float", "bytes",      "check",    "check_short", "create",
    "detail",     "equal",         "error_at",   "fail",     "finish",      "float_of_bits",
    "int16_t",    "int32_t",       "int64_t",    "int8_t",   "is_error",    "load_be16",
    "load_be32",  "load_le16",     "load_le32",  "load_u8",  "moved",       "no_error",
    "parse",      "same",          "size_bytes", "size_t",   "stale",       "store_be16",
    "store_be32", "store_le16",    "store_le32", "store_u8", "to_value",    "truncated"};
static_assert(std::is_sorted(kMembers.begin(), kMembers.end()));

// Classes of the runtime that generated headers use.
constexpr std::array<std::string_view, 30> kClasses{
    "Array",           "ArrayAt",  "As",      "Bytes",    "Error",        "F32",
    "F32Be",           "F32Le",    "Failure", "Fault",    "MessageCodec", "MutableBytes",
    "NumberArrayView", "NumberAt", "PlaceAt", "RangedAt", "ReqId",        "Result",
    "S16Be",           "S16Le",    "S32Be",   "S32Le",    "S8",           "StructArrayView",
    "U16Be",           "U16Le",    "U32Be",   "U32Le",    "U8",           "Within"};
static_assert(std::is_sorted(kClasses.begin(), kClasses.end()));

/// The generated names of one class or namespace, with the line of the spec of each.
class ScopeNames {
 public:
  ScopeNames(Check& check, std::string where) : check_(check), where_(std::move(where)) {}

  void claim(const std::string& name, const SourcePlace& place) {
    const auto [found, fresh] = lines_.try_emplace(name, place.line);
    if (fresh) return;
    check_.error(place, fmt::format("{} twice in the generated code of {}", quote(name), where_),
                 fmt::format("line {} makes it too", found->second));
  }

 private:
  Check& check_;
  std::string where_;
  std::map<std::string, int> lines_;
};

void check_classes(Check& check, const Spec& spec) {
  ScopeNames names(check, quote(spec.id));
  const auto claim = [&](const std::string& name, const SourcePlace& place) {
    names.claim(name, place);
    if (!std::binary_search(kClasses.begin(), kClasses.end(), name)) return;
    check.error(place, fmt::format("{} hides a class of the runtime", quote(name)),
                "another name was expected");
  };
  for (const auto& one : spec.enums) claim(pascal(one->id), one->place);
  for (const auto& type : spec.types) {
    claim(pascal(type->id), type->place);
    if (type->is_mask) continue;
    for (const char* suffix : {"View", "Layout", "Builder"}) {
      claim(pascal(type->id) + suffix, type->place);
    }
  }
}

class Structure {
 public:
  Structure(Check& check, const Type& type) : check_(check), type_(type) {}

  /// Checks names that are known only once the rest is right: the members that groups add.
  bool check() {
    for (const auto& field : type_.fields) {
      check_name(*field);
      check_elements(*field);
    }
    if (!type_.fields.empty() && type_.fields.back()->condition && cpp::has_tail(type_)) {
      const Field& last = *type_.fields.back();
      error(last.condition->place,
            fmt::format("field {} takes all bytes and may be absent", quote(last.id)),
            "a field with 'if' must have a size of its own");
    }
    if (ok_) check_members();
    return ok_;
  }

 private:
  void error(const SourcePlace& place, std::string what, std::string_view expected) {
    check_.error(place, std::move(what), expected);
    ok_ = false;
  }

  void check_name(const Field& field) {
    if (!std::binary_search(kMembers.begin(), kMembers.end(), field.id)) return;
    error(field.place, fmt::format("{} hides a member of the generated view", quote(field.id)),
          "another name was expected; -name can show this one");
  }

  void check_elements(const Field& field) {
    if (field.repeat == RepeatKind::kOnce) return;
    const bool number = field.kind != ValueKind::kStruct;
    const std::uint64_t unit =
        number ? static_cast<std::uint64_t>(field.width_bytes) : field.type->max_size;
    std::uint64_t room = field.max_size;
    if (room == kUnbounded && type_.max_size != kUnbounded && field.fixed_offset >= 0) {
      room = type_.max_size - static_cast<std::uint64_t>(field.fixed_offset);
    }
    std::uint64_t most = room == kUnbounded ? 0 : room / unit;
    if (field.count && field.count->range.min == field.count->range.max) {
      most = static_cast<std::uint64_t>(field.count->range.max);
    }
    if (most <= kElementsMax) return;
    error(field.place, fmt::format("{} has up to {} elements", quote(field.id), most),
          fmt::format("the generated code takes at most {}", kElementsMax));
  }

  void check_members() {
    const cpp::Layout layout = cpp::lay_out(type_);
    ScopeNames view(check_, quote(type_.id)), builder(check_, quote(type_.id));
    for (const auto& field : type_.fields) {
      const SourcePlace& place = field->place;
      const bool structure = field->kind == ValueKind::kStruct && !field->choice;
      view.claim(field->id, place);
      view.claim(pascal(field->id) + "At", place);
      if (field->condition) view.claim("has_" + field->id, place);
      builder.claim("set_" + field->id, place);
      if (structure) builder.claim(field->id, place);
      if (field->extent == ExtentKind::kOwn) continue;
      builder.claim(field->id + "_room", place);
      if (field->extent == ExtentKind::kToEnd) builder.claim("set_" + field->id + "_size", place);
    }
    for (const cpp::Group& group : layout.groups) {
      const SourcePlace& place = group.fields.front()->place;
      view.claim(group.name + "_kind", place);
      view.claim(pascal(group.name) + "Kind", place);
      for (const Type* one : group.types) view.claim(group.name + "_as_" + one->id, place);
    }
  }

  Check& check_;
  const Type& type_;
  bool ok_ = true;
};

/// Counts the numbers and bytes of a structure, those of nested structures too.
class NumberCount {
 public:
  std::uint64_t of(const Type& type) {
    std::uint64_t out = 0;
    for (const auto& field : type.fields) {
      const bool nested = field->kind == ValueKind::kStruct && !field->choice;
      out += nested ? seen_[field->type] : 1;
    }
    return seen_[&type] = std::min(out, kNumbersMax + 1);
  }

 private:
  std::map<const Type*, std::uint64_t> seen_;
};

bool holds(const Type& type, const std::set<const Type*>& refused) {
  for (const auto* list : {&type.fields, &type.instances}) {
    for (const auto& field : *list) {
      if (refused.contains(field->type)) return true;
      if (!field->choice) continue;
      for (const SwitchCase& one : field->choice->cases) {
        if (refused.contains(one.type)) return true;
      }
      const auto& otherwise = field->choice->otherwise;
      if (otherwise && refused.contains(otherwise->type)) return true;
    }
  }
  return false;
}

}  // namespace

void check_cpp(Check& check) {
  for (const auto& spec : check.model.specs) check_classes(check, *spec);
  NumberCount numbers;
  std::set<const Type*> refused;  // Nothing can be laid out that holds one of them.
  for (const Type* type : check.order) {
    if (type->is_mask) continue;
    const bool many = numbers.of(*type) > kNumbersMax;
    const bool inner = holds(*type, refused);
    if (many && !inner) {
      check.error(type->place, fmt::format("{} nests too many numbers", quote(type->id)),
                  fmt::format("at most {} are laid out", kNumbersMax));
    }
    if (many || inner || !Structure(check, *type).check()) refused.insert(type);
  }
}

}  // namespace rubricc
