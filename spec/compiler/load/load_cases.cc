// Finds which golden traces name which rules. Reads only names, tags and `!>`: a trace's own parser
// judges the rest.
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include "spec/compiler/load/load.h"

namespace rubricc {
namespace {

struct Word {
  std::string text;
  std::size_t at = 0;
};

/// A line without its comment: the words outside of brackets, and the text in `[...]`.
struct Line {
  std::vector<Word> words;
  std::vector<Word> tags;
  std::size_t open = std::string::npos;  // A `[` that nothing closes.
};

Line line_of(const std::string& text) {
  Line out;
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
  Place place(int line, std::size_t at) const { return {file_, line, static_cast<int>(at) + 1}; }

  void read_line(const std::string& text, int number) {
    const Line line = line_of(text);
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

  void begin_case(const Line& line, int number) {
    if (line.words.size() < 2) {
      diagnostics_.error(place(number, line.words[0].at), "a case without a name",
                         "one word was expected");
      case_ = "?";
      return;
    }
    case_ = line.words[1].text;
    const Place here = place(number, line.words[1].at);
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
  std::map<std::string, Place> places_;
  std::set<std::tuple<std::string, std::string, bool>> seen_;
  std::string file_;
  std::string case_;
};

}  // namespace

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
