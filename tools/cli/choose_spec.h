// Chooses a spec by what a capture holds.
#pragma once

#include "codec/reflect/schema.h"
#include "tools/cli/input.h"

namespace rubric::cli {

/// The --spec that leaves the choice to choose_spec().
inline constexpr const char* kAutoSpec = "auto";

/// Returns the protocol whose messages fit the beginning of the first file, or of stdin, best:
/// rubicon, unless fewer than half of the messages fit it wholly and another one fits better, which
/// is said on stderr. A message counts twice if it fits wholly, once if bytes are left over. Lines
/// in use, and files that are followed, have no beginning yet: rubicon.
const reflect::Protocol& choose_spec(const InputOptions& options);

/// Says on stderr if choose_spec() would return another one than rubicon: for those who read by
/// rubicon alone.
void say_if_another_spec_fits(const InputOptions& options);

}  // namespace rubric::cli
