// Prints the expectations of rubric generate; tools/commands/generate_format.md describes them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "codec/generate/framer.h"

namespace rubric::tools {

/// Returns the JSON line of a frame, schema rubric.generate/1, without its end. `offset`: where it
/// begins in its file, or null.
std::string expectation(std::uint64_t number, const std::string& offset,
                        const generate::Framed& framed, bool with_fields);

/// Returns one line for people about the packet.
std::string comment(const generate::Framed& framed);

/// Joins the words with `between`.
std::string joined(const std::vector<std::string>& words, std::string_view between);

}  // namespace rubric::tools
