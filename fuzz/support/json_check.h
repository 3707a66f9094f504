// A small JSON validator for output; a parser's own code would only distract the fuzzer.
#pragma once

#include <map>
#include <string_view>

namespace rubric::fuzz {

/// Returns whether `text` is one JSON value (RFC 8259) in UTF-8 with nothing but white space around
/// it. For an object, `*members` gets each member's value as it is written, by its key as it is
/// written.
bool is_json(std::string_view text, std::map<std::string_view, std::string_view>* members);

}  // namespace rubric::fuzz
