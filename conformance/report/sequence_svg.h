// Sequence charts as pictures: one SVG that needs nothing else.
#pragma once

#include <string>
#include <string_view>

#include "conformance/report/sequence.h"

namespace rubric::report {

/// Titles of a chart.
struct SvgWords {
  std::string id;     ///< Begins all ids in the picture; charts of one page have different ones.
  std::string title;
};

/// Returns the chart, as large as needed, so that no texts overlap. Colours are the page's text
/// colour, and the custom properties --rubric-ground (the background) and --rubric-lost where it
/// sets them; alone in a file it follows light and dark. Each row is a <g class="rc-row"> whose
/// data-lines names its lines of the log, each rule a <tspan class="rc-rule">.
std::string sequence_svg(const Sequence& sequence, const SvgWords& words);

/// The most characters that a label should have.
inline constexpr std::size_t kSvgLabelMax = 52;

}  // namespace rubric::report
