// The profiles, the machine's struct and the catalogue agree; rubricc finds rules in traces.
#include "conformance/generated/profiles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "conformance/machine/state.h"
#include "spec/compiler/emit/cpp_text.h"
#include "spec/compiler/emit/emit.h"
#include "spec/compiler/load/load.h"
#include "spec/compiler/model.h"

namespace rubricc {
namespace {

using rubric::machine::kDeployed;
using rubric::machine::kPaper;

TEST(Profiles, HaveEveryMemberOfTheStruct) {
  // As many names as members, else this does not compile: then profile_fields() lacks one, too.
  const auto [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p] = kPaper;
  EXPECT_EQ(profile_fields().size(), 16U);
  EXPECT_EQ(a, 1024);
  EXPECT_EQ(o, 30);
  EXPECT_EQ(p, 0U);
  for (const ProfileField& field : profile_fields()) {
    if (field.name == "members_max") {
      EXPECT_EQ(field.max, std::int64_t{rubric::machine::kMembersMax});
    }
    if (field.name == "channels_max") {
      EXPECT_EQ(field.max, std::int64_t{rubric::machine::kChannelsRoom});
    }
  }
}

TEST(Profiles, PaperIsWhatTheStructIsByDefault) {
  EXPECT_TRUE(kPaper == rubric::machine::Profile{});
  EXPECT_FALSE(kPaper == kDeployed);
}

TEST(Profiles, OnlyDocumentedDifferencesAreAccepted) {
  Model model;
  Diagnostics diagnostics;
  load_requirements("spec/requirements.yaml", model, diagnostics);
  load_profiles("spec/profiles", model, diagnostics);
  EXPECT_EQ(diagnostics.print(), "");
  ASSERT_EQ(model.profiles.size(), 2U);
  EXPECT_EQ(model.profiles[0].name, "deployed");
  EXPECT_GT(model.profiles[0].accepted.size(), 0U);
  EXPECT_EQ(model.profiles[1].accepted.size(), 0U);
  for (const AcceptedDifference& one : model.profiles[0].accepted) {
    const auto rule = std::find_if(model.requirements.begin(), model.requirements.end(),
                                   [&](const Requirement& r) { return r.id == one.requirement; });
    ASSERT_NE(rule, model.requirements.end());
    EXPECT_NE(rule->deployed, "") << one.requirement << ": 'deployed' does not say how it differs";
  }
}

/// A trace in a folder of its own.
class Cases : public testing::Test {
 protected:
  Cases() : folder_(std::filesystem::path(testing::TempDir()) / "rubricc_cases") {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_ / "deeper");
  }
  ~Cases() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }
  Model read() const {
    Model model;
    Diagnostics diagnostics;
    load_requirements("spec/requirements.yaml", model, diagnostics);
    load_cases(case_files(folder_.string()), model, diagnostics);
    EXPECT_EQ(diagnostics.print(), "");
    return model;
  }

  std::filesystem::path folder_;
};

std::vector<std::string> texts(const Model& model) {
  std::vector<std::string> out;
  for (const CaseUse& one : model.case_uses) {
    out.push_back(one.case_name + (one.negative ? " !" : " ") + one.requirement);
  }
  return out;
}

TEST_F(Cases, AreFoundByTheirTags) {
  write("b.rtr",
        "%rtr 1\n%node m [not a tag]\n"
        "case b.one\n"
        "  0 m > rA x(values=[1 2] text=\"a;(\\\"[\" n=!2)  [J4-ACK, "
        "J4-CONTENT\tJ5-SUCCESS] ; [J1-X]\n"
        "  0 m !> rA x(*) [J4-SEQ]\n"
        "  0 m !> rA x(*) [J4-SEQ] | 00ff\n"
        "  0 m > rA x(a=1) | 00ff [J4-SEQ]\n"
        "case\tb.two ; the second\n");
  write("deeper/a.rtr", "case a.one\n 0 m > rA x(*) [WIRE-HDLC-FLAG]\n");
  write("deeper/a.txt", "case a.two\n [NOTHING]\n");
  const Model model = read();
  EXPECT_EQ(texts(model),
            (std::vector<std::string>{"b.one J4-ACK", "b.one J4-CONTENT", "b.one J5-SUCCESS",
                                      "b.one !J4-SEQ", "b.one J4-SEQ", "a.one WIRE-HDLC-FLAG"}));
  const std::string text = emit_cases(model, "folder").at(0).text;
  EXPECT_NE(text.find("std::array<CaseUse, 6> kCaseUses{{\n    {\"b.one\","), text.npos);
  EXPECT_NE(text.find("\"J4-SEQ\"_rule, true},\n"), text.npos);
}

TEST_F(Cases, MayBeNone) {
  EXPECT_TRUE(case_files((folder_ / "nothing").string()).empty());
  const std::string text = emit_cases(read(), "folder").at(0).text;
  EXPECT_NE(text.find("std::array<CaseUse, 0> kCaseUses{};\n"), text.npos);
}

}  // namespace
}  // namespace rubricc
