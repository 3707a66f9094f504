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

// The style sheet of sequence charts. All names begin with rc-, since an inlined style is the whole
// page's.

inline constexpr std::string_view kSequenceStyle =
    "svg.rubric-chart:root{color-scheme:light dark;color:CanvasText;background:Canvas}"
    ".rubric-chart text{font:12px ui-monospace,'DejaVu Sans Mono',Menlo,Consolas,monospace;"
    "fill:currentColor;stroke:none}"
    ".rubric-chart .rc-label{paint-order:stroke;stroke:var(--rubric-ground,Canvas);"
    "stroke-width:5px;stroke-linejoin:round}"
    ".rubric-chart .rc-name{font-weight:700;text-anchor:middle}"
    ".rubric-chart .rc-about{font-size:10.5px;text-anchor:middle;opacity:.75}"
    ".rubric-chart .rc-time{font-size:11px;text-anchor:end;opacity:.75}"
    ".rubric-chart .rc-note{font-size:11px;opacity:.85}"
    ".rubric-chart .rc-middle{text-anchor:middle}"
    ".rubric-chart .rc-head{fill:none;stroke:currentColor}"
    ".rubric-chart .rc-life{stroke:currentColor;opacity:.4}"
    ".rubric-chart .rc-pause{stroke:currentColor;opacity:.4;stroke-dasharray:2 4}"
    ".rubric-chart .rc-line{stroke:currentColor;stroke-width:1.6;fill:none}"
    ".rubric-chart .rc-tip{stroke:currentColor;fill:currentColor}"
    ".rubric-chart .rc-open{stroke:currentColor;fill:var(--rubric-ground,Canvas)}"
    ".rubric-chart .rc-serial{stroke-dasharray:9 4}"
    ".rubric-chart .rc-peis{stroke-dasharray:2.5 3.5}"
    ".rubric-chart .rc-call{stroke-width:1}"
    ".rubric-chart .rc-lost{stroke:var(--rubric-lost,#d33a2c);stroke-width:2;fill:none}";

}  // namespace rubric::report
