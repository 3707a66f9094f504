// Commands that a reader can copy.
#pragma once

#include <string>
#include <string_view>

namespace rubric::text {

/// Returns the text as one word of a POSIX shell: unchanged if nothing in it is special, else in
/// quotes.
std::string shell_word(std::string_view text);

}  // namespace rubric::text
