// The parts of a generated header; emit_cpp.cc puts them together.
#pragma once

#include <string>

#include "spec/compiler/emit/cpp/emit_cpp_layout.h"

namespace rubricc::cpp {

/// Emits `struct T`, its comparison, and the unchecked parts of write.
std::string emit_value(const Layout& layout, const Spec& spec);
/// Emits `class TView`.
std::string emit_view(const Layout& layout, const Spec& spec);
/// Emits the body of TView::check and, if needed, TView::check_short.
std::string emit_check(const Layout& layout, const Spec& spec);
/// Emits the kinds of a payload or of interpretations, and the views of each.
std::string emit_group(const Layout& layout, const Group& group, const Spec& spec);
/// Emits `class TBuilder`.
std::string emit_builder(const Layout& layout, const Spec& spec);
/// Emits `write(const T&, MutableBytes)`.
std::string emit_write(const Layout& layout, const Spec& spec);

/// Emits enums.h, and the header of a mask.
std::string emit_enums(const Spec& spec);
std::string emit_mask(const Type& type);
/// Emits all.h.
std::string emit_all(const Spec& spec);

/// Prints the sizes of a builder's fields.
SizeText builder_sizes();

/// Returns `range` cut to the most that the type takes, if `most` bytes of it may be more.
std::string limited(const std::string& range, const Type& type, const Spec& spec,
                    std::uint32_t most);
/// Returns the most bytes that the field can have.
std::uint32_t most_of(const Layout& layout, const Field& field);

/// Returns a line of documentation with the byte range and the requirement.
std::string field_doc(const Layout& layout, std::size_t i);
/// Returns whether a value of the type can have lengths that do not fit.
bool has_lengths(const Type& type);

}  // namespace rubricc::cpp
