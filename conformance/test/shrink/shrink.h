// Makes a trace as small as possible while it still shows its purpose.
#pragma once

#include <cstddef>
#include <functional>

#include "conformance/trace/trace.h"

namespace rubric::shrink {

/// Returns whether a file with this one case still shows the thing. Files passed to it pass
/// trace::check().
using StillShows = std::function<bool(const trace::File&)>;

struct Shrunk {
  trace::File file;  ///< Headers and one case.
  std::size_t lines_before = 0;
  std::size_t lines = 0;
  std::size_t tried = 0;  ///< Calls of `still_shows`.
};

/// Shrinks by delta debugging (Zeller and Hildebrandt's ddmin) over the lines of the case, then
/// over the parts of each line: fields, times, requirements, labels, and the nodes of the file. The
/// result is 1-minimal: without any one of its lines it does not show the thing, or makes no sense.
/// `one` itself has to show it, else lines_before is 0 and the file holds it unchanged.
Shrunk shrink(const trace::File& file, const trace::Case& one, const StillShows& still_shows);

}  // namespace rubric::shrink
