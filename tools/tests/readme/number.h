// The numbers of README.md, for the tests that count them.
#pragma once

#include <gtest/gtest.h>

#include <cctype>
#include <cstddef>
#include <fstream>
#include <string>
#include <string_view>

namespace rubric {

/// Returns the number that README.md has at the '#' of `words`: 804 for "# [vectors]". Fails the
/// test unless the words occur exactly once. Line breaks count as blanks.
inline std::size_t readme_number(std::string_view words) {
  std::ifstream file("README.md");
  std::string text;
  for (std::string word; file >> word;) text += word + " ";
  const std::string_view readme(text);
  const std::string_view before = words.substr(0, words.find('#'));
  const std::string_view after = words.substr(before.size() + 1);
  const auto digit = [&](std::size_t at) { return std::isdigit(readme[at]) != 0; };
  std::size_t found = 0;
  std::size_t times = 0;
  for (std::size_t begin = 0, end = 0; begin < readme.size(); begin = end) {
    std::size_t number = 0;
    for (end = begin; digit(end) || (end > begin && readme[end] == ',' && digit(end + 1)); ++end) {
      if (digit(end)) number = number * 10 + static_cast<std::size_t>(readme[end] - '0');
    }
    if (end == begin) {
      ++end;
    } else if (readme.substr(0, begin).ends_with(before) && readme.substr(end).starts_with(after)) {
      found = number;
      ++times;
    }
  }
  EXPECT_EQ(times, 1U) << "README.md does not say exactly once: " << words;
  return found;
}

}  // namespace rubric
