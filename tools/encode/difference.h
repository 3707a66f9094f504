// Compares two decodings of what should be the same frame.
#pragma once

#include <optional>
#include <string>

#include "codec/reflect/decode.h"

namespace rubric::encode {

struct Difference {
  std::string path;  ///< Path of the first field that differs, from the outermost structure.
  std::string in_a;  ///< Its value there, as text.
  std::string in_b;
};

/// Returns the first difference in order of the bytes, stale bytes last. Floats are the same if
/// they are the same number or both none, since text keeps no more of them.
std::optional<Difference> first_difference(const reflect::Decoded& a, const reflect::Decoded& b);

}  // namespace rubric::encode
