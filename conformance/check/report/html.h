// A report as a page for people.
#pragma once

#include <string>
#include <string_view>

#include "conformance/check/report/text.h"

namespace rubric::report {

/// Returns a page that needs nothing else: the verdict, the files, and the findings from grave to
/// harmless, so many of a rule as `options` say with all that the text report says of them. `style`
/// is CSS. There is no script in it.
std::string html_report(const Story& story, const TextOptions& options, std::string_view style);

}  // namespace rubric::report
