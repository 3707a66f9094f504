// Computes the layout that generated C++ follows: front part, lengths, groups.
#include "spec/compiler/emit/cpp/emit_cpp_layout.h"

#include <fmt/core.h>

#include <algorithm>
#include <stdexcept>

#include "spec/compiler/check/intervals.h"
#include "spec/compiler/emit/cpp/emit_cpp_text.h"

namespace rubricc::cpp {
namespace {

// Only reached if the checks accept something by mistake.
[[noreturn]] void unsupported(const Field& field, const std::string& what) {
  throw std::logic_error("emit_cpp: " + field.place.file + ":" + std::to_string(field.place.line) +
                         ": " + field.id + ": " + what);
}

bool is_number(const Field& field) {
  return field.kind != ValueKind::kBytes && field.kind != ValueKind::kStruct;
}

Shape shape_of(const Field& f) {
  const bool once = f.repeat == RepeatKind::kOnce;
  if (f.choice) {
    if (f.extent == ExtentKind::kOwn) unsupported(f, "a switch needs size or size-eos");
    if (!once) unsupported(f, "a switch cannot repeat");
    return Shape::kChoice;
  }
  if (f.kind == ValueKind::kBytes) {
    if (!once) unsupported(f, "opaque bytes cannot repeat");
    if (f.valid) unsupported(f, "contents of more than a number");
    return Shape::kBytes;
  }
  if (is_number(f)) return once ? Shape::kNumber : Shape::kNumbers;
  if (!once) {
    if (!f.type->constant_size()) unsupported(f, "elements must have a constant size");
    return Shape::kStructs;
  }
  return f.extent == ExtentKind::kOwn ? Shape::kNested : Shape::kNestedRange;
}

// Returns the length that the value does not hold itself, because the array or payload gives it.
const Field* length_of(const Type& type, const Field& f) {
  const Expr* expr = f.repeat == RepeatKind::kCount  ? f.count.get()
                     : f.extent == ExtentKind::kSize ? f.size.get()
                                                     : nullptr;
  const Field* length = plain_field(expr);
  if (!length || length->is_instance || length->condition || length->enumeration || f.condition ||
      length->kind != ValueKind::kUint || f.repeat == RepeatKind::kToEnd) {
    return nullptr;
  }
  const auto owns = [&](const auto& other) { return other.get() == length; };
  return std::any_of(type.fields.begin(), type.fields.end(), owns) ? length : nullptr;
}

bool is_constant(const Expr* expr) { return expr != nullptr && expr->op == ExprOp::kInt; }

FieldLayout lay_out_field(const Type& type, const Field& f) {
  FieldLayout out{.field = &f, .shape = shape_of(f)};
  if (out.shape == Shape::kNumbers) out.unit = static_cast<std::uint32_t>(f.width_bytes);
  if (out.shape == Shape::kStructs) out.unit = f.type->max_size;
  if (out.shape == Shape::kNumbers || out.shape == Shape::kStructs) {
    out.fixed_count = is_constant(f.count.get()) && f.extent == ExtentKind::kOwn;
    std::uint32_t room = f.max_size;
    if (is_unbounded(room) && !is_unbounded(type.max_size) && f.fixed_offset >= 0) {
      room = type.max_size - static_cast<std::uint32_t>(f.fixed_offset);
    }
    if (!is_unbounded(room)) out.capacity = room / out.unit;
    if (out.fixed_count) out.capacity = static_cast<std::uint32_t>(f.count->value);
    if (out.capacity > 65535) unsupported(f, "an array of more than 65535 elements");
  }
  out.length = length_of(type, f);
  return out;
}

bool is_front(const FieldLayout& layout) {
  const Field& f = *layout.field;
  if (f.condition || f.fixed_offset < 0) return false;
  switch (layout.shape) {
    case Shape::kNumber: return true;
    case Shape::kNested: return is_plain(*f.type);
    case Shape::kBytes: return f.extent == ExtentKind::kSize && is_constant(f.size.get());
    case Shape::kNumbers: return layout.fixed_count && !has_rule(f);
    case Shape::kStructs: return layout.fixed_count && is_plain(*f.type) && !has_rule(f);
    default: return false;
  }
}

void add_leaves(const FieldLayout& layout, std::int64_t base, std::vector<FrontLeaf>& out) {
  const Field& f = *layout.field;
  const std::int64_t at = base + f.fixed_offset;
  if (layout.shape == Shape::kNested) {
    for (const auto& inner : f.type->fields) add_leaves(lay_out_field(*f.type, *inner), at, out);
    return;
  }
  out.push_back({&f, at, at + f.max_size});
}

void add_type(std::vector<const Type*>& types, const Type* type) {
  if (std::find(types.begin(), types.end(), type) == types.end()) types.push_back(type);
}
void add_choice(std::vector<const Type*>& types, const Field& f) {
  if (f.choice) {
    for (const SwitchCase& c : f.choice->cases) add_type(types, c.type);
    if (f.choice->otherwise) add_type(types, f.choice->otherwise->type);
  } else if (f.type) {
    add_type(types, f.type);
  }
}

std::vector<Group> groups_of(const Type& type) {
  std::vector<Group> groups;
  for (const auto& f : type.fields) {
    if (!f->choice && shape_of(*f) != Shape::kNestedRange) continue;
    groups.push_back({f->name, f.get(), {f.get()}, {}, false});
    add_choice(groups.back().types, *f);
  }
  for (const auto& f : type.instances) {
    if (f->is_peek || f->overlays < 0) continue;
    const Field* overlaid = type.fields[static_cast<std::size_t>(f->overlays)].get();
    const auto same = [&](const Group& g) { return g.interpretation && g.overlaid == overlaid; };
    auto found = std::find_if(groups.begin(), groups.end(), same);
    if (found == groups.end()) {
      found = groups.insert(groups.end(), {f->name, overlaid, {}, {}, true});
    }
    found->fields.push_back(f.get());
    add_choice(found->types, *f);
  }
  return groups;
}

}  // namespace

bool is_unbounded(std::uint32_t size) { return size == UINT32_MAX; }

bool has_rule(const Field& f) { return f.valid && !breaches(f, "").empty(); }

std::vector<std::string> breaches(const Field& f, const std::string& x) {
  std::vector<std::string> out;
  for (const std::int64_t good : f.valid->one_of) out.push_back(x + " != " + literal(good));
  if (!out.empty()) return out;
  const auto [least, most] = width_range(f.width_bytes, f.kind == ValueKind::kSint);
  if (f.valid->min.value_or(least) > least) out.push_back(x + " < " + literal(*f.valid->min));
  if (f.valid->max.value_or(most) < most) out.push_back(x + " > " + literal(*f.valid->max));
  return out;
}

bool is_plain(const Type& type) {
  if (!type.constant_size() || type.is_mask) return false;
  const Layout layout = lay_out(type);
  return layout.front_count == layout.fields.size();
}

bool has_tail(const Type& type) {
  if (type.fields.empty()) return false;
  const Field& last = *type.fields.back();
  if (last.extent == ExtentKind::kToEnd) return true;
  if (last.repeat == RepeatKind::kToEnd) return last.extent == ExtentKind::kOwn;
  return last.kind == ValueKind::kStruct && !last.choice && last.type &&
         last.repeat == RepeatKind::kOnce && last.extent == ExtentKind::kOwn &&
         has_tail(*last.type);
}

std::string offset_of(const Layout& layout, std::size_t i, const SizeText& size_of) {
  if (i < layout.fields.size() && layout.fields[i].field->fixed_offset >= 0) {
    return std::to_string(layout.fields[i].field->fixed_offset);
  }
  std::size_t first = i;
  while (first > 0 && layout.fields[first - 1].field->fixed_offset < 0) --first;
  std::string out;
  if (first > 0) {
    --first;
    const std::int64_t base = layout.fields[first].field->fixed_offset;
    if (base > 0) out = std::to_string(base);
  }
  for (std::size_t k = first; k < i; ++k) {
    out += (out.empty() ? "" : " + ") + size_of(layout.fields[k]);
  }
  return out.empty() ? "0" : out;
}

std::string total_of(const Layout& layout, const SizeText& size_of) {
  if (layout.type->constant_size()) return std::to_string(layout.type->max_size);
  return offset_of(layout, layout.fields.size(), size_of);
}

std::string range_text(const Layout& layout, std::size_t i) {
  const Field& f = *layout.fields[i].field;
  if (f.fixed_offset < 0) return "After " + layout.fields[i - 1].field->id;
  const std::string from = std::to_string(f.fixed_offset);
  if (!layout.fields[i].front && layout.fields[i].shape != Shape::kNumber) {
    return "From byte " + from;
  }
  const std::uint32_t size =
      f.max_size != 0 ? f.max_size : static_cast<std::uint32_t>(f.width_bytes);
  if (size <= 1) return "Byte " + from;
  return "Bytes " + from + "-" + std::to_string(f.fixed_offset + size - 1);
}

std::string summary(const Type& type) {
  return type.name + "." + (type.doc.empty() ? "" : " " + type.doc) +
         (type.doc_ref.empty() ? "" : " (" + type.doc_ref + ")");
}

std::string field_table(const Layout& layout, int columns, const SizeText& type_of) {
  // Columns end in a blank, however long a word is.
  constexpr std::string_view kRow = "//   {:<5} {:<19} {:<{}} {}\n";
  std::string out = fmt::format(kRow, "byte", "field", "type", columns - 1, "rule");
  for (const FieldLayout& l : layout.fields) {
    const Field& f = *l.field;
    out += fmt::format(kRow, f.fixed_offset < 0 ? "-" : std::to_string(f.fixed_offset), f.id,
                       type_of(l), columns - 1, f.requirement.empty() ? "-" : f.requirement);
  }
  return out;
}

Layout lay_out(const Type& type) {
  Layout out{.type = &type};
  bool front = true;
  for (const auto& f : type.fields) {
    out.fields.push_back(lay_out_field(type, *f));
    FieldLayout& layout = out.fields.back();
    front = front && is_front(layout);
    layout.front = front;
    if (!front) continue;
    add_leaves(layout, 0, out.leaves);
    out.front_size = static_cast<std::uint32_t>(f->fixed_offset) + f->max_size;
    ++out.front_count;
  }
  // A length belongs to one array or payload; a second one is checked against it.
  for (FieldLayout& holder : out.fields) {
    if (!holder.length) continue;
    const auto is_it = [&](const FieldLayout& l) { return l.field == holder.length; };
    const auto found = std::find_if(out.fields.begin(), out.fields.end(), is_it);
    if (found->derived_from || !found->front) {
      holder.length = nullptr;
    } else {
      found->derived_from = holder.field;
    }
  }
  out.groups = groups_of(type);
  out.has_tail = has_tail(type);
  out.clamps = out.has_tail && !is_unbounded(type.max_size);
  return out;
}

}  // namespace rubricc::cpp
