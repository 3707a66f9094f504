// Running the suite: honesty first, then every case on its own.
#include "conformance/test/suite/run.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "codec/reflect/requirements.h"
#include "conformance/test/runner/blame.h"
#include "conformance/test/suite/canary.h"
#include "conformance/test/suite/causes.h"
#include "conformance/test/suite/select.h"
#include "conformance/test/suite/tests/testing.h"
#include "conformance/trace/events/lines.h"
#include "conformance/trace/print.h"

namespace rubric::suite {
namespace {

using runner::CaseVerdict;
using ::testing::ElementsAre;
using testing::FakeAttachment;
using ::testing::HasSubstr;

// Makes attachments changed by `change`.
MakeAttachment fake(std::function<void(FakeAttachment&)> change = {}) {
  return [change] {
    auto out = std::make_unique<FakeAttachment>();
    if (change) change(*out);
    return out;
  };
}

const Cases& own() {
  static const Cases cases = Cases::own();
  return cases;
}

Plan plan(std::vector<std::string> globs = {}) {
  return {.cases = select(own(), {std::move(globs), {}, {}, {}})};
}

// Reports joined (success) for the canary of motes, whatever happens.
std::unique_ptr<runner::Target> parrot() {
  runner::Output joined{.time = 10, .news = events::from_notice(machine::Joined{{10053, 5}, true})};
  return std::make_unique<testing::Parrot>(std::vector{joined});
}

TEST(Run, TheMachinePassesAllInOrderOnAnyNumberOfJobs) {
  for (const unsigned jobs : {1U, 4U}) {
    Plan all = plan();
    all.jobs = jobs;
    std::vector<std::string> told;
    const ImplementationRun run = suite::run(
        "machine", fake(), all, {{}, [&](const CaseRun& one) { told.push_back(one.name); }});
    ASSERT_EQ(run.cases.size(), own().all().size());
    ASSERT_EQ(told.size(), run.cases.size());
    for (std::size_t i = 0; i < told.size(); ++i) {
      EXPECT_EQ(told[i], own().all()[i].one->name);
      EXPECT_EQ(run.cases[i].name, told[i]);
      EXPECT_EQ(run.cases[i].result.verdict, CaseVerdict::kPass);
      EXPECT_FALSE(run.cases[i].result.log.empty());
    }
    const RuleTotals rules = rule_totals(run);
    EXPECT_EQ(rules.kept, rules.all);
    EXPECT_GT(rules.all, 130U);
  }
}

TEST(Run, TheMachinePassesWhateverTheSeed) {
  Plan some = plan();
  some.seed = 245;  // With 251 numbers begin at 65507 and run over 0xffff.
  some.repeats = 12;
  const ImplementationRun run = suite::run("machine", fake(), some);
  for (const CaseRun& one : run.cases) {
    EXPECT_EQ(one.result.verdict, CaseVerdict::kPass) << one.name << " seed " << one.seed;
  }
}

TEST(Honesty, ACanaryThatPassesEndsTheRun) {
  int targets = 0;
  const ImplementationRun run = suite::run("x", fake([&](FakeAttachment& one) {
                                             one.make = parrot;
                                             one.targets = &targets;
                                             one.says = "hm\n";
                                           }),
                                           plan());
  EXPECT_THAT(run.dishonest, HasSubstr("canary.mote has to fail"));
  EXPECT_EQ(run.stderr_text, "hm\n");
  EXPECT_TRUE(run.cases.empty());
  EXPECT_EQ(targets, 1);
  SuiteRun all;
  all.implementations.push_back(run);
  EXPECT_EQ(exit_code(all), 2);
}

TEST(Honesty, EachRoleHasACanary) {
  for (const machine::Role role : targets::machine_identity().roles) {
    int targets = 0;
    const ImplementationRun run = suite::run("x", fake([&](FakeAttachment& one) {
                                               one.who.roles = {role};
                                               one.targets = &targets;
                                             }),
                                             plan({"home.network"}));
    EXPECT_EQ(run.dishonest, "");
    EXPECT_EQ(targets, 3) << "its canary and two with a number, for the case needs all roles";
  }
}

// Starts, and lets no time pass.
class Timeless : public testing::Parrot {
 public:
  using Parrot::Parrot;
  runner::Ticks run_until(runner::Ticks) override {
    throw runner::TargetBroken("unsupported `until 0`: everything");
  }
};

TEST(Honesty, WhoLetsNoTimePassSpeaksNoRct) {
  const ImplementationRun run = suite::run(
      "x", fake([](FakeAttachment& one) {
        one.make = [] { return std::make_unique<Timeless>(std::vector<runner::Output>{}); };
      }),
      plan());
  EXPECT_THAT(run.dishonest, HasSubstr("it does not speak rct/1"));
  EXPECT_THAT(run.dishonest, HasSubstr("unsupported `until 0`: everything"));
  EXPECT_TRUE(run.cases.empty());
}

TEST(Honesty, CanBeRequired) {
  FakeAttachment honest;
  require_honest(honest, "./a", std::nullopt);
  FakeAttachment liar;
  liar.make = parrot;
  try {
    require_honest(liar, "./b", std::nullopt);
    FAIL() << "it passed a canary";
  } catch (const runner::TargetBroken& error) {
    EXPECT_THAT(error.what(), HasSubstr("./b: canary.mote has to fail"));
  }
}

// What each node of a run began with and was brought, in order.
struct Tape {
  struct Node {
    machine::Config config;
    std::vector<std::vector<std::uint8_t>> frames;
  };
  std::vector<Node> nodes;
  std::size_t next = 0;
  bool plays = false;
};

// Answers as in the run that is on the tape, whatever it is given now.
class Recorded : public runner::SubjectTarget {
 public:
  explicit Recorded(Tape& tape)
      : SubjectTarget(std::make_unique<runner::Machine>()), tape_(tape), place_(tape.next++) {}
  void reset(const machine::Config& config) override {
    if (!tape_.plays) tape_.nodes.push_back({config, {}});
    SubjectTarget::reset(known() ? tape_.nodes[place_].config : config);
  }
  void give(runner::Ticks now, const machine::Event& event) override {
    machine::Event brought = event;
    if (auto* const heard = std::get_if<machine::Heard>(&brought)) {
      if (!known()) return;
      auto& frames = tape_.nodes[place_].frames;
      const Bytes now_given = heard->frame.payload;
      if (!tape_.plays) frames.emplace_back(now_given.begin(), now_given.end());
      if (heard_ == frames.size()) return;
      const auto& then = frames[heard_++];
      heard->frame.payload = Bytes(then.data(), then.size());
    }
    SubjectTarget::give(now, brought);
  }

 private:
  bool known() const { return place_ < tape_.nodes.size(); }

  Tape& tape_;
  std::size_t place_;
  std::size_t heard_ = 0;
};

TEST(Honesty, ARecordingPassesWithItsOwnSeedAlone) {
  Tape tape;
  const auto run_with = [&](std::uint64_t seed) {
    Plan some = plan({"j4.accept", "n5.*"});
    some.seed = seed;
    tape.next = 0;
    return suite::run("x", fake([&](FakeAttachment& one) {
                        one.make = [&] { return std::make_unique<Recorded>(tape); };
                      }),
                      some);
  };
  EXPECT_EQ(run_with(7).dishonest, "");
  tape.plays = true;
  const ImplementationRun same = run_with(7);
  EXPECT_EQ(same.dishonest, "");
  EXPECT_EQ(count(same).at(CaseVerdict::kPass), same.cases.size());
  const ImplementationRun other = run_with(8);
  EXPECT_THAT(other.dishonest, HasSubstr("it keeps seeded.mote with the number 61607, but not with "
                                         "the one of the seed 8, as a recording"));
  EXPECT_TRUE(other.cases.empty());
}

TEST(Run, WhatBreaksIsAFailureOfItsCaseAlone) {
  int made = 0;
  const ImplementationRun run = suite::run("x", fake([&](FakeAttachment& one) {
                                             one.says = "boo\n";
                                             one.make = [&]() -> std::unique_ptr<runner::Target> {
                                               if (++made > 3 && made % 2 == 0)
                                                 return std::make_unique<testing::Breaking>();
                                               return testing::machine_target();
                                             };
                                           }),
                                           plan({"j5.*"}));
  std::size_t errors = 0;
  for (std::size_t i = 0; i < run.cases.size(); ++i) {
    const CaseRun& one = run.cases[i];
    if (one.result.verdict == CaseVerdict::kPass) {
      EXPECT_EQ(one.stderr_text, "");
      continue;
    }
    ++errors;
    EXPECT_EQ(one.result.verdict, CaseVerdict::kFail);
    ASSERT_EQ(one.result.failures.size(), 1U);
    EXPECT_EQ(one.result.failures[0].requirements.size(), 1U) << one.name;
    EXPECT_EQ(one.result.reason, "killed by signal 11");
    EXPECT_EQ(one.stderr_text, "boo\n");
    EXPECT_TRUE(one.unexpected());
  }
  EXPECT_EQ(errors, run.cases.size() / 2);
  SuiteRun all;
  all.implementations.push_back(run);
  EXPECT_EQ(exit_code(all), 1);
}

TEST(Run, WhatIsMissingBreaksTheRuleByWhichTheMachineDoesItNearestThen) {
  const Cases cases = Cases::of_text(
      "%rtr 1\n%node m5 mote id=5 iut\ncase c\n"
      "0          m5 < app  join(type=telosb_demo transducers=temp actuators=led)\n"
      "@0..50     m5 > rA   join_request(*)\n"
      "@250..500  m5 > rA   join_request(*)\n"  // It asks at 0 and, by another rule, at 500.
      "@251..1000 m5 > rA   join_request(*)\n"
      "@251..700  m5 > rA   join_request(*)\n",  // That is not kept by the machine either.
      "x.rtr");
  FakeAttachment silent;
  silent.make = [] { return std::make_unique<testing::Parrot>(std::vector<runner::Output>()); };
  std::vector<std::string> blamed;
  for (const runner::Failure& one :
       run_one(*cases.find("c"), silent, "", std::nullopt).result.failures) {
    blamed.push_back(one.requirements.empty() ? "" : one.requirements.front());
  }
  EXPECT_THAT(blamed, ElementsAre("J1-REQUEST", "J1-REQUEST", "", "J8-RETRY"));
}

TEST(Run, WhatHappensBetweenCasesIsKept) {
  const ImplementationRun ended = suite::run("x", fake([](FakeAttachment& one) {
                                               one.last = {{"ended with status 3", false, "boo\n"}};
                                             }),
                                             plan({"j4.*"}));
  ASSERT_EQ(ended.outside.size(), 1U);
  EXPECT_EQ(ended.outside[0].when, "after `bye`");
  EXPECT_EQ(ended.outside[0].text, "ended with status 3");
  EXPECT_EQ(ended.outside[0].stderr_text, "boo\n");
  SuiteRun all;
  all.implementations.push_back(ended);
  EXPECT_EQ(exit_code(all), 0) << "nothing that was judged is in doubt";

  int made = 0;
  const ImplementationRun died =
      suite::run("x", fake([&](FakeAttachment& one) {
                   one.make = [&] {
                     if (++made == 11) one.mishaps = {{"was killed by signal 9", true, ""}};
                     return testing::machine_target();
                   };
                   one.last = {{"wrote 'x'", true, ""}};
                 }),
                 plan({"j4.*"}));
  ASSERT_EQ(died.outside.size(), 2U);
  EXPECT_EQ(died.outside[0].when, "before " + died.cases.at(1).name) << "nine canaries, a case";
  EXPECT_EQ(died.outside[1].when, "after its last case");
  EXPECT_EQ(count(died).at(CaseVerdict::kPass), died.cases.size());
  all.implementations = {died};
  EXPECT_EQ(exit_code(all), 2);
}

TEST(Run, WhatItCannotPlayIsSkipped) {
  const ImplementationRun run = suite::run(
      "x", fake([](FakeAttachment& one) { one.who.roles = {machine::Role::kMote}; }), plan());
  const VerdictCounts counts = count(run);
  EXPECT_GT(counts.at(CaseVerdict::kPass), 100U);
  EXPECT_EQ(counts.at(CaseVerdict::kPass) + counts.at(CaseVerdict::kSkip), run.cases.size());
  for (const CaseRun& one : run.cases) {
    const bool mote = one.roles == std::vector{machine::Role::kMote};
    EXPECT_EQ(one.result.verdict == CaseVerdict::kPass, mote) << one.name;
    if (!mote) {
      EXPECT_THAT(one.result.reason, HasSubstr("only mote"));
    }
  }
  const RuleTotals rules = rule_totals(run);
  EXPECT_EQ(rules.kept + rules.untried, rules.all);
  EXPECT_GT(rules.untried, 0U);
}

TEST(Run, RepeatsCountSeedsUp) {
  Plan some = plan({"j4.accept", "n12.mote_error_value"});
  some.repeats = 3;
  some.seed = 5;
  const ImplementationRun run = suite::run("x", fake(), some);
  std::vector<std::uint64_t> seeds;
  std::vector<std::uint32_t> repeats;
  for (const CaseRun& one : run.cases) {
    seeds.push_back(one.seed);
    repeats.push_back(one.repeat);
  }
  // The second states its own.
  EXPECT_THAT(seeds, ElementsAre(5, 6, 7, 59157, 59157, 59157));
  EXPECT_THAT(repeats, ElementsAre(0, 1, 2, 0, 1, 2));
}

TEST(Run, ProfileAndSeedReachTheNode) {
  const SuiteCase& one = *own().find("j8.at_most_five");
  FakeAttachment machine;
  const CaseRun paper = run_one(one, machine, "", std::nullopt);
  EXPECT_EQ(paper.result.verdict, CaseVerdict::kPass);
  EXPECT_EQ(paper.profile, "paper");
  const CaseRun deployed = run_one(one, machine, "deployed", 3);
  EXPECT_EQ(deployed.result.verdict, CaseVerdict::kFail) << "it asks seven times";
  EXPECT_EQ(deployed.profile, "deployed");
  EXPECT_EQ(deployed.seed, 3U);
  const trace::Case log = deployed.result.log.read();
  EXPECT_THAT(trace::print(*log.lines().at(1)), HasSubstr("seq_num=1771"));
}

TEST(Results, RulesThatBroke) {
  ImplementationRun run;
  const auto add = [&](CaseVerdict verdict, std::vector<ReqId> rules,
                       std::vector<std::string> broken) {
    CaseRun& one = run.cases.emplace_back();
    one.requirements = std::move(rules);
    one.result.verdict = verdict;
    if (!broken.empty()) one.result.failures.emplace_back().requirements = std::move(broken);
    return &one;
  };
  add(CaseVerdict::kPass, {"J4-SEQ"_rule, "J4-ACK"_rule}, {});
  add(CaseVerdict::kFail, {"J4-SEQ"_rule, "J5-ONCE"_rule, "J8-LIMIT"_rule}, {"J4-SEQ"});
  add(CaseVerdict::kSkip, {"T1-WRAP"_rule}, {});
  add(CaseVerdict::kPass, {"J3-SEQ"_rule, "J3-DEST"_rule}, {});
  runner::CaseResult& one =
      add(CaseVerdict::kFail, {"J3-SEQ"_rule, "J3-DEST"_rule}, {"J4-SEQ"})->result;
  one.failures[0].suspected = {"J3-SEQ"};
  runner::Failure& later = one.failures.emplace_back();
  later.requirements = {"J3-DEST"};
  later.implied = true;
  const RuleTotals rules = rule_totals(run);
  EXPECT_EQ(rules.kept, 1U) << "J4-ACK";
  EXPECT_EQ(rules.broken, 1U) << "J4-SEQ";
  EXPECT_EQ(rules.suspected, 2U) << "J3-SEQ by the line, J3-DEST by an implied failure";
  EXPECT_EQ(rules.undecided, 2U) << "J5-ONCE and J8-LIMIT";
  EXPECT_EQ(rules.untried, rules.all - 6);
  const std::vector<RequirementSummary> all = by_requirement(run);
  ASSERT_EQ(all.size(), 7U);
  EXPECT_TRUE(std::is_sorted(all.begin(), all.end(), [](const auto& a, const auto& b) {
    return reflect::CatalogueOrder()(a.requirement, b.requirement);
  }));
}

// The rule that explains most failures is broken, also if it was only left undone or named beside
// another, or if other lines blame it for the same; what nothing explains is broken by itself.
TEST(Results, ARuleThatExplainsMoreIsTheCause) {
  ImplementationRun run;
  const auto add = [&](const char* rule) {
    CaseRun& one = run.cases.emplace_back();
    one.requirements = {trace::requirement_id(rule)};
    one.result.failures.emplace_back().requirements = {rule};
    return &one.result.failures.front();
  };
  add("T2-ACK");
  add("T2-ACK");
  runner::Failure& undone = *add("N11-NEXT");
  undone.left_undone = {"T2-ACK", "J8-LIMIT"};
  runner::Failure& beside = *add("N9-SET");
  beside.suspected = {"T2-ACK"};
  add("N10-ON")->left_undone = {"J8-LIMIT"};  // Which no failure blames.
  for (const char* rule : {"J3-ONCE", "J3-ONCE", "T2-LOOP"}) {
    runner::Failure& reply = *add(rule);
    reply.message = "join_reply";
    reply.symptom = {"radio", "join_reply", "new"};
  }
  for (const char* rule : {"N6-ONCE", "N6-ONCE", "N6-DELIVER"}) {  // Too many rules send data.
    runner::Failure& data = *add(rule);
    data.message = "net_msg";
    data.symptom = {"radio", "net_msg", "new"};
  }
  find_causes(run);
  EXPECT_EQ(undone.cause, "T2-ACK");
  EXPECT_EQ(beside.cause, "T2-ACK");
  std::vector<std::string> broken;
  std::vector<std::string> suspected;
  for (const RequirementSummary& rule : by_requirement(run)) {
    (rule.broken > 0 ? broken : suspected).push_back(reflect::requirement(rule.requirement).id);
  }
  EXPECT_THAT(broken, ::testing::UnorderedElementsAre("T2-ACK", "N10-ON", "J3-ONCE", "N6-ONCE",
                                                      "N6-DELIVER"));
  EXPECT_THAT(suspected, ::testing::UnorderedElementsAre("N11-NEXT", "N9-SET", "T2-LOOP"));
}

// T2-UNRELIABLE and T2-ACK are broken more often, and what fails by others looks alike or names
// them.
TEST(Results, WhatProvesItsRuleHasNoOtherCause) {
  const runner::Evidence ack = {"radio", "ack", "new"};
  const runner::Evidence other = {"differs", "ack", "payload"};
  const struct {
    const char* rule;
    runner::Failure failure;
    bool proven;
  } rows[] = {
      {"T2-BROADCAST", {.message = "net_msg", .symptom = ack, .prompt = "to all"}, true},
      {"T2-BROADCAST", {.message = "net_msg", .symptom = ack, .prompt = "unreliable"}, false},
      {"T2-BROADCAST", {.message = "net_msg", .symptom = ack, .prompt = ""}, false},
      {"T2-BROADCAST", {.message = "*", .symptom = ack, .prompt = "to all"}, true},
      {"N2-ONCE", {.message = "*", .symptom = ack, .prompt = "to all"}, false},
      {"T2-CONTENT", {.suspected = {"T2-ACK"}, .message = "net_msg", .symptom = other}, true},
      {"T2-CONTENT", {.suspected = {"T2-ACK"}, .message = "net_msg"}, false},
  };
  for (const auto& row : rows) {
    ImplementationRun run;
    const auto add = [&](const char* rule, runner::Failure failure) {
      CaseRun& one = run.cases.emplace_back();
      one.requirements = {trace::requirement_id(rule)};
      failure.requirements = {rule};
      failure.forbidden = failure.symptom == ack;
      one.result.failures = {std::move(failure)};
    };
    for (const char* message : {"net_msg", "*", "*"}) {
      add("T2-UNRELIABLE", {.message = message, .symptom = ack, .prompt = "unreliable"});
      add("T2-ACK", {.message = message});
    }
    add(row.rule, row.failure);
    find_causes(run);
    EXPECT_EQ(run.cases.back().result.failures.front().implied, !row.proven)
        << row.rule << ", row " << &row - rows;
  }
}

// Cases of a role that the implementation plays, of another one, and of those that what it states
// rules out.
TEST(Results, WhatIsStatedRulesCasesOut) {
  ImplementationRun run;
  using machine::Role;
  run.identity.roles = {Role::kMote, Role::kSink};
  const auto add = [&](std::vector<Role> roles, const std::string& ruled_out, bool foreign) {
    CaseRun& one = run.cases.emplace_back();
    one.roles = std::move(roles);
    one.ruled_out = ruled_out;
    one.foreign = foreign || !ruled_out.empty();
    one.result.verdict = one.foreign ? CaseVerdict::kSkip : CaseVerdict::kPass;
  };
  add({Role::kMote}, "", false);
  add({Role::kMote}, "members=8", true);
  add({Role::kMote, Role::kSink}, "gone_after=30", true);
  add({Role::kMote}, "members=8", true);
  add({Role::kSink}, "", false);
  add({Role::kBaseStation}, "", true);  // It plays no such role.
  const RuledOut all = ruled_out(run);
  EXPECT_EQ(all.all, 5U);
  EXPECT_EQ(all.left, 2U);
  EXPECT_EQ(all.by, "gone_after=30 rules out 1, members=8 rules out 2");
  const RuledOut mote = ruled_out(run, Role::kMote);
  EXPECT_EQ(mote.all, 4U);
  EXPECT_EQ(mote.left, 1U);
  const RuledOut sink = ruled_out(run, Role::kSink);
  EXPECT_EQ(sink.all, 2U);
  EXPECT_EQ(sink.left, 1U);
  EXPECT_EQ(sink.by, "gone_after=30 rules out 1");
  EXPECT_THAT(incomplete({}, run), HasSubstr("1 of 4 cases of a mote could be tried"));
  add({Role::kMote}, "", false);
  add({Role::kMote}, "", false);  // Half of them is enough.
  EXPECT_EQ(incomplete({}, run), "");
}

}  // namespace
}  // namespace rubric::suite
