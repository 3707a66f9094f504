// Emits requirements.h and its table: ids and texts of the rules.
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
    {"", "", "", "", "", 0, false, ""},
    <<entries?>>
};

}  // namespace rubric
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
