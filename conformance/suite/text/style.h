// Styles of pieces of text.
#pragma once

#include <string>
#include <string_view>

#include "conformance/suite/text/text.h"

namespace rubric::suite {

inline constexpr std::string_view kIndent = "  ";

/// Returns text in a style of the terminal ("1;31"), if colours are wanted.
std::string painted(const TextOptions& options, std::string_view style, std::string_view text);
std::string_view style_of(runner::CaseVerdict verdict, bool unexpected);
std::string in_capitals(std::string_view text);
/// Returns a coloured first word, and the rest broken into lines.
std::string styled(const TextOptions& options, std::string_view style, const std::string& head,
                   const std::string& rest);
/// Returns "  Rule:     text", broken into lines; empty for an empty text.
std::string field(std::string_view name, std::string_view text, const TextOptions& options);
/// Returns the last lines of an implementation's standard error, each after a bar.
std::string error_text(const std::string& text, const TextOptions& options);

}  // namespace rubric::suite
