// Every file in bad/ holds a mistake and states in its first lines the expected report:
//   # expect: line:column: text        (or another file before it)
//   #   continued
// In traces `;` begins such a line.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "spec/compiler/load/load.h"
#include "spec/compiler/wire_specs.h"

namespace rubricc {
namespace {

const std::string kFolder = "spec/compiler/tests/bad/";

std::vector<std::string> names_in(const std::string& folder, const std::string& extension) {
  std::vector<std::string> out;
  for (const auto& path : files_in(folder, extension)) out.push_back(path.stem().string());
  return out;
}

std::vector<std::string> expected_in(const std::string& file) {
  std::vector<std::string> out;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line) && line.find_first_of("#;") == 0;) {
    if (line.substr(1).starts_with(" expect: ")) {
      out.push_back(line.substr(10));
    } else if (!out.empty()) {
      out.back() += " " + line.substr(line.find_first_not_of("#; "));
    }
  }
  return out;
}

std::vector<std::string> shown(const Diagnostics& diagnostics, const std::string& file) {
  std::vector<std::string> out;
  for (const Diagnostic& one : diagnostics.sorted()) {
    std::string where = fmt::format("{}:{}: ", one.place.line, one.place.column);
    if (one.place.file != file) {
      where = one.place.file.substr(kFolder.size()) + ":" + where;
    }
    out.push_back(where + one.text);
  }
  return out;
}

// The project's rules, which hundreds of files are compiled with, are read once.
Model catalogue() {
  static const std::vector<Requirement> rules = [] {
    Model model;
    Diagnostics diagnostics;
    load_requirements("spec/requirements.yaml", model, diagnostics);
    EXPECT_EQ(diagnostics.print(), "");
    return model.requirements;
  }();
  Model model;
  model.requirements = rules;
  return model;
}

class BadSpec : public testing::TestWithParam<std::string> {};

TEST_P(BadSpec, IsRefusedWithTheDiagnosticsThatItExpects) {
  const std::string file = kFolder + GetParam() + ".ksy";
  Model model = catalogue();
  Diagnostics diagnostics;
  load_specs({file}, model, diagnostics);
  check_model(model, diagnostics);
  EXPECT_EQ(shown(diagnostics, file), expected_in(file));
  EXPECT_FALSE(diagnostics.empty());
}

INSTANTIATE_TEST_SUITE_P(Files, BadSpec, testing::ValuesIn(names_in(kFolder, ".ksy")),
                         [](const auto& one) { return one.param; });

class BadRequirements : public testing::TestWithParam<std::string> {};

TEST_P(BadRequirements, AreRefusedWithTheDiagnosticsThatTheyExpect) {
  const std::string file = kFolder + "requirements/" + GetParam() + ".yaml";
  Model model;
  Diagnostics diagnostics;
  load_requirements(file, model, diagnostics);
  EXPECT_EQ(shown(diagnostics, file), expected_in(file));
  EXPECT_FALSE(diagnostics.empty());
}

INSTANTIATE_TEST_SUITE_P(Files, BadRequirements,
                         testing::ValuesIn(names_in(kFolder + "requirements/", ".yaml")),
                         [](const auto& one) { return one.param; });

class BadProfile : public testing::TestWithParam<std::string> {};

TEST_P(BadProfile, IsRefusedWithTheDiagnosticsThatItExpects) {
  const std::string file = kFolder + "profiles/" + GetParam() + ".yaml";
  Model model = catalogue();
  Diagnostics diagnostics;
  load_profile(file, model, diagnostics);
  EXPECT_EQ(shown(diagnostics, file), expected_in(file));
  EXPECT_FALSE(diagnostics.empty());
}

INSTANTIATE_TEST_SUITE_P(Files, BadProfile,
                         testing::ValuesIn(names_in(kFolder + "profiles/", ".yaml")),
                         [](const auto& one) { return one.param; });

class BadCases : public testing::TestWithParam<std::string> {};

TEST_P(BadCases, AreRefusedWithTheDiagnosticsThatTheyExpect) {
  const std::string file = kFolder + "cases/" + GetParam() + ".rtr";
  Model model = catalogue();
  Diagnostics diagnostics;
  load_cases({file}, model, diagnostics);
  EXPECT_EQ(shown(diagnostics, file), expected_in(file));
  EXPECT_FALSE(diagnostics.empty());
}

INSTANTIATE_TEST_SUITE_P(Files, BadCases, testing::ValuesIn(names_in(kFolder + "cases/", ".rtr")),
                         [](const auto& one) { return one.param; });

// A file that lost its first lines would expect nothing and a renamed folder would test nothing.
TEST(BadSpecs, AreAllThere) {
  EXPECT_GE(files_in(kFolder, ".ksy").size(), 155U);
  EXPECT_GE(files_in(kFolder + "requirements/", ".yaml").size(), 16U);
  EXPECT_GE(files_in(kFolder + "profiles/", ".yaml").size(), 11U);
  EXPECT_GE(files_in(kFolder + "cases/", ".rtr").size(), 6U);
}

// Reports errors for a text that would be too large for a file beside the others.
std::string reported_for(const std::string& text) {
  Model model;
  Diagnostics diagnostics;
  load_spec_text("big.ksy", text, model, diagnostics);
  check_model(model, diagnostics);
  return diagnostics.print();
}

TEST(BadSpecs, FilesAreNotLargerThanOneMebibyte) {
  const std::string text = "meta: {id: big}\n";
  EXPECT_EQ(reported_for(text + std::string((1 << 20) - text.size(), '#')), "");
  EXPECT_EQ(reported_for(text + std::string((1 << 20) + 1 - text.size(), '#')),
            "big.ksy: error: the file is too large; at most 1 MiB is read\n");
}

TEST(BadSpecs, AreRegularFiles) {
  Model model;
  Diagnostics diagnostics;
  load_specs({"/dev/zero", "/"}, model, diagnostics);
  EXPECT_EQ(diagnostics.print(),
            "/: error: not a regular file\n/dev/zero: error: not a regular file\n");
}

TEST(BadSpecs, TypesNestNotTooDeep) {
  std::string text = "meta: {id: big}\ntypes:\n";
  for (int i = 0; i < 110; ++i) {
    text += fmt::format("  t{}: {{-requirement: A, seq: [{{id: a, type: {}}}]}}\n", i,
                        i + 1 < 110 ? fmt::format("t{}", i + 1) : "u1");
  }
  EXPECT_NE(reported_for(text).find("error: types nest too deep; at most 100 levels\n"),
            std::string::npos);
}

TEST(BadSpecs, OnlyTheFirst500DiagnosticsAreShown) {
  std::string text = "meta: {id: big}\ntypes:\n";
  // Each of them breaks three rules.
  for (int i = 0; i < 503; ++i) text += fmt::format("  T{}: 1\n", i);
  const std::string shown = reported_for(text);
  EXPECT_TRUE(shown.ends_with("\n1009 more errors\n")) << shown.substr(shown.size() - 200);
}

TEST(Diagnostics, ShowTheLineAndACaretBelowTheColumn) {
  Diagnostics diagnostics;
  diagnostics.add_source("a.ksy", "meta:\n\tid: \xC3\xA4\xC3\xB6x\n");
  diagnostics.error({"a.ksy", 2, 10}, "name 'x'", "another was expected");
  diagnostics.error({"a.ksy", 1, 1}, "first");
  diagnostics.error({"a.ksy", 1, 1}, "first");
  diagnostics.error({"b.ksy", 0, 0}, "cannot be read");
  EXPECT_EQ(diagnostics.print(),
            "a.ksy:1:1: error: first\n"
            "    meta:\n"
            "    ^\n"
            "a.ksy:2:10: error: name 'x'; another was expected\n"
            "    \tid: \xC3\xA4\xC3\xB6x\n"
            "    \t      ^\n"
            "b.ksy: error: cannot be read\n");
}

TEST(WireSpecs, HaveNoMistakes) {
  Model model = catalogue();
  Diagnostics diagnostics;
  load_specs(wire_specs(), model, diagnostics);
  check_model(model, diagnostics);
  EXPECT_EQ(diagnostics.print(), "");
  EXPECT_EQ(model.specs.size(), wire_specs().size());
  EXPECT_EQ(model.specs.front()->id, "tinyos");  // Imports come first.
}

}  // namespace
}  // namespace rubricc
