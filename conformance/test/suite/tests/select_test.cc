// The cases that a run takes, and those that the program contains.
#include "conformance/test/suite/select.h"

#include <gmock/gmock.h>

#include <fstream>
#include <iterator>

namespace rubric::suite {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kTraces = R"(%rtr 1
%profile paper
%node m5 mote id=5 iut
%node sA sink id=1 island=11

case a.mote
; Catches one thing
; and another.
  0 m5 < app get_clock()
  0..50 m5 > app clock(*) [J4-CLOCK J1-SEQ]

case a.sink
%node sA sink id=1 island=11 iut
  0..50 sA !> rA join_reply(*) [J3-ONCE]

case b.both
%node m5 mote id=5 iut
%node sA sink id=1 island=11 iut
%seed 7
  0..50 m5 !> rA join_request(*) [J10-MOTE]
)";

std::vector<std::string> names(const Selection& selection) {
  static const Cases cases = Cases::of_text(kTraces, "x.rtr");
  std::vector<std::string> out;
  for (const SuiteCase& one : select(cases, selection)) out.push_back(one.one->name);
  return out;
}

std::string complaint(const Selection& selection) {
  try {
    names(selection);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(Selection, ByName) {
  EXPECT_THAT(names({}), ElementsAre("a.mote", "a.sink", "b.both"));
  EXPECT_THAT(names({{"a.*"}, {}, {}, {}}), ElementsAre("a.mote", "a.sink"));
  EXPECT_THAT(names({{"?.both", "a.mote"}, {}, {}, {}}), ElementsAre("a.mote", "b.both"));
  EXPECT_THAT(complaint({{"a.moat"}, {}, {}, {}}),
              HasSubstr("no case is called 'a.moat' (did you mean 'a.mote'?)"));
  EXPECT_THAT(complaint({{"a.*", "c.*"}, {}, {}, {}}), HasSubstr("'c.*'"));
}

TEST(Selection, AllButSomeNames) {
  Selection selection;
  selection.excepted = {"a.s*"};
  EXPECT_THAT(names(selection), ElementsAre("a.mote", "b.both"));
  selection.globs = {"a.*"};
  EXPECT_THAT(names(selection), ElementsAre("a.mote"));
  selection.excepted = {"a.zink"};
  EXPECT_THAT(complaint(selection), HasSubstr("no case is called 'a.zink'"));
}

TEST(Selection, ByRule) {
  EXPECT_THAT(names({{}, {"J1"}, {}, {}}), ElementsAre("a.mote"));
  EXPECT_THAT(names({{}, {"j10-mote"}, {}, {}}), ElementsAre("b.both"));
  EXPECT_THAT(names({{}, {"J"}, {}, {}}), ElementsAre("a.mote", "a.sink", "b.both"));
  EXPECT_THAT(names({{"a*"}, {"J3", "J10"}, {}, {}}), ElementsAre("a.sink"));
  EXPECT_EQ(complaint({{}, {"J5"}, {}, {}}), "no case tries J5");
  EXPECT_EQ(complaint({{}, {"J4-SEK"}, {}, {}}),
            "no rule is called 'J4-SEK' (did you mean 'J4-SEQ'?)");
}

TEST(Selection, ByRole) {
  EXPECT_THAT(names({{}, {}, machine::Role::kMote, {}}), ElementsAre("a.mote", "b.both"));
  EXPECT_THAT(names({{}, {}, machine::Role::kSink, {}}), ElementsAre("a.sink", "b.both"));
  EXPECT_EQ(complaint({{}, {}, machine::Role::kBaseStation, {}}),
            "no case has all that is asked for");
}

TEST(Selection, ShardsAreAllOfItOnce) {
  EXPECT_THAT(names({{}, {}, {}, {1, 2}}), ElementsAre("a.mote", "b.both"));
  EXPECT_THAT(names({{}, {}, {}, {2, 2}}), ElementsAre("a.sink"));
  EXPECT_EQ(complaint({{}, {}, {}, {4, 4}}), "shard 4/4 has no case: there are only 3");
}

TEST(Selection, ShardsAreRead) {
  const auto shard = parse_shard("2/8");
  ASSERT_TRUE(shard);
  EXPECT_EQ(shard->index, 2U);
  EXPECT_EQ(shard->count, 8U);
  for (const char* bad : {"", "2", "2/", "/8", "0/8", "9/8", "a/b", "2/8x", "-1/8", "2 /8"}) {
    EXPECT_FALSE(parse_shard(bad)) << bad;
  }
}

TEST(Selection, FamiliesOfRules) {
  EXPECT_TRUE(is_of("J4-SEQ", "J4-SEQ"));
  EXPECT_TRUE(is_of("J4-SEQ", "j4"));
  EXPECT_TRUE(is_of("J10-MOTE", "J"));
  EXPECT_FALSE(is_of("J10-MOTE", "J1"));
  EXPECT_FALSE(is_of("J4-SEQ", "J4-S"));
  EXPECT_FALSE(is_of("J4", "J4-SEQ"));
  EXPECT_FALSE(is_of("J4-SEQ", ""));
}

TEST(Cases, KnowTheirRulesRolesAndNodes) {
  const Cases cases = Cases::of_text(kTraces, "x.rtr");
  const CaseRun mote = cases.find("a.mote")->blank();
  EXPECT_EQ(mote.comment, "Catches one thing and another.");
  EXPECT_EQ(mote.file, "x.rtr");
  EXPECT_THAT(mote.requirements, ElementsAre("J4-CLOCK"_rule, "J1-SEQ"_rule));
  EXPECT_THAT(mote.roles, ElementsAre(machine::Role::kMote));
  EXPECT_EQ(mote.nodes.size(), 2U);
  const CaseRun both = cases.find("b.both")->blank();
  EXPECT_THAT(both.roles, ElementsAre(machine::Role::kMote, machine::Role::kSink));
  EXPECT_EQ(both.seed, 7U);
  EXPECT_EQ(cases.find("b.nothing"), nullptr);
}

TEST(Cases, TheProgramCarriesThoseOfTheProject) {
  const Cases own = Cases::own();
  const Cases read = Cases::of({"conformance/cases"});
  ASSERT_EQ(own.all().size(), read.all().size());
  for (std::size_t i = 0; i < own.all().size(); ++i) {
    EXPECT_EQ(own.all()[i].one->name, read.all()[i].one->name);
    EXPECT_EQ(own.all()[i].file->file_name, read.all()[i].file->file_name);
    // A case that is read again when it is run is the same as before.
    const trace::Case whole = own.all()[i].whole();
    const trace::Case again = read.all()[i].whole();
    EXPECT_EQ(whole, again);
    EXPECT_EQ(whole.lines().back()->place.line, again.lines().back()->place.line);
    EXPECT_EQ(own.all()[i].blank().comment, read.all()[i].blank().comment);
    EXPECT_EQ(own.all()[i].rules(), read.all()[i].rules());
  }
  for (const EmbeddedFile& one : embedded_files()) {
    std::ifstream in(one.name, std::ios::binary);
    EXPECT_EQ(one.text, (std::string{std::istreambuf_iterator<char>(in), {}})) << one.name;
  }
}

TEST(Cases, OfTheUserMustMakeSense) {
  const auto why = [](const std::string& text) -> std::string {
    try {
      Cases::of_text("%rtr 1\n%profile paper\n" + text, "x.rtr");
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(why("%node m5 mote id=5\ncase x\n"), "x.rtr:4: case x has no node under test (iut)");
  EXPECT_THAT(why("%node m5 mote id=5 iut\ncase x\n 0 m5 < app jion()\n"), HasSubstr("x.rtr:5:"));
  EXPECT_THROW(Cases::of({"no/such/folder"}), std::runtime_error);
  EXPECT_THROW(Cases::of({"conformance/cases/j4.rtr", "conformance/cases"}), std::runtime_error);
}

}  // namespace
}  // namespace rubric::suite
