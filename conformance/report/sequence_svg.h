// Sequence charts as pictures: one SVG that needs nothing else.
#pragma once

#include <string>
#include <string_view>

#include "conformance/report/sequence.h"

namespace rubric::report {

/// Titles of a chart.
struct SvgWords {
  std::string id;  ///< Begins all ids in the picture; charts of one page have different ones.
  std::string title;
  /// A part of a page that has the style sheet and tells more of a row that the reader points at:
  /// rows have no titles, but a <rect class="rc-band"> behind them; heads are on top of all.
  bool in_page = false;
};

/// As large as it has to be, so that no text meets another. Colours are the page's text colour, and
/// the custom properties --rubric-ground (what lies behind) and --rubric-lost where it sets them;
/// alone in a file it follows light and dark. Each row is a <g class="rc-row"> whose data-lines
/// names its lines of the log, with class rc-marked where it is marked; each rule a <tspan
/// class="rc-rule">.
std::string sequence_svg(const Sequence& sequence, const SvgWords& words);

/// The most characters that a label should have.
inline constexpr std::size_t kSvgLabelMax = 52;

}  // namespace rubric::report
