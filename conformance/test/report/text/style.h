// Styles of pieces of text.
#pragma once

#include <string>
#include <string_view>

#include "codec/text/text.h"
#include "conformance/test/report/text/text.h"

namespace rubric::suite {

using text::field;
using text::in_capitals;
using text::kIndent;
using text::painted;
using text::styled;

std::string_view style_of(runner::CaseVerdict verdict, bool unexpected);
/// The last lines of what an implementation wrote to its standard error, each behind a bar.
std::string error_text(const std::string& text, const TextOptions& options);

}  // namespace rubric::suite
