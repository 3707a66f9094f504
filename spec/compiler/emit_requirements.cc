// requirements.h and its table: ids and texts of the rules.
#include "spec/compiler/cpp_text.h"
#include "spec/compiler/emit.h"
#include "spec/compiler/template.h"

namespace rubricc {
namespace {

constexpr std::string_view kHeader = R"(<<banner>>
#pragma once

#include <stdint.h>

namespace rubric {

/// A rule of <<file>>.
enum class ReqId : uint16_t {
  kNone = 0,
  <<ids?>>
};

namespace req {
<<constants?>>
}  // namespace req

}  // namespace rubric
)";

constexpr std::string_view kTable = R"(<<banner>>
#pragma once

<<include>>

namespace rubric {

/// Indexed by ReqId; the first entry stands for none.
constexpr reflect::Requirement kRequirements[] = {
    {"", "", "", "", ""},
    <<entries?>>
};

}  // namespace rubric
)";

std::string table_entry(const Requirement& one) {
  std::vector<std::string> words;
  for (const std::string* text : {&one.id, &one.level, &one.clause, &one.sentence, &one.source}) {
    const auto pieces = cpp_string_pieces(*text, 88);
    std::string word = pieces[0];
    for (std::size_t i = 1; i < pieces.size(); ++i) word += "\n " + pieces[i];
    words.push_back(word);
  }
  return "{" + words[0] + ", " + words[1] + ", " + words[2] + ",\n " + words[3] + ",\n " +
         words[4] + "},\n";
}

}  // namespace

GeneratedFiles emit_requirements(const Model& model, const std::string& file) {
  std::string ids, constants, entries;
  int number = 0;
  for (const Requirement& one : model.requirements) {
    const std::string name = cpp_constant(one.id);
    ids += name + " = " + std::to_string(++number) + ",\n";
    constants += "constexpr ReqId " + name + " = ReqId::" + name + ";\n";
    entries += table_entry(one);
  }
  const std::string head = banner("// ", file);
  return {{"codec/generated/requirements.h",
           fill(kHeader, {{"banner", head}, {"file", file}, {"ids", ids},
                          {"constants", constants}})},
          {"codec/generated/requirements_table.h",
           fill(kTable, {{"banner", head}, {"include", cpp_include("codec/reflect/schema.h")},
                        {"entries", entries}})}};
}

}  // namespace rubricc
