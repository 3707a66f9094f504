// Cases that no honest implementation passes: they ask for what nothing in them causes.
#pragma once

#include <string>

#include "conformance/attach/attachment.h"

namespace rubric::suite {

/// What is wrong with an implementation, or with what attaches it; empty: it answers honestly.
/// Asks for its identity, sends something that nobody can know, and works for each of its roles a
/// golden trace that has to fail. Whether its times can be believed is not tried. Whoever draws
/// conclusions from what an implementation does asks this first.
std::string dishonesty(attach::Attachment& attachment);

/// The same for those who have nothing more to do then. Throws runner::TargetBroken with `target`,
/// as the user wrote it, and what is wrong.
void require_honest(attach::Attachment& attachment, const std::string& target);

}  // namespace rubric::suite
