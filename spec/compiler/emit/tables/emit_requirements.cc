// Emits requirements_table.h: names and texts of the rules; and blame.h: what breaks of them show.
#include "spec/compiler/emit/cpp_text.h"
#include "spec/compiler/emit/emit.h"

namespace rubricc {
namespace {

constexpr std::string_view kTable = R"(<<banner>>
#pragma once

<<include>>

namespace rubric {

/// In the order of <<file>>; the first entry stands for none.
constexpr reflect::Requirement kRequirements[] = {
    {"", "", "", "", "", 0, false, ""},
    <<entries?>>
};

}  // namespace rubric
)";

constexpr std::string_view kBlame = R"(<<banner>>
#pragma once

namespace rubric::blame {

/// A rule, and words that are all seen where it is broken.
struct Sign {
  const char* rule;
  const char* words;
};
/// What a break shows.
constexpr Sign kShows[] = {
    <<shows?>>
};
/// What differs in a message that came.
constexpr Sign kDiffers[] = {
    <<differs?>>
};
/// Rules about what a message holds, where it goes, or that it is accepted, which no missing
/// message breaks.
constexpr const char* kOfContent[] = {
    <<content?>>
};

}  // namespace rubric::blame
)";

std::string roles_text(const Requirement& one) {
  std::string out;
  for (const auto& [bit, name] : {std::pair<int, std::string_view>{1, "kRoleMote"},
                                  {2, "kRoleSink"},
                                  {4, "kRoleBaseStation"}}) {
    if ((one.roles & bit) == 0) continue;
    if (!out.empty()) out += " | ";
    out += "reflect::";
    out += name;
  }
  return out.empty() ? "0" : out;
}

/// Returns a string literal in lines that fit, each after one blank.
std::string literal(const std::string& text) {
  const auto pieces = cpp_string_pieces(text, 88);
  std::string out = pieces[0];
  for (std::size_t i = 1; i < pieces.size(); ++i) out += "\n " + pieces[i];
  return out;
}

std::string table_entry(const Requirement& one) {
  return "{" + literal(one.id) + ", " + literal(one.level) + ", " + literal(one.clause) + ",\n " +
         literal(one.sentence) + ",\n " + literal(one.source) + ",\n " + roles_text(one) + ", " +
         (one.forbids ? "true" : "false") + (one.deployed.empty() ? ", " : ",\n ") +
         literal(one.deployed) + "},\n";
}

}  // namespace

GeneratedFiles emit_requirements(const Model& model, const std::string& file) {
  std::string entries;
  std::string shows;
  std::string differs;
  std::string content;
  const auto sign = [](const Requirement& one, const std::string& words) {
    return "{" + cpp_string(one.id) + ", " + cpp_string(words) + "},\n";
  };
  for (const Requirement& one : model.requirements) {
    entries += table_entry(one);
    for (const std::string& words : one.shows) shows += sign(one, words);
    for (const std::string& words : one.differs) differs += sign(one, words);
    if (one.content) content += cpp_string(one.id) + ",\n";
  }
  return {{"codec/generated/requirements_table.h",
           fill(kTable, {{"banner", banner("// ", file)},
                         {"file", file},
                         {"include", cpp_include("codec/reflect/schema.h")},
                         {"entries", entries}})},
          {"conformance/generated/blame.h",
           fill(kBlame, {{"banner", banner("// ", "spec/requirements.yaml")},
                         {"shows", shows},
                         {"differs", differs},
                         {"content", content}})}};
}

}  // namespace rubricc
