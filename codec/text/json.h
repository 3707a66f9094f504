// JSON as text, put together from its parts: every report for programs is written with it.
#pragma once

#include <concepts>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "codec/text/text.h"

namespace rubric::text {

/// One JSON value. Texts become strings in UTF-8, integers numbers.
class Json {
 public:
  using Members = std::vector<std::pair<std::string_view, Json>>;

  Json(std::string_view text) : text_(json_string(text)) {}
  Json(const std::string& text) : Json(std::string_view(text)) {}
  Json(const char* text) : Json(std::string_view(text)) {}
  template <std::integral T>
  Json(T value) : text_(std::to_string(value)) {
    if constexpr (std::same_as<T, bool>) text_ = value ? "true" : "false";
  }

  /// A value that is JSON already, such as "3.842100"; null for an empty text.
  static Json raw(std::string text);
  /// A string; null for an empty text.
  static Json or_null(std::string_view text) { return text.empty() ? raw("") : Json(text); }

  /// Members in their order, `between` after the comma that separates two.
  static Json object(const Members& members, std::string_view between = "");

  /// What `to_json` makes of each item, with `before` in front of it; where there is one, `end`
  /// comes in front of the bracket.
  template <class Items, class ToJson = std::identity>
  static Json array(const Items& items, ToJson to_json = {}, std::string_view before = "",
                    std::string_view end = "") {
    std::string out = "[";
    for (const auto& item : items) {
      if (out.size() > 1) out += ',';
      out.append(before) += Json(std::invoke(to_json, item)).text_;
    }
    if (out.size() > 1) out += end;
    return raw(out + "]");
  }

  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

}  // namespace rubric::text
