// Sequence charts in text.
#pragma once

#include <string>
#include <vector>

#include "conformance/check/report/scene.h"

namespace rubric::report {

/// Returns a chart with one column a node and one row an observation; the row `marked` has "<<<"
/// after it and a doubled arrow. Fits `width` where it can; each line begins with `indent` blanks.
std::string chart(const Scene& scene, const std::vector<std::size_t>& rows, std::size_t marked,
                  std::size_t indent, std::size_t width);

}  // namespace rubric::report
