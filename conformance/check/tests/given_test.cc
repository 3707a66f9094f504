// The user's statements about nodes (`--node`, `--sink`), right and wrong.
#include "conformance/check/identify/given.h"

#include <gtest/gtest.h>

#include "conformance/check/identify/identity.h"
#include "conformance/check/observation.h"
#include "conformance/check/tests/must_read.h"
#include "conformance/check/tests/testing.h"

namespace rubric::check {
namespace {

using machine::Role;

Options with(std::vector<KnownNode> nodes) { return {.nodes = std::move(nodes)}; }

check::Run capture(const std::string& name) {
  return must_read({"spec/captures/firmware/" + name + ".pcapng"});
}

std::vector<std::string> names_of(const check::Run& run, const Options& options) {
  std::vector<std::string> out;
  for (const Device& device : identify(run, options).devices) out.push_back(device.name);
  return out;
}

// Returns the findings that say that the user may be wrong.
std::vector<Finding> doubts(const Report& report) {
  std::vector<Finding> out;
  for (const Finding& finding : report.findings) {
    if (finding.text.find("given") != std::string::npos) out.push_back(finding);
  }
  return out;
}

TEST(Given, ANamedSinkIsNoUnknownSender) {
  const check::Run run = capture("g2_stray_reply_while_joining");
  EXPECT_EQ(names_of(run, {}),
            (std::vector<std::string>{"mote 2", "unknown sender with address 1"}));
  const Options options = with({{1, Role::kSink, 77}});
  EXPECT_EQ(names_of(run, options), (std::vector<std::string>{"mote 2", "sink of island 77"}));
  const Report report = judge(run, options);
  for (const Finding& finding : report.findings) {
    EXPECT_NE(finding.severity, Severity::kStray) << finding.text;
  }
  // A reply for another island is not that sink's.
  EXPECT_EQ(names_of(run, with({{1, Role::kSink, 11}})), names_of(run, {}));
}

TEST(Given, ANamedMotesLostFramesMakeNoStrangers) {
  Script script;
  script.join(0, 11, 2, 100).net(200, 2, 1, message({11, 2}, {11, machine::kNullDevid}, 1));
  script.dsn[2] = 200;  // Many frames were not heard.
  script.net(9000, 2, 1, message({11, 2}, {11, machine::kNullDevid}, 2));
  const auto unknown = std::string("unknown sender with address 2");
  const auto before = names_of(script.run, {});
  EXPECT_NE(std::find(before.begin(), before.end(), unknown), before.end());
  const auto named = names_of(script.run, with({{2, Role::kMote}}));
  EXPECT_EQ(std::find(named.begin(), named.end(), unknown), named.end());
  EXPECT_EQ(std::count(named.begin(), named.end(), "mote 2"), 1);
}

// Without a join in sight only the destination of a message suggests a sink's island.
TEST(Given, AnIslandWinsOverAGuess) {
  Script script;
  for (int i = 0; i < 4; ++i) {
    const auto seq_num = static_cast<std::uint16_t>(10 + i);
    script.net(100 * i, 1, 3, message({12, machine::kNullDevid}, {12, 3}, seq_num), 11);
  }
  EXPECT_EQ(names_of(script.run, {})[0], "sink of island 12");
  EXPECT_EQ(names_of(script.run, with({{1, Role::kSink, 11}}))[0], "sink of island 11");
}

TEST(Given, ALineWithoutASignOfItsIslandIsTheGivenSinks) {
  Script script;
  script.run.taps.pop_back();
  script.down(100, message({12, 3}, {11, 2}, 5));
  EXPECT_TRUE(names_of(script.run, {}).empty());
  EXPECT_EQ(names_of(script.run, with({{1, Role::kSink, 11}})),
            (std::vector<std::string>{"sink of island 11", "base station of island 11"}));
}

TEST(Given, ARightOneChangesNoVerdict) {
  for (const char* name : {"c_two_islands", "b_reliable", "a_join_data", "f_synaptic"}) {
    const check::Run run = capture(name);
    const Report before = judge(run, {});
    const Report report = judge(run, with({{1, Role::kSink, 11}, {2, Role::kMote}}));
    EXPECT_EQ(report.findings.size(), before.findings.size()) << name;
    EXPECT_EQ(report.verdict, before.verdict) << name;
    EXPECT_EQ(report.facts, before.facts) << name;
  }
}

TEST(Given, AWrongIslandIsSaidOnceAndTheRunBelieved) {
  for (const char* name : {"c_two_islands", "b_reliable", "a_join_data"}) {
    const check::Run run = capture(name);
    const Options wrong = with({{1, Role::kSink, 99}});
    const std::vector<Finding> said = doubts(judge(run, wrong));
    ASSERT_EQ(said.size(), 1U) << name;
    EXPECT_EQ(said[0].severity, Severity::kInconclusive);
    EXPECT_GT(said[0].place.frame, 0U);
    EXPECT_EQ(said[0].node.rfind("sink of island 1", 0), 0U);
    EXPECT_NE(said[0].text.find("99"), std::string::npos) << said[0].text;
    EXPECT_EQ(judge(run, wrong).findings.size(), judge(run, {}).findings.size() + 1);
  }
}

TEST(Given, ASinkThatIsRenamedHadItsGivenIslandBefore) {
  Script script;
  constexpr auto kSetIsland = static_cast<std::uint8_t>(rubicon::CommandCode::kSetIslandId);
  const auto rename = [&](double ms) { script.serial(ms, true, am::kConfig, {kSetIsland, 0, 12}); };
  script.net(0, 1, 3, message({11, machine::kNullDevid}, {11, 3}, 5), 11);
  rename(50);
  script.reply(100, 12, 4, 7, 100);
  script.run.taps.pop_back();
  ASSERT_EQ(set_island_id(script.run.seen[1].frame), 12);
  EXPECT_TRUE(doubts(judge(script.run, with({{1, Role::kSink, 11}}))).empty());
  // It was renamed to neither of these, and with several given nothing shows which one it had
  // before.
  EXPECT_EQ(doubts(judge(script.run, with({{1, Role::kSink, 13}, {1, Role::kSink, 14}}))).size(),
            1U);
}

TEST(Given, AWrongRoleIsSaidOnceAndTheRunBelieved) {
  const check::Run run = capture("c_two_islands");
  const struct {
    KnownNode node;
    const char* name;
    ReqId rule;
  } kRows[] = {
      {{1, Role::kMote}, "sink of island 11", "J10-MOTE"_rule},
      {{2, Role::kSink}, "mote 2", "J10-SINK"_rule},
      {{2, Role::kBaseStation}, "mote 2", ReqId::kNone},
  };
  for (const auto& row : kRows) {
    const Options options = with({row.node});
    const Report report = judge(run, options);
    const std::vector<Finding> said = doubts(report);
    ASSERT_EQ(said.size(), 1U) << row.name;
    EXPECT_EQ(said[0].severity, Severity::kInconclusive);
    EXPECT_EQ(said[0].node, row.name);
    EXPECT_EQ(said[0].requirement, row.rule);
    EXPECT_EQ(report.findings.size(), judge(run, {}).findings.size() + 1) << row.name;
  }
}

// It asks as a mote does, so it is one: that it answers as well is its fault.
TEST(Given, AMoteThatAlsoActsAsASinkFails) {
  Script script = Script().request(0, 2, 100).request(900, 3, 7);
  Payload reply;
  for (const std::uint32_t word : {11U, 3U, 0U, 0U, 7U}) put16(reply, word);
  script.radio(910, 2, 3, am::kJoinReply, reply);
  const Report report = judge(script.run, with({{2, Role::kMote}}));
  EXPECT_TRUE(doubts(report).empty());
  bool failed = false;
  for (const Finding& finding : report.findings) {
    failed =
        failed || (finding.requirement == "J10-MOTE"_rule && finding.severity == Severity::kFail);
  }
  EXPECT_TRUE(failed);
}

TEST(Given, ANodeThatIsNowhereIsAFact) {
  const Report report = judge(capture("c_two_islands"), with({{9, Role::kMote}}));
  EXPECT_EQ(report.facts.back(), "AM address 9, given: no frame of it");
}

TEST(Given, ALogThatContradictsTheUserIsReported) {
  constexpr const char* kLog = R"(%rtr 1  %profile paper  %tick us
%node m2 mote id=2
%node sA sink id=1 island=11

case log
   @0 m2 < app join(type=1 transducers=1 actuators=1)
   @1000 m2 > rA am=2->1 join_request(seq_num=5 mote_type=1 transducers=1 actuators=1)
   @2000 sA > rA am=1->2 join_reply(island_addr=11 mote_addr=2 seq_num=5 cur_time=2)
)";
  const check::Run run = must_read("log", kLog);
  EXPECT_TRUE(doubts(judge(run, with({{1, Role::kSink, 11}, {2, Role::kMote}}))).empty());
  const std::vector<Finding> island = doubts(judge(run, with({{1, Role::kSink, 12}})));
  ASSERT_EQ(island.size(), 1U);
  EXPECT_EQ(island[0].node, "sink of island 11");
  const std::vector<Finding> role = doubts(judge(run, with({{2, Role::kSink}})));
  ASSERT_EQ(role.size(), 1U);
  EXPECT_EQ(role[0].node, "mote 2");
}

}  // namespace
}  // namespace rubric::check
