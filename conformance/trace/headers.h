// Changes headers of a trace, to run it otherwise than it states.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "conformance/trace/trace.h"

namespace rubric::trace {

/// Returns whether one of these lines is a header of this kind: SeedHeader, ProfileHeader, ...
template <class Kind>
bool states(const std::vector<Item>& items) {
  return std::any_of(items.begin(), items.end(), [](const Item& item) {
    const auto* header = item.as<Header>();
    return header && std::holds_alternative<Kind>(header->what);
  });
}

/// Replaces the headers of its kind by `what`; returns false if there are none.
template <class Kind>
bool replace_header(std::vector<Item>& items, const Kind& what) {
  for (Item& item : items) {
    auto* header = item.as<Header>();
    if (header && std::holds_alternative<Kind>(header->what)) header->what = what;
  }
  return states<Kind>(items);
}

/// Makes `what` apply to the case, which need not be in the file: replaces the headers of its kind,
/// else adds one to the file.
template <class Kind>
void set_header(File& file, Case& one, const Kind& what) {
  const bool in_case = replace_header(one.items, what);
  if (!replace_header(file.head, what) && !in_case) file.header({what, {}, {}});
}

/// Does the same for a seed, but only if neither file nor case states one; returns false if one
/// does.
inline bool set_seed_if_none(File& file, const Case& one, std::uint64_t seed) {
  if (states<SeedHeader>(one.items) || states<SeedHeader>(file.head)) return false;
  file.header({SeedHeader{seed}, {}, {}});
  return true;
}

/// What keeps a case from being run with a statement.
struct Contradiction {
  std::string text;    ///< "the case is for members=20, and members=8 is stated"; empty: nothing.
  std::string stated;  ///< "members=8".
};

/// Makes the nodes under test of a case state these, too. Returns what contradicts first: a node of
/// which the trace states something else; or nothing. A case that creates more channels than are
/// stated contradicts, too, as does one in which more motes join than a sink lists.
Contradiction state(File& file, Case& one, const Statement& statement);

}  // namespace rubric::trace
