// The constants and switches of a profile: the members of conformance/machine/profile.h by name.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace rubricc {

struct ProfileField {
  std::string_view name;
  std::int64_t min;  // For a constant.
  std::int64_t max;
  bool is_switch;
};

/// Returns the fields in the order of the struct.
std::span<const ProfileField> profile_fields();

}  // namespace rubricc
