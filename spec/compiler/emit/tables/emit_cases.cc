// Emits conformance/generated/cases.h: which golden traces name which rules.
#include <fmt/core.h>

#include "spec/compiler/emit/cpp_text.h"
#include "spec/compiler/emit/emit.h"

namespace rubricc {
namespace {

constexpr std::string_view kCasesFile = R"(<<banner>>
#pragma once

#include <array>

<<include>>

namespace rubric::cases {

/// A golden case and a rule that it names.
struct CaseUse {
  const char* name;   ///< Of the case.
  const char* file;   ///< From the project's folder.
  ReqId requirement;
  bool negative;      ///< Named by a line with `!>`: what must not happen.
};

/// By file, then as they stand there; each case once for a rule and a sign.
inline constexpr std::array<CaseUse, <<count>>> kCaseUses<<uses>>;

}  // namespace rubric::cases
)";

}  // namespace

GeneratedFiles emit_cases(const Model& model, const std::string& folder) {
  std::string uses;
  for (const CaseUse& one : model.case_uses) {
    const std::string name = cpp_string(one.case_name);
    const std::string rest = fmt::format("{}, {}, {}}},\n", cpp_string(one.file),
                                         cpp_rule(one.requirement), one.negative);
    const bool fits = name.size() + rest.size() <= 93;  // In 100 columns.
    uses += fmt::format("    {{{},{}{}", name, fits ? " " : "\n     ", rest);
  }
  return {{"conformance/generated/cases.h",
           fill(kCasesFile, {{"banner", banner("// ", folder)},
                             {"include", cpp_include("codec/runtime/rule.h")},
                             {"count", std::to_string(model.case_uses.size())},
                             {"uses", uses.empty() ? "{}" : "{{\n" + uses + "}}"}})}};
}

}  // namespace rubricc
