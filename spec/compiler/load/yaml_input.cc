// YAML with places, limits and diagnostics.
#include "spec/compiler/load/yaml_input.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "codec/text/text.h"
#include "codec/text/yaml.h"

namespace rubricc {
namespace {

/// Keys of Kaitai Struct that mean more than what is read here.
constexpr std::array<std::string_view, 6> kOfKaitai{"params",  "process",   "repeat-until",
                                                    "include", "to-string", "expr"};

constexpr int kNestingMax = 60;
constexpr std::string_view kPlain = "a spec is plain UTF-8 text";

/// Refuses text that breaks yaml-cpp, which takes 0x04 for the end of the input and recurses as
/// deep as brackets nest, or what is made of it: JSON is UTF-8.
bool is_plain_text(const std::string& file, const std::string& text, Diagnostics& diagnostics) {
  if (text.size() > kFileBytesMax) {
    diagnostics.error({file, 0, 0}, "the file is too large", "at most 1 MiB is read");
    return false;
  }
  int line = 1, column = 1, nesting = 0;
  for (std::size_t at = 0, length = 0; at < text.size(); at += length) {
    const char c = text[at];
    if (c == '[' || c == '{') ++nesting;
    if ((c == ']' || c == '}') && nesting > 0) --nesting;
    if (nesting > kNestingMax) {
      diagnostics.error({file, line, column}, "brackets nest too deep",
                        fmt::format("at most {} levels are read", kNestingMax));
      return false;
    }
    const unsigned char u = static_cast<unsigned char>(c);
    if ((u < 0x20 && c != '\n' && c != '\r' && c != '\t') || u == 0x7F) {
      diagnostics.error({file, line, column}, fmt::format("control character 0x{:02x}", u), kPlain);
      return false;
    }
    length = rubric::text::utf8_length(std::string_view(text).substr(at));
    if (length == 0) {
      diagnostics.error({file, line, column}, fmt::format("byte 0x{:02x} is not UTF-8", u), kPlain);
      return false;
    }
    column += static_cast<int>(length);
    if (c == '\n') {
      ++line;
      column = 1;
    }
  }
  return true;
}

std::string_view kind_of(const YAML::Node& node) {
  if (!node.IsDefined()) return "nothing";
  switch (node.Type()) {
    case YAML::NodeType::Null: return "nothing";
    case YAML::NodeType::Scalar: return "a value";
    case YAML::NodeType::Sequence: return "a list";
    case YAML::NodeType::Map: return "a mapping";
    default: return "nothing";
  }
}

}  // namespace

SourcePlace YamlInput::place(const YAML::Node& node) const {
  const YAML::Mark mark = node.IsDefined() ? node.Mark() : YAML::Mark::null_mark();
  return {file, mark.line + 1, mark.column + 1};
}

void YamlInput::error(const YAML::Node& node, std::string what, std::string_view expected) const {
  if (budget >= 0) diagnostics.error(place(node), std::move(what), expected);
}

bool YamlInput::spend(const YAML::Node& node) const {
  if (budget > 0) return --budget, true;
  if (budget == 0) {
    error(node, "too much to read once aliases are expanded",
          fmt::format("at most {} values are read", kNodeBudget));
  }
  budget = -1;
  return false;
}

std::optional<YAML::Node> parse_yaml(const std::string& file, const std::string& text,
                                     Diagnostics& diagnostics) {
  if (!is_plain_text(file, text, diagnostics)) return std::nullopt;
  try {
    return rubric::text::only_yaml_document(text);
  } catch (const rubric::text::BehindDocument& e) {
    diagnostics.error({file, e.mark.line + 1, e.mark.column + 1}, e.msg);
  } catch (const YAML::Exception& e) {
    diagnostics.error({file, e.mark.line + 1, e.mark.column + 1}, "not YAML: " + e.msg);
  }
  return std::nullopt;
}

YamlMap::YamlMap(const YamlInput& input, const YAML::Node& node, std::string_view what,
                 std::span<const std::string_view> allowed)
    : input_(input) {
  if (!input.spend(node)) return;
  if (!node.IsMap()) {
    input.error(node, fmt::format("{} is {}", what, kind_of(node)), "a mapping was expected");
    return;
  }
  is_map_ = true;
  for (const auto& pair : node) {
    if (!input.spend(pair.first)) return;
    if (!pair.first.IsScalar()) {
      input.error(pair.first, fmt::format("a key of {} is {}", what, kind_of(pair.first)),
                  "a plain word was expected");
      continue;
    }
    const std::string& key = pair.first.Scalar();
    if (const YamlEntry* first = find(key)) {
      input.error(pair.first, fmt::format("{} twice in {}", quote(key), what),
                  fmt::format("it is already in line {}", input.place(first->key_node).line));
      continue;
    }
    const bool of_another_tool = key.starts_with("-orig-") || key.starts_with("-webide-");
    if (!allowed.empty() && !of_another_tool &&
        std::find(allowed.begin(), allowed.end(), key) == allowed.end()) {
      const bool of_kaitai = std::find(kOfKaitai.begin(), kOfKaitai.end(), key) != kOfKaitai.end();
      input.error(pair.first, fmt::format("unknown key {} of {}", quote(key), what),
                  of_kaitai ? "it is Kaitai Struct's, and is not read" : suggestion(key, allowed));
      refused_keys_ = true;
      continue;
    }
    index_.emplace(key, entries_.size());
    entries_.push_back({key, pair.first, pair.second});
  }
}

const YamlEntry* YamlMap::find(std::string_view key) const {
  const auto found = index_.find(key);
  return found == index_.end() ? nullptr : &entries_[found->second];
}

std::optional<std::string> YamlMap::text(std::string_view key) const {
  const YamlEntry* entry = find(key);
  if (entry == nullptr) return std::nullopt;
  return yaml_text(input_, entry->value, key);
}

std::optional<std::int64_t> YamlMap::integer(std::string_view key) const {
  const YamlEntry* entry = find(key);
  if (entry == nullptr) return std::nullopt;
  return yaml_integer(input_, entry->value, key);
}

std::optional<bool> YamlMap::boolean(std::string_view key) const {
  const YamlEntry* entry = find(key);
  if (entry == nullptr) return std::nullopt;
  const auto word = yaml_text(input_, entry->value, key);
  if (word == "true") return true;
  if (word == "false") return false;
  if (word) {
    input_.error(entry->value, fmt::format("{} is {}", quote(key), quote(*word)),
                 "true or false was expected");
  }
  return std::nullopt;
}

std::vector<YAML::Node> yaml_items(const YamlInput& input, const YAML::Node& node,
                                   std::string_view what) {
  std::vector<YAML::Node> out;
  if (!node.IsSequence()) {
    input.error(node, fmt::format("{} is {}", quote(what), kind_of(node)), "a list was expected");
    return out;
  }
  for (const YAML::Node& item : node) {
    if (!input.spend(item)) break;
    out.push_back(item);
  }
  return out;
}

std::optional<std::string> yaml_text(const YamlInput& input, const YAML::Node& node,
                                     std::string_view what) {
  if (node.IsScalar()) return node.Scalar();
  const bool is_key = what.find(' ') == what.npos;
  input.error(
      node, fmt::format("{} is {}", is_key ? quote(what) : what, kind_of(node)),
      node.IsNull() ? "a value was expected; quote the word 'null'" : "a value was expected");
  return std::nullopt;
}

std::optional<std::int64_t> yaml_integer(const YamlInput& input, const YAML::Node& node,
                                         std::string_view what) {
  const auto word = yaml_text(input, node, what);
  if (!word) return std::nullopt;
  const auto number = parse_integer(*word);
  if (!number) {
    input.error(node, fmt::format("{} is {}", quote(what), quote(*word)),
                "a decimal or 0x number was expected");
  }
  return number;
}

std::optional<std::int64_t> parse_integer(std::string_view text) {
  const bool negative = text.starts_with('-');
  if (negative) text.remove_prefix(1);
  const bool hex = text.starts_with("0x") || text.starts_with("0X");
  const bool binary = text.starts_with("0b") || text.starts_with("0B");
  if (hex || binary) text.remove_prefix(2);
  std::int64_t value = 0;
  if (text.empty() || text.front() == '-') return std::nullopt;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value,
                                            hex      ? 16
                                            : binary ? 2
                                                     : 10);
  if (fault != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return negative ? -value : value;
}

}  // namespace rubricc
