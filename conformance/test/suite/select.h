// Selects the golden traces of a run.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "conformance/test/suite/cases.h"

namespace rubric::suite {

/// Part i of n, counted from 1.
struct Shard {
  unsigned index = 1;
  unsigned count = 1;
};
/// Parses "2/8". Returns nothing if the text is no shard, or names a part that does not exist.
std::optional<Shard> parse_shard(std::string_view text);

/// Conditions on a case, all of which must hold; empty lists match everything.
struct Selection {
  std::vector<std::string> globs;          ///< Its name is like one of them.
  std::vector<std::string> requirements;   ///< It names one: "J4-SEQ", or "J4" for all of J4.
  std::optional<machine::Role> role;       ///< Role of a node under test.
  Shard shard = {};                        ///< Applied last: every n-th case.
  std::vector<std::string> excepted = {};  ///< Its name is like none of them.
};

/// Matches `*` and `?` as a shell does.
bool is_like(const std::string& glob, const std::string& name);
/// Returns whether `rule` ("J4-SEQ") is `asked` or of its family ("J4", "J").
bool is_of(std::string_view rule, std::string_view asked);

/// Returns the selected cases. Throws std::invalid_argument if a glob or a requirement fits no case
/// at all, with the nearest name, or if nothing is left.
std::vector<SuiteCase> select(const Cases& cases, const Selection& selection);

}  // namespace rubric::suite
