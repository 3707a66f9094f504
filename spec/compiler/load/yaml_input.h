// YAML with places: mappings whose keys are checked, scalars that convert or complain.
#pragma once

#include <yaml-cpp/yaml.h>

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "spec/compiler/diagnostics.h"

namespace rubricc {

/// One file being read. Aliases make a small file large; `budget` bounds what is read in a run, and
/// once it is used up (-1) missing parts are no longer reported.
struct YamlInput {
  std::string file;
  Diagnostics& diagnostics;
  int& budget;

  SourcePlace place(const YAML::Node& node) const;
  void error(const YAML::Node& node, std::string what, std::string_view expected = {}) const;
  /// Returns false once the budget is used up, which is reported once.
  bool spend(const YAML::Node& node) const;
};
constexpr int kNodeBudget = 50'000;

/// Parses `text`. Reports and returns nothing if it is not YAML or not text at all.
std::optional<YAML::Node> parse_yaml(const std::string& file, const std::string& text,
                                     Diagnostics& diagnostics);

struct YamlEntry {
  std::string key;
  YAML::Node key_node;
  YAML::Node value;
};

/// A mapping. Reports keys that are not scalars, come twice, or are not among `allowed`.
class YamlMap {
 public:
  /// `what` names the mapping in diagnostics: "a field". Empty `allowed` takes any key.
  YamlMap(const YamlInput& input, const YAML::Node& node, std::string_view what,
          std::span<const std::string_view> allowed);

  const std::vector<YamlEntry>& entries() const { return entries_; }
  const YamlEntry* find(std::string_view key) const;
  bool has(std::string_view key) const { return find(key) != nullptr; }
  bool is_map() const { return is_map_; }
  bool refused_keys() const { return refused_keys_; }

  /// Returns the value of `key`; nothing, after an error, if it is of another kind; nothing if
  /// absent.
  std::optional<std::string> text(std::string_view key) const;
  std::optional<std::int64_t> integer(std::string_view key) const;
  std::optional<bool> boolean(std::string_view key) const;

 private:
  const YamlInput& input_;
  std::vector<YamlEntry> entries_;
  std::map<std::string, std::size_t, std::less<>> index_;
  bool is_map_ = false;
  bool refused_keys_ = false;
};

/// Returns the items of a sequence; empty after an error if `node` is none.
std::vector<YAML::Node> yaml_items(const YamlInput& input, const YAML::Node& node,
                                   std::string_view what);
std::optional<std::string> yaml_text(const YamlInput& input, const YAML::Node& node,
                                     std::string_view what);
std::optional<std::int64_t> yaml_integer(const YamlInput& input, const YAML::Node& node,
                                         std::string_view what);

/// Parses "12", "0x1f", "-3"; returns nothing for any other text or a number beyond 64 bits.
std::optional<std::int64_t> parse_integer(std::string_view text);

}  // namespace rubricc
