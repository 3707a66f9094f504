// What rubric generate says of its frames; tools/generate_format.md describes it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "codec/generate/framer.h"

namespace rubric::tools {

/// The JSON line of a frame, schema rubric.generate/1, without its end. `offset`: where it begins
/// in its file, or null.
std::string expectation(std::uint64_t number, const std::string& offset,
                        const generate::Framed& framed, bool with_fields);

/// What a person reads beside the packet, in one line.
std::string comment(const generate::Framed& framed);

/// The words with `between` between them.
std::string joined(const std::vector<std::string>& words, std::string_view between);

}  // namespace rubric::tools
