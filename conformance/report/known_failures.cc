#include "conformance/report/known_failures.h"

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

/// "a, b and c"
std::string listed(const std::vector<std::string_view>& words) {
  std::string out;
  for (std::size_t i = 0; i < words.size(); ++i) {
    out += i == 0 ? "" : i + 1 == words.size() ? " and " : ", ";
    out += words[i];
  }
  return out;
}

struct Key {
  std::string_view name;
  std::string KnownFailure::*text;
  bool required;
};
using Keys = std::vector<Key>;

const Keys kCheckKeys = {{"requirement", &KnownFailure::requirement, true},
                         {"node", &KnownFailure::node, false},
                         {"file", &KnownFailure::file, false},
                         {"profile", &KnownFailure::profile, false},
                         {"message", &KnownFailure::message, true},
                         {"reason", &KnownFailure::reason, true}};
const Keys kTestKeys = {
    {"case", &KnownFailure::cases, true},      {"requirement", &KnownFailure::requirement, true},
    {"message", &KnownFailure::message, true}, {"reason", &KnownFailure::reason, true},
    {"target", &KnownFailure::target, false},  {"profile", &KnownFailure::profile, false}};

std::vector<std::string_view> names_of(const Keys& keys, bool required) {
  std::vector<std::string_view> out;
  for (const Key& key : keys) {
    if (key.required || !required) out.push_back(key.name);
  }
  return out;
}

KnownFailure read_one(const YAML::Node& node, const Keys& keys,
                      const std::function<std::string(const std::string&)>& mistake) {
  KnownFailure one;
  one.line = line_of(node.Mark());
  if (!node.IsMap()) throw Mistake{one.line, "expected " + listed(names_of(keys, true))};
  for (const auto& pair : node) {
    const std::string name = scalar(pair.first, "key");
    const std::uint32_t line = line_of(pair.first.Mark());
    const auto key =
        std::find_if(keys.begin(), keys.end(), [&](const Key& each) { return each.name == name; });
    if (key == keys.end()) {
      throw Mistake{line, fmt::format("unknown key '{}'; known are {}", name,
                                      fmt::join(names_of(keys, false), ", "))};
    }
    std::string& text = one.*key->text;
    if (!text.empty()) throw Mistake{line, name + " is given twice"};
    text = scalar(pair.second, name);
    if (name == "profile" && text != "paper" && text != "deployed") {
      throw Mistake{line, fmt::format("profile is paper or deployed, not '{}'", text)};
    }
    const std::string wrong = name == "requirement" ? mistake(text) : std::string();
    if (!wrong.empty()) throw Mistake{line, wrong};
  }
  for (const Key& key : keys) {
    if (key.required && (one.*key.text).empty()) {
      throw Mistake{one.line, fmt::format("{} is missing", key.name)};
    }
  }
  return one;
}

}  // namespace

KnownFailures parse_known_failures(std::string_view text, const std::string& name, KnownTo command,
                                   const std::function<std::string(const std::string&)>& mistake) {
  const bool check = command == KnownTo::kCheck;
  KnownFailures out{name, {}};
  try {
    const YAML::Node root = YAML::Load(std::string(text));
    if (root.IsNull()) return out;
    if (!root.IsSequence()) {
      throw Mistake{
          1, check ? "expected a list of expectations" : "expected a list of expected failures"};
    }
    for (const YAML::Node& node : root) {
      out.entries.push_back(read_one(node, check ? kCheckKeys : kTestKeys, mistake));
    }
  } catch (const Mistake& wrong) {
    throw std::runtime_error(fmt::format("{}:{}: {}", name, wrong.line, wrong.text));
  } catch (const YAML::Exception& broken) {
    throw std::runtime_error(fmt::format("{}:{}: {}", name, line_of(broken.mark), broken.msg));
  }
  return out;
}

}  // namespace rubric::report
