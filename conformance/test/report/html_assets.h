// The page's parts, embedded when the program was built.
#pragma once

#include <string_view>

namespace rubric::suite {

/// html/page.html with the placeholders @STYLE@, @SCRIPT@, @DATA@ and @NONCE@.
extern const std::string_view kPage;
extern const std::string_view kStyle;
extern const std::string_view kScript;

}  // namespace rubric::suite
