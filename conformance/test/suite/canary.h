// Cases that no honest implementation passes: they require effects that nothing in them causes; and
// cases that only a recording does not pass.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "conformance/test/targets/attachment.h"

namespace rubric::suite {

/// Returns what is wrong with an implementation, or with its attachment; empty if it answers
/// honestly. Asks for its identity, sends something that nobody can know, and for each of its roles
/// runs a golden trace that has to fail. Where time is not real it tries as well if answers depend
/// on the number that `seed`, that of the run, chooses: those of a recording do not. Does not try
/// whether its times can be believed. Call this before drawing conclusions from what it does.
std::string dishonesty(targets::Attachment& attachment, std::optional<std::uint64_t> seed);

/// Does the same, but throws runner::TargetBroken with `target`, as the user wrote it, and what is
/// wrong.
void require_honest(targets::Attachment& attachment, const std::string& target,
                    std::optional<std::uint64_t> seed);

}  // namespace rubric::suite
