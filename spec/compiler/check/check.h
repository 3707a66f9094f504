// The passes of check_model, in order. Each reports what it finds and goes on; `open` keeps
// unresolved things, so that one mistake is not reported again as its consequences.
#pragma once

#include <fmt/core.h>

#include <limits>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "spec/compiler/diagnostics.h"
#include "spec/compiler/load/read_spec.h"

namespace rubricc {

constexpr std::uint32_t kUnbounded = std::numeric_limits<std::uint32_t>::max();

struct Check {
  Model& model;
  Diagnostics& diagnostics;
  bool at_run_time;               // For tables in memory: names and rules are free, sizes vary.
  std::set<const void*> open;     // Fields and types whose size is not known.
  std::vector<Type*> order = {};  // All types, what a type contains before it.

  void error(const SourcePlace& place, std::string what, std::string_view expected = {}) {
    diagnostics.error(place, std::move(what), expected);
  }
  /// Reports what cannot be shown to be right: for tables in memory a note, as reading them checks
  /// it. Returns whether that is the case.
  bool unproved(const SourcePlace& place, std::string what, std::string_view expected) {
    if (at_run_time) {
      diagnostics.note(place, std::move(what) + "; each frame is checked");
    } else {
      error(place, std::move(what), expected);
    }
    return at_run_time;
  }
  /// Reports what tables in memory can hold, and nothing else.
  void error_elsewhere(const SourcePlace& place, std::string what, std::string_view expected = {}) {
    if (!at_run_time) error(place, std::move(what), expected);
  }
  bool is_open(const void* thing) const { return open.contains(thing); }
};

/// The result type of an expression.
enum class Shape { kOpen, kInt, kBool, kEnum };
struct ExprShape {
  Shape shape = Shape::kOpen;
  const Enum* enumeration = nullptr;
};

/// The surroundings of an expression: which fields it can read.
struct Scope {
  const Type& type;
  std::size_t fields_before;       // Fields of seq that are read before it.
  bool peeks = false;              // Instances may read the peeks.
  bool wide = false;               // Constants may be as wide as a field, not just 32 bits.
  const Field* element = nullptr;  // Of a list: what `_` is, and alone can be read.
};

/// Checks types, enums and overlaid names; duplicate names.
void check_names(Check& check);
const Enum* find_enum(const Spec& spec, const std::string& name);
const Enum* find_enum(const Spec& spec, const std::vector<std::string>& path);
/// Fills Check::order and Spec::dependency_order; reports types that contain themselves.
void check_order(Check& check);
/// Resolves `expr`: fields, offsets, enum values, range. Returns kOpen after an error.
ExprShape resolve_expr(Check& check, Expr& expr, const Scope& scope);
/// Returns the value of an expression without fields: a value of `enumeration` if there is one,
/// else a number. `what` names whose value it is.
std::optional<std::int64_t> resolve_constant(Check& check, Expr& expr, std::string_view what,
                                             const Enum* enumeration, const Scope& scope);
/// Checks that keys fit the kind of their field: `valid`, `enum`, -expect, -unit, size, repeat.
void check_field_shape(Check& check, Field& field);
/// Checks `valid`, -expect and the range of a number.
void check_values(Check& check, Field& field, const Scope& scope);
/// Resolves what the parameters of the types of a field are.
void resolve_calls(Check& check, Field& field, const Scope& scope);
void check_switch(Check& check, Switch& choice, const Field& field, const Scope& scope);
/// Computes sizes and offsets of the types in `order`.
void check_layout(Check& check);
/// Checks peeks and interpretations of a type whose seq is laid out.
void check_instances(Check& check, Type& type);
/// Checks requirements, carriers, AM types.
void check_types(Check& check);
/// Checks for names and sizes that the generated C++ could not have.
void check_cpp(Check& check);

}  // namespace rubricc
