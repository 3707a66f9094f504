// JSON from here and there: strings with their quotes.
#pragma once

#include <string>
#include <string_view>

namespace rubric::layout {

/// `text` as a JSON string, quotes included.
std::string json_string(std::string_view text);

/// The same, or null for an empty text.
inline std::string json_string_or_null(std::string_view text) {
  return text.empty() ? "null" : json_string(text);
}

}  // namespace rubric::layout
