// Captures of the original software, and the lists of the frames in them: .jsonl files whose rows
// are objects without others in them and whose texts have no escapes.
#pragma once

#include <algorithm>
#include <filesystem>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "codec/containers/tests/testing.h"

namespace rubric::testing {

inline std::vector<std::string> files(const std::string& folder, std::string_view suffix) {
  std::vector<std::string> found;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string path = entry.path().string();
    if (path.ends_with(suffix)) found.push_back(path);
  }
  std::sort(found.begin(), found.end());
  return found;
}

inline std::vector<std::string> rows_of(const std::string& path) {
  std::vector<std::string> rows;
  std::istringstream lines(read_file(path));
  for (std::string line; std::getline(lines, line);) rows.push_back(line);
  return rows;
}

/// Returns a member of a row: a text without its quotes, anything else as it is written.
inline std::optional<std::string> member(const std::string& row, std::string_view name) {
  const std::string key = '"' + std::string(name) + "\":";
  const std::size_t found = row.find(key);
  if (found == std::string::npos) return std::nullopt;
  const std::size_t at = row.find_first_not_of(' ', found + key.size());
  if (row[at] != '"') return row.substr(at, row.find_first_of(",}", at) - at);
  return row.substr(at + 1, row.find('"', at + 1) - at - 1);
}

inline std::optional<std::int64_t> number(const std::string& row, std::string_view name) {
  const std::optional<std::string> text = member(row, name);
  return text ? std::optional(std::stoll(*text)) : std::nullopt;
}

}  // namespace rubric::testing
