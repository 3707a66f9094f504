// Headers of a trace that is to be worked otherwise than it says.
#pragma once

#include <algorithm>
#include <cstdint>
#include <variant>
#include <vector>

#include "conformance/trace/trace.h"

namespace rubric::trace {

/// Whether one of these lines is a header of this kind: SeedHeader, ProfileHeader, ...
template <class Kind>
bool states(const std::vector<Item>& items) {
  return std::any_of(items.begin(), items.end(), [](const Item& item) {
    const auto* header = std::get_if<Header>(&item);
    return header && std::holds_alternative<Kind>(header->what);
  });
}

/// Puts `what` in place of the headers of its kind; false if there are none.
template <class Kind>
bool replace_header(std::vector<Item>& items, const Kind& what) {
  for (Item& item : items) {
    auto* header = std::get_if<Header>(&item);
    if (header && std::holds_alternative<Kind>(header->what)) header->what = what;
  }
  return states<Kind>(items);
}

/// Lets `what` hold for the case, which need not stand in the file: in place of the headers of its
/// kind that are there, else as one more of the file.
template <class Kind>
void set_header(File& file, Case& one, const Kind& what) {
  const bool in_case = replace_header(one.items, what);
  if (!replace_header(file.head, what) && !in_case) file.header({what, {}, {}});
}

/// The same for a seed, but where neither file nor case states one; false if one does.
inline bool set_seed_if_none(File& file, const Case& one, std::uint64_t seed) {
  if (states<SeedHeader>(one.items) || states<SeedHeader>(file.head)) return false;
  file.header({SeedHeader{seed}, {}, {}});
  return true;
}

}  // namespace rubric::trace
