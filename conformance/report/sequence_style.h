// The style sheet of sequence charts. All names begin with rc-, since an inlined style is the whole
// page's.
#pragma once

#include <string_view>

namespace rubric::report {

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
