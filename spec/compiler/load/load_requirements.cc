// Loads the catalogue of requirements.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <map>
#include <span>

#include "codec/runtime/rule.h"
#include "spec/compiler/load/load.h"
#include "spec/compiler/load/read_spec.h"

namespace rubricc {
namespace {

constexpr std::array<std::string_view, 11> kRequirementKeys{
    "id",      "level",    "clause", "sentence", "source", "roles",
    "forbids", "deployed", "shows",  "differs",  "content"};
constexpr std::size_t kNeeded = 5;  // The first of them; the others may be absent.
constexpr std::array<std::string_view, 3> kRoles{"mote", "sink", "base_station"};

bool is_requirement_id(std::string_view id) {
  if (id.empty() || id.size() > 64 || id.front() < 'A' || id.front() > 'Z') return false;
  for (std::size_t i = 0; i < id.size(); ++i) {
    const char c = id[i];
    const bool letter = (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (!letter && (c != '-' || i + 1 == id.size() || id[i - 1] == '-')) return false;
  }
  return true;
}

/// Returns the bits of `roles`, in the order of kRoles.
std::uint8_t read_roles(const YamlInput& input, const YAML::Node& node) {
  std::uint8_t out = 0;
  const auto items = yaml_items(input, node, "roles");
  if (node.IsSequence() && node.size() == 0) {
    input.error(node, "'roles' is empty", "name the roles that must follow it");
  }
  for (const YAML::Node& item : items) {
    const auto word = yaml_text(input, item, "a role");
    if (!word) continue;
    const auto role = std::find(kRoles.begin(), kRoles.end(), *word);
    if (role == kRoles.end()) {
      input.error(item, "unknown role " + quote(*word), suggestion(*word, kRoles));
      continue;
    }
    const auto bit = static_cast<std::uint8_t>(1U << (role - kRoles.begin()));
    if ((out & bit) != 0) input.error(item, fmt::format("role {} twice", quote(*word)));
    out = static_cast<std::uint8_t>(out | bit);
  }
  return out;
}

/// Returns the texts of a list; none if the key is absent.
std::vector<std::string> read_texts(const YamlInput& input, const YamlMap& map,
                                    std::string_view key) {
  std::vector<std::string> out;
  const YamlEntry* entry = map.find(key);
  if (entry == nullptr) return out;
  for (const YAML::Node& item : yaml_items(input, entry->value, key)) {
    if (const auto text = yaml_text(input, item, key)) out.push_back(one_line(*text));
  }
  return out;
}

Requirement read_requirement(const YamlInput& input, const YAML::Node& node) {
  const YamlMap map(input, node, "a requirement", kRequirementKeys);
  Requirement out;
  out.place = input.place(node);
  if (!node.IsMap()) return out;
  for (const std::string_view key : std::span(kRequirementKeys).first(kNeeded)) {
    if (map.has(key)) continue;
    input.error(node, fmt::format("a requirement without {}", key),
                "id, level, clause, sentence and source were expected");
  }
  for (const std::string_view key : {"id", "level", "clause", "sentence", "source", "deployed"}) {
    const YamlEntry* entry = map.find(key);
    if (entry == nullptr || !one_line(map.text(key).value_or("-")).empty()) continue;
    input.error(entry->value, fmt::format("{} is empty", quote(key)));
  }
  if (const YamlEntry* id = map.find("id")) out.place = input.place(id->value);
  out.id = map.text("id").value_or("");
  out.level = map.text("level").value_or("MUST");
  out.clause = one_line(map.text("clause").value_or(""));
  out.sentence = one_line(map.text("sentence").value_or(""));
  out.source = one_line(map.text("source").value_or(""));
  if (const YamlEntry* roles = map.find("roles")) out.roles = read_roles(input, roles->value);
  out.forbids = map.boolean("forbids").value_or(false);
  out.deployed = one_line(map.text("deployed").value_or(""));
  out.shows = read_texts(input, map, "shows");
  out.differs = read_texts(input, map, "differs");
  out.content = map.boolean("content").value_or(false);
  if (out.level != "MUST" && out.level != "SHOULD" && out.level != "MAY") {
    input.error(map.find("level")->value, "level is " + quote(out.level),
                "MUST, SHOULD or MAY was expected");
  }
  if (!out.id.empty() && !is_requirement_id(out.id)) {
    input.diagnostics.error(out.place, "requirement id " + quote(out.id),
                            "upper-case words with '-' between them were expected");
    out.id.clear();
  }
  return out;
}

}  // namespace

void load_requirements(const std::string& file, Model& model, Diagnostics& diagnostics) {
  const auto text = text_of_file(file, diagnostics);
  if (text) load_requirements_text(file, *text, model, diagnostics);
}

void load_requirements_text(const std::string& file, const std::string& text, Model& model,
                            Diagnostics& diagnostics) {
  diagnostics.add_source(file, text);
  const auto root = parse_yaml(file, text, diagnostics);
  if (!root) return;
  int budget = kNodeBudget;
  const YamlInput input{file, diagnostics, budget};
  // Id and line of each number; 0 is what means none.
  std::map<std::uint16_t, std::pair<std::string, int>> numbers{{0, {"no rule", 0}}};
  for (const YAML::Node& item : yaml_items(input, *root, "requirements")) {
    Requirement found = read_requirement(input, item);
    if (found.id.empty()) continue;
    const auto number = static_cast<std::uint16_t>(rubric::rule_number(found.id.c_str()));
    const auto [entry, fresh] = numbers.try_emplace(number, found.id, found.place.line);
    const auto& [id, line] = entry->second;
    if (fresh) {
      model.requirements.push_back(std::move(found));
    } else if (id == found.id) {
      diagnostics.error(found.place, fmt::format("requirement {} twice", quote(id)),
                        fmt::format("it is already in line {}", line));
    } else {
      diagnostics.error(found.place,
                        fmt::format("requirement {} has the number of {}, {}", quote(found.id),
                                    quote(id), number),
                        "a number is a hash of the id: choose another id");
    }
  }
}

}  // namespace rubricc
