// Lists that people keep by hand beside a run, as YAML: each entry a few texts under known keys.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace rubric::report {

/// What such a list looks like.
struct EntryForm {
  std::string_view entries;                ///< As messages call them: "expected failures".
  std::vector<std::string_view> required;  ///< Keys.
  std::vector<std::string_view> keys;      ///< All, in the order that messages name them.
  /// What is wrong with a value, or an empty text.
  std::function<std::string(std::string_view key, const std::string& value)> mistake;
};

struct Entry {
  std::uint32_t line = 0;  ///< Where it stands in its file.
  std::map<std::string, std::string, std::less<>> texts;

  /// Empty where the key is not given.
  std::string text(std::string_view key) const {
    const auto found = texts.find(key);
    return found == texts.end() ? std::string{} : found->second;
  }
};

/// An empty text is an empty list. Throws std::runtime_error with "name:line: what" where the text
/// is no list of that form.
std::vector<Entry> parse_entries(std::string_view text, std::string_view name,
                                 const EntryForm& form);

}  // namespace rubric::report
