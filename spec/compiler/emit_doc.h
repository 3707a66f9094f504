// The parts of the documentation page; emit_doc.cc puts them together. All return HTML.
#pragma once

#include <string>

#include "spec/compiler/model.h"

namespace rubricc {

/// Prints bytes in rows of sixteen, a cell a field.
std::string doc_layout(const Type& type);
/// Prints heading, facts, layout, fields and interpretations of a structure, or the bits of a mask.
std::string doc_type(const Type& type);
std::string doc_enum(const Enum& one);
/// Prints the numbers that lead from a carrier's frames to each message, as nested lists.
std::string doc_dispatch(const Type& carrier);

/// Returns "4", "2 to 102", "0 and more".
std::string doc_range(std::uint64_t min, std::uint64_t max);

}  // namespace rubricc
