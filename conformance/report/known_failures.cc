#include "conformance/report/known_failures.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <stdexcept>

#include "codec/text/yaml.h"

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
const Keys kSkipKeys = {{"skip", &KnownFailure::cases, true},
                        {"reason", &KnownFailure::reason, true},
                        {"target", &KnownFailure::target, false},
                        {"profile", &KnownFailure::profile, false}};

std::vector<std::string_view> names_of(const Keys& keys, bool required) {
  std::vector<std::string_view> out;
  for (const Key& key : keys) {
    if (key.required || !required) out.push_back(key.name);
  }
  return out;
}

bool has_key(const Keys& keys, std::string_view name) {
  return std::any_of(keys.begin(), keys.end(), [&](const Key& key) { return key.name == name; });
}

// Says that an entry is one of the other command's, if its keys show it.
void refuse_other_kind(const YAML::Node& node, KnownTo command) {
  const bool check = command == KnownTo::kCheck;
  for (const auto& pair : node) {
    const std::string name = pair.first.IsScalar() ? pair.first.Scalar() : std::string();
    const bool of_test = has_key(kTestKeys, name) || has_key(kSkipKeys, name);
    if (check ? has_key(kCheckKeys, name) || !of_test : of_test || !has_key(kCheckKeys, name)) {
      continue;
    }
    throw Mistake{line_of(pair.first.Mark()),
                  fmt::format("'{}' belongs to a list for rubric {}; this one is for rubric {}",
                              name, check ? "test" : "check", check ? "check" : "test")};
  }
}

// Reads an entry; a list of cases makes one of each.
std::vector<KnownFailure> read_one(const YAML::Node& node, KnownTo command,
                                   const std::function<std::string(const std::string&)>& mistake) {
  KnownFailure one;
  one.line = line_of(node.Mark());
  one.skip = command == KnownTo::kTest && node.IsMap() && node["skip"];
  const Keys& keys = command == KnownTo::kCheck ? kCheckKeys : one.skip ? kSkipKeys : kTestKeys;
  if (!node.IsMap()) throw Mistake{one.line, "expected " + listed(names_of(keys, true))};
  refuse_other_kind(node, command);
  std::vector<std::string> listed_cases;
  for (const auto& pair : node) {
    const std::string name = scalar(pair.first, "key");
    const std::uint32_t line = line_of(pair.first.Mark());
    const auto key =
        std::find_if(keys.begin(), keys.end(), [&](const Key& each) { return each.name == name; });
    if (key == keys.end()) {
      throw Mistake{line, fmt::format("unknown key '{}'; known are {}", name,
                                      fmt::join(names_of(keys, false), ", "))};
    }
    const bool empty =
        pair.second.IsNull() || (pair.second.IsScalar() && pair.second.Scalar().empty());
    if (name == "reason" && empty) throw Mistake{line, "reason is empty: say why this is known"};
    std::string& text = one.*key->text;
    if (!text.empty()) throw Mistake{line, name + " is given twice"};
    const bool is_list =
        key->text == &KnownFailure::cases && pair.second.IsSequence() && pair.second.size() > 0;
    if (is_list) {
      for (const YAML::Node& each : pair.second) listed_cases.push_back(scalar(each, name));
    }
    text = is_list ? listed_cases.front() : scalar(pair.second, name);
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
  std::vector<KnownFailure> out = {one};
  for (std::size_t i = 1; i < listed_cases.size(); ++i) {
    out.push_back(one);
    out.back().cases = listed_cases[i];
  }
  return out;
}

// Returns the first word, number or sign of a text, and takes it away.
std::string_view take_token(std::string_view& text) {
  const auto is_word = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-';
  };
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  std::size_t length = std::min<std::size_t>(1, text.size());
  if (length > 0 && is_word(text.front())) {
    while (length < text.size() && is_word(text[length])) ++length;
  }
  const std::string_view token = text.substr(0, length);
  text.remove_prefix(length);
  return token;
}

std::vector<std::string_view> tokens_of(std::string_view text) {
  std::vector<std::string_view> out;
  while (!out.emplace_back(take_token(text)).empty()) {
  }
  out.pop_back();
  return out;
}

}  // namespace

bool has_tokens(std::string_view text, std::string_view message) {
  const std::vector<std::string_view> all = tokens_of(text);
  const std::vector<std::string_view> wanted = tokens_of(message);
  return std::search(all.begin(), all.end(), wanted.begin(), wanted.end()) != all.end() ||
         wanted.empty();
}

KnownFailures parse_known_failures(std::string_view text, const std::string& name, KnownTo command,
                                   const std::function<std::string(const std::string&)>& mistake) {
  const bool check = command == KnownTo::kCheck;
  KnownFailures out{name, {}};
  try {
    const YAML::Node root = text::only_yaml_document(std::string(text));
    if (root.IsNull()) return out;
    if (!root.IsSequence()) {
      throw Mistake{
          1, check ? "expected a list of expectations" : "expected a list of expected failures"};
    }
    for (const YAML::Node& node : root) {
      for (KnownFailure& one : read_one(node, command, mistake)) {
        out.entries.push_back(std::move(one));
      }
    }
  } catch (const Mistake& wrong) {
    throw std::runtime_error(fmt::format("{}:{}: {}", name, wrong.line, wrong.text));
  } catch (const YAML::Exception& broken) {
    throw std::runtime_error(fmt::format("{}:{}: {}", name, line_of(broken.mark), broken.msg));
  }
  return out;
}

}  // namespace rubric::report
