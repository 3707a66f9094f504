// Loads the catalogue of requirements, and finds which golden traces name which rules. Of a trace
// it reads only names, tags and `!>`: the trace's own parser judges the rest.

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <set>
#include <span>
#include <sstream>

#include "codec/runtime/rule.h"
#include "spec/compiler/load/load.h"
#include "spec/compiler/load/read_spec.h"

namespace rubricc {
namespace {

constexpr std::array<std::string_view, 11> kRequirementKeys{
    "id",    "level",    "clause", "sentence", "source", "forbids",
    "roles", "deployed", "shows",  "differs",  "content"};
constexpr std::size_t kNeeded = 5;      // The first of them; the others may be absent.
constexpr std::size_t kOfAnyOther = 6;  // The first of them; the others are for RUBICON's rules.
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

Requirement read_requirement(const YamlInput& input, const YAML::Node& node, Catalogue of) {
  const std::span<const std::string_view> keys(kRequirementKeys);
  const YamlMap map(input, node, "a requirement",
                    of == Catalogue::kRubicon ? keys : keys.first(kOfAnyOther));
  Requirement out{.place = input.place(node)};
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

struct Word {
  std::string text;
  std::size_t at = 0;
};

/// A line without its comment: the words outside of brackets, and the text in `[...]`.
struct TraceLine {
  std::vector<Word> words;
  std::vector<Word> tags;
  std::size_t open = std::string::npos;  // A `[` that nothing closes.
};

TraceLine line_of(const std::string& text) {
  TraceLine out;
  bool quoted = false;
  int depth = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool in_word = i > 0 && !std::isspace(static_cast<unsigned char>(text[i - 1]));
    if (c == '"' && (!quoted || text[i - 1] != '\\')) quoted = !quoted;
    if (quoted) continue;
    if (c == '(') ++depth;
    if (c == ')' && depth > 0) --depth;
    if (depth > 0 || std::isspace(static_cast<unsigned char>(c))) continue;
    if (c == ';') break;
    if (c == '[') {
      const std::size_t end = text.find(']', i);
      if (end == text.npos) {
        out.open = i;
        break;
      }
      out.tags.push_back({text.substr(i + 1, end - i - 1), i + 1});
      i = end;
    } else if (in_word && !out.words.empty()) {
      out.words.back().text += c;
    } else {
      out.words.push_back({std::string(1, c), i});
    }
  }
  return out;
}

std::vector<Word> ids_in(const Word& tag) {
  std::vector<Word> out;
  for (std::size_t i = 0; i < tag.text.size(); ++i) {
    const auto separates = [](char c) { return c == ' ' || c == '\t' || c == ','; };
    if (separates(tag.text[i])) continue;
    if (i == 0 || separates(tag.text[i - 1])) out.push_back({"", tag.at + i});
    out.back().text += tag.text[i];
  }
  return out;
}

class CaseReader {
 public:
  CaseReader(Model& model, Diagnostics& diagnostics) : model_(model), diagnostics_(diagnostics) {
    for (const Requirement& one : model.requirements) ids_.push_back(one.id);
  }

  void read(const std::string& file, const std::string& text) {
    diagnostics_.add_source(file, text);
    file_ = file;
    case_.clear();
    std::istringstream lines(text);
    int number = 0;
    for (std::string line; std::getline(lines, line);) read_line(line, ++number);
  }

 private:
  SourcePlace place(int line, std::size_t at) const {
    return {file_, line, static_cast<int>(at) + 1};
  }

  void read_line(const std::string& text, int number) {
    const TraceLine line = line_of(text);
    if (!line.words.empty() && line.words[0].text.starts_with('%')) return;
    if (line.open != std::string::npos) {
      diagnostics_.error(place(number, line.open), "'[' without ']'",
                         "a rule is between them, such as [J4-SEQ]");
    }
    if (!line.words.empty() && line.words[0].text == "case") begin_case(line, number);
    const bool negative = std::any_of(line.words.begin(), line.words.end(),
                                      [](const Word& word) { return word.text == "!>"; });
    for (const Word& tag : line.tags) read_tag(tag, number, negative);
  }

  void begin_case(const TraceLine& line, int number) {
    if (line.words.size() < 2) {
      diagnostics_.error(place(number, line.words[0].at), "a case without a name",
                         "one word was expected");
      case_ = "?";
      return;
    }
    case_ = line.words[1].text;
    const SourcePlace here = place(number, line.words[1].at);
    const auto [first, fresh] = places_.try_emplace(case_, here);
    if (fresh) return;
    diagnostics_.error(
        here, fmt::format("case {} twice", rubricc::quote(case_)),
        fmt::format("it is already in {}:{}", first->second.file, first->second.line));
  }

  void read_tag(const Word& tag, int number, bool negative) {
    const auto ids = ids_in(tag);
    if (ids.empty()) {
      diagnostics_.error(place(number, tag.at), "a tag without a rule",
                         "requirement ids were expected between '[' and ']'");
    }
    for (const Word& id : ids) {
      if (case_.empty()) {
        diagnostics_.error(place(number, id.at), fmt::format("{} before any case", id.text),
                           "a line 'case NAME' was expected further up");
      } else if (std::find(ids_.begin(), ids_.end(), id.text) == ids_.end()) {
        diagnostics_.error(place(number, id.at),
                           fmt::format("unknown requirement {}", rubricc::quote(id.text)),
                           suggestion(id.text, ids_));
      } else if (seen_.emplace(case_, id.text, negative).second) {
        model_.case_uses.push_back({case_, file_, id.text, negative});
      }
    }
  }

  Model& model_;
  Diagnostics& diagnostics_;
  std::vector<std::string> ids_;
  std::map<std::string, SourcePlace> places_;
  std::set<std::tuple<std::string, std::string, bool>> seen_;
  std::string file_;
  std::string case_;
};

}  // namespace

void load_requirements(const std::string& file, Model& model, Diagnostics& diagnostics,
                       Catalogue of) {
  const auto text = text_of_file(file, diagnostics);
  if (text) load_requirements_text(file, *text, model, diagnostics, of);
}

void load_requirements_text(const std::string& file, const std::string& text, Model& model,
                            Diagnostics& diagnostics, Catalogue of) {
  diagnostics.add_source(file, text);
  const auto root = parse_yaml(file, text, diagnostics);
  if (!root) return;
  int budget = kNodeBudget;
  const YamlInput input{file, diagnostics, budget};
  // Id and line of each number; 0 is what means none.
  std::map<std::uint16_t, std::pair<std::string, int>> numbers{{0, {"no rule", 0}}};
  for (const YAML::Node& item : yaml_items(input, *root, "requirements")) {
    Requirement found = read_requirement(input, item, of);
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

void load_cases(const std::vector<std::string>& files, Model& model, Diagnostics& diagnostics) {
  CaseReader reader(model, diagnostics);
  for (const std::string& file : files) {
    const auto text = text_of_file(file, diagnostics);
    if (text) reader.read(file, *text);
  }
}

void load_case_text(const std::string& file, const std::string& text, Model& model,
                    Diagnostics& diagnostics) {
  CaseReader(model, diagnostics).read(file, text);
}

std::vector<std::string> case_files(const std::string& folder) {
  std::vector<std::string> out;
  if (!std::filesystem::is_directory(folder)) return out;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file() && entry.path().extension() == ".rtr") {
      out.push_back(entry.path().generic_string());
    }
  }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace rubricc
