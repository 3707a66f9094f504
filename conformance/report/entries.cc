#include "conformance/report/entries.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <stdexcept>

namespace rubric::report {
namespace {

struct Mistake {
  std::uint32_t line;
  std::string text;
};

std::uint32_t line_of(const YAML::Mark& mark) { return static_cast<std::uint32_t>(mark.line + 1); }

std::string scalar(const YAML::Node& node, const std::string& key) {
  if (!node.IsScalar() || node.Scalar().empty()) {
    throw Mistake{line_of(node.Mark()), key + ": expected a text"};
  }
  return node.Scalar();
}

/// Returns "a, b and c".
std::string listed(const std::vector<std::string_view>& words) {
  std::string out;
  for (std::size_t i = 0; i < words.size(); ++i) {
    out += i == 0 ? "" : i + 1 == words.size() ? " and " : ", ";
    out += words[i];
  }
  return out;
}

Entry read_one(const YAML::Node& node, const EntryForm& form) {
  Entry one;
  one.line = line_of(node.Mark());
  if (!node.IsMap()) throw Mistake{one.line, "expected " + listed(form.required)};
  for (const auto& pair : node) {
    const std::string key = scalar(pair.first, "key");
    const std::uint32_t line = line_of(pair.first.Mark());
    if (std::find(form.keys.begin(), form.keys.end(), key) == form.keys.end()) {
      throw Mistake{line, fmt::format("unknown key '{}'; known are {}", key,
                                      fmt::join(form.keys, ", "))};
    }
    if (one.texts.contains(key)) throw Mistake{line, key + " stands here twice"};
    const std::string value = scalar(pair.second, key);
    const std::string mistake = form.mistake(key, value);
    if (!mistake.empty()) throw Mistake{line, mistake};
    one.texts.emplace(key, value);
  }
  for (const std::string_view key : form.required) {
    if (!one.texts.contains(key)) throw Mistake{one.line, fmt::format("{} is missing", key)};
  }
  return one;
}

}  // namespace

std::vector<Entry> parse_entries(std::string_view text, std::string_view name,
                                 const EntryForm& form) {
  std::vector<Entry> out;
  try {
    const YAML::Node root = YAML::Load(std::string(text));
    if (root.IsNull()) return out;
    if (!root.IsSequence()) throw Mistake{1, fmt::format("expected a list of {}", form.entries)};
    for (const YAML::Node& node : root) out.push_back(read_one(node, form));
  } catch (const Mistake& mistake) {
    throw std::runtime_error(fmt::format("{}:{}: {}", name, mistake.line, mistake.text));
  } catch (const YAML::Exception& broken) {
    throw std::runtime_error(fmt::format("{}:{}: {}", name, line_of(broken.mark), broken.msg));
  }
  return out;
}

}  // namespace rubric::report
