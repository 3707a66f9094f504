// Cases that no honest implementation passes: they ask for what nothing in them causes.
#pragma once

#include <string>

#include "conformance/attach/attachment.h"

namespace rubric::suite {

/// What is wrong with an implementation, or with what attaches it; empty: it answers honestly.
/// Asks for its identity, sends something that nobody can know, and works for each of its roles a
/// golden trace that has to fail. Whether its times can be believed is not tried.
std::string dishonesty(attach::Attachment& attachment);

}  // namespace rubric::suite
