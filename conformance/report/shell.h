// Commands that a reader can give again.
#pragma once

#include <string>
#include <string_view>

namespace rubric::report {

/// The text as one word of a POSIX shell: as it is where nothing in it is special, else in quotes.
std::string shell_word(std::string_view text);

}  // namespace rubric::report
