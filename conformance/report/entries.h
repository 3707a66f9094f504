// Lists that people write by hand for a run, as YAML: each entry has a few texts under known keys.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace rubric::report {

/// The form of such a list.
struct EntryForm {
  std::string_view entries;                ///< Plural in messages: "expected failures".
  std::vector<std::string_view> required;  ///< Keys.
  std::vector<std::string_view> keys;      ///< All, in the order that messages name them.
  /// Returns what is wrong with a value, or an empty text.
  std::function<std::string(std::string_view key, const std::string& value)> mistake;
};

struct Entry {
  std::uint32_t line = 0;  ///< Line number in its file.
  std::map<std::string, std::string, std::less<>> texts;

  /// Returns the text of a key; empty if it is not given.
  std::string text(std::string_view key) const {
    const auto found = texts.find(key);
    return found == texts.end() ? std::string{} : found->second;
  }
};

/// Parses a list; an empty text is an empty list. Throws std::runtime_error with "name:line: what"
/// if the text is no list of that form.
std::vector<Entry> parse_entries(std::string_view text, std::string_view name,
                                 const EntryForm& form);

}  // namespace rubric::report
