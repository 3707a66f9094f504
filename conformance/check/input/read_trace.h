// Reads .rtr logs as observations.
#pragma once

#include <string>
#include <string_view>

#include "conformance/check/observation.h"

namespace rubric::check {

/// Returns whether a text begins, after comments, with a %rtr header.
bool looks_like_trace(std::string_view bytes);

/// Appends the log's nodes and lines to `run`, whose last file it is. Lines without an exact time
/// take place at the begin of their window. Frames need exact bytes or fields without wildcards.
/// Returns false, with `error`, if the text is no trace; `run` may then have a part of it.
bool read_trace(const std::string& name, std::string_view text, Run& run, std::string& error);

}  // namespace rubric::check
