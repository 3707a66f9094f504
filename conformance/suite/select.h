// Which golden traces a run works.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "conformance/suite/cases.h"

namespace rubric::suite {

/// Part i of n, counted from 1.
struct Shard {
  unsigned index = 1;
  unsigned count = 1;
};
/// "2/8". Nothing where the text is none, or names a part that there is not.
std::optional<Shard> parse_shard(std::string_view text);

/// What all has to hold of a case; empty lists ask for nothing.
struct Selection {
  std::vector<std::string> globs;         ///< Its name is like one of them.
  std::vector<std::string> requirements;  ///< It names one: "J4-SEQ", or "J4" for all of J4.
  std::optional<machine::Role> role;      ///< Of a node under test.
  Shard shard;                            ///< Of what is left: every n-th case.
};

/// `*` and `?` as in a shell.
bool is_like(const std::string& glob, const std::string& name);
/// Whether `rule` ("J4-SEQ") is `asked` or of its family ("J4", "J").
bool is_of(std::string_view rule, std::string_view asked);

/// Throws std::invalid_argument where a glob or a requirement fits no case at all, with the nearest
/// name, or where nothing is left.
std::vector<SuiteCase> select(const Cases& cases, const Selection& selection);

}  // namespace rubric::suite
