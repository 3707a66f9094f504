// What the inputs in bad/ expect.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

namespace rubricc {

inline const std::string kBadFolder = "spec/compiler/tests/bad/";

/// Returns the reports that a file expects, in its order, as `line:column: text`. It says so in
/// comments; in traces `;` begins them:
///     # expect: line:column: text        (at the top; or another file before it)
///     #   continued
///       # expect: column: text           (indented: of the next line that is no comment; its
///         text writes a line further up as {-lines})
inline std::vector<std::string> expected_in(const std::string& file) {
  std::vector<std::string> out;
  std::vector<std::size_t> unplaced;
  std::ifstream in(file);
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    const std::size_t at = std::min(line.find_first_not_of(' '), line.size());
    const std::string text = line.substr(std::min(at + 1, line.size()));
    if (line.find_first_of("#;", at) != at) {
      for (const std::size_t one : unplaced) {
        std::string& text_of = out[one] = fmt::format("{}:{}", number, out[one]);
        if (const std::size_t up = text_of.find("{-"); up != text_of.npos) {
          const std::size_t end = text_of.find('}', up);
          const int lines = std::stoi(text_of.substr(up + 1));
          text_of.replace(up, end + 1 - up, std::to_string(number + lines));
        }
      }
      unplaced.clear();
    } else if (text.starts_with(" expect: ")) {
      if (at > 0) unplaced.push_back(out.size());
      out.push_back(text.substr(9));
    } else if (text.starts_with("  ") && !out.empty()) {
      out.back() += text.substr(text.find_first_not_of(' ') - 1);
    }
  }
  return out;
}

}  // namespace rubricc
