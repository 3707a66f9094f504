// Cases that no honest implementation passes: they require effects that nothing in them causes.
#pragma once

#include <string>

#include "conformance/test/targets/attachment.h"

namespace rubric::suite {

/// Returns what is wrong with an implementation, or with its attachment; empty if it answers
/// honestly. Asks for its identity, sends something that nobody can know, and for each of its roles
/// runs a golden trace that has to fail. Does not try whether its times can be believed. Call this
/// before drawing conclusions from what an implementation does.
std::string dishonesty(targets::Attachment& attachment);

/// Does the same, but throws runner::TargetBroken with `target`, as the user wrote it, and what is
/// wrong.
void require_honest(targets::Attachment& attachment, const std::string& target);

}  // namespace rubric::suite
