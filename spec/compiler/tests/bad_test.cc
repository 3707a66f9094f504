// Every file in bad/ holds mistakes and states the expected reports; bad_files.h says how.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "spec/compiler/load/load.h"
#include "spec/compiler/tests/bad_files.h"
#include "spec/compiler/wire_specs.h"

namespace rubricc {
namespace {

std::vector<std::string> names_in(const std::string& folder, const std::string& extension) {
  std::vector<std::string> out;
  for (const auto& path : files_in(folder, extension)) out.push_back(path.stem().string());
  return out;
}

std::vector<std::string> shown(const Diagnostics& diagnostics, const std::string& file) {
  std::vector<std::string> out;
  for (const Diagnostic& one : diagnostics.sorted()) {
    std::string where = fmt::format("{}:{}: ", one.place.line, one.place.column);
    if (one.place.file != file) where = one.place.file.substr(kBadFolder.size()) + ":" + where;
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
  Model model{.requirements = rules};
  return model;
}

class BadSpec : public testing::TestWithParam<std::string> {};

TEST_P(BadSpec, IsRefusedWithTheDiagnosticsThatItExpects) {
  const std::string file = kBadFolder + GetParam() + ".ksy";
  Model model = catalogue();
  Diagnostics diagnostics;
  load_specs({file}, model, diagnostics);
  check_model(model, diagnostics);
  EXPECT_EQ(shown(diagnostics, file), expected_in(file));
  EXPECT_FALSE(diagnostics.empty());
}

INSTANTIATE_TEST_SUITE_P(Files, BadSpec, testing::ValuesIn(names_in(kBadFolder, ".ksy")),
                         [](const auto& one) { return one.param; });

class BadRequirements : public testing::TestWithParam<std::string> {};

TEST_P(BadRequirements, AreRefusedWithTheDiagnosticsThatTheyExpect) {
  const std::string file = kBadFolder + "requirements/" + GetParam() + ".yaml";
  Model model;
  Diagnostics diagnostics;
  load_requirements(file, model, diagnostics);
  EXPECT_EQ(shown(diagnostics, file), expected_in(file));
  EXPECT_FALSE(diagnostics.empty());
}

INSTANTIATE_TEST_SUITE_P(Files, BadRequirements,
                         testing::ValuesIn(names_in(kBadFolder + "requirements/", ".yaml")),
                         [](const auto& one) { return one.param; });

class BadProfile : public testing::TestWithParam<std::string> {};

TEST_P(BadProfile, IsRefusedWithTheDiagnosticsThatItExpects) {
  const std::string file = kBadFolder + "profiles/" + GetParam() + ".yaml";
  Model model = catalogue();
  Diagnostics diagnostics;
  load_profile(file, model, diagnostics);
  EXPECT_EQ(shown(diagnostics, file), expected_in(file));
  EXPECT_FALSE(diagnostics.empty());
}

INSTANTIATE_TEST_SUITE_P(Files, BadProfile,
                         testing::ValuesIn(names_in(kBadFolder + "profiles/", ".yaml")),
                         [](const auto& one) { return one.param; });

class BadCases : public testing::TestWithParam<std::string> {};

TEST_P(BadCases, AreRefusedWithTheDiagnosticsThatTheyExpect) {
  const std::string file = kBadFolder + "cases/" + GetParam() + ".rtr";
  Model model = catalogue();
  Diagnostics diagnostics;
  load_cases({file}, model, diagnostics);
  EXPECT_EQ(shown(diagnostics, file), expected_in(file));
  EXPECT_FALSE(diagnostics.empty());
}

INSTANTIATE_TEST_SUITE_P(Files, BadCases,
                         testing::ValuesIn(names_in(kBadFolder + "cases/", ".rtr")),
                         [](const auto& one) { return one.param; });

// A renamed folder would test nothing; coverage_test.cc counts the mistakes.
TEST(BadSpecs, AreAllThere) {
  EXPECT_GE(files_in(kBadFolder, ".ksy").size(), 47U);
  EXPECT_GE(files_in(kBadFolder + "requirements/", ".yaml").size(), 2U);
  EXPECT_GE(files_in(kBadFolder + "profiles/", ".yaml").size(), 3U);
  EXPECT_GE(files_in(kBadFolder + "cases/", ".rtr").size(), 6U);
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

TEST(BadSpecs, NestAtMost4096Numbers) {
  std::string text =
      "meta: {id: big, endian: be}\ntypes:\n  t13: {-requirement: A, seq: [{id: a, type: u1}]}\n";
  for (int i = 0; i < 13; ++i) {
    text += fmt::format(
        "  t{0}: {{-requirement: A, seq: [{{id: a, type: t{1}}}, {{id: b, type: t{1}}}]}}\n", i,
        i + 1);
  }
  EXPECT_NE(reported_for(text).find("'t0' nests too many numbers; at most 4096 are laid out\n"),
            std::string::npos);
}

TEST(BadSpecs, AliasesExpandToAtMost50000Values) {
  std::string cases, text;
  for (int i = 0; i < 60; ++i) cases += fmt::format("{}: t1, ", i);
  text =
      "meta: {id: big, endian: be}\ntypes:\n  t0: &t\n    -requirement: A\n    seq:\n"
      "      - {id: f0, size-eos: true, type: {switch-on: 1, cases: &c {" +
      cases + "}}}\n";
  for (int i = 1; i < 60; ++i) {
    text +=
        fmt::format("      - {{id: f{}, size-eos: true, type: {{switch-on: 1, cases: *c}}}}\n", i);
  }
  for (int i = 1; i < 60; ++i) text += fmt::format("  t{}: *t\n", i);
  const std::string error =
      "error: too much to read once aliases are expanded; at most 50000 values are read\n";
  EXPECT_NE(reported_for(text).find(error), std::string::npos);
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
