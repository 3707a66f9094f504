// The page's parts, as they were when the program was built.
#pragma once

#include <string_view>

namespace rubric::suite {

/// html/page.html with @STYLE@, @SCRIPT@, @DATA@ and @NONCE@ in it.
extern const std::string_view kPage;
extern const std::string_view kStyle;
extern const std::string_view kScript;

}  // namespace rubric::suite
