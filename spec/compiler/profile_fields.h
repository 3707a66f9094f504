// The constants and switches that a profile consists of: the members of
// conformance/machine/profile.h by their names.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace rubricc {

struct ProfileField {
  std::string_view name;
  std::int64_t min;  // Of a constant.
  std::int64_t max;
  bool is_switch;
};

/// In the order of the struct.
std::span<const ProfileField> profile_fields();

}  // namespace rubricc
