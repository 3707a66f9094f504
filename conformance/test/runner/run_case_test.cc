// A case's requirements compared with a target's outputs: one row for each way to differ.
#include "conformance/test/runner/run_case.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <numeric>

#include "conformance/test/runner/subject_target.h"
#include "conformance/trace/events/lines.h"
#include "conformance/trace/parse.h"

namespace rubric::runner {
namespace {

// Notifies its application at each of these times of its delay.
class Ticker : public Target {
 public:
  explicit Ticker(std::vector<Ticks> times) : times_(std::move(times)) {}
  void reset(const machine::Config&) override {}
  void give(Ticks now, const machine::Event&) override {
    while (run_until(now) < now) {
    }
  }
  std::optional<Ticks> next() const override {
    if (done_ == times_.size()) return std::nullopt;
    return times_[done_];
  }
  Ticks run_until(Ticks time) override {
    if (done_ == times_.size() || times_[done_] > time) return time;
    Output output;
    output.time = times_[done_++];
    output.news = events::from_notice(news_at(output.time));
    outputs_.push_back(output);
    return output.time;
  }
  virtual machine::Notice news_at(Ticks time) const { return machine::Clock{time}; }
  const std::vector<Output>& outputs() const override { return outputs_; }
  void hold_link_acks(bool) override {}

 private:
  std::vector<Ticks> times_;
  std::size_t done_ = 0;
  std::vector<Output> outputs_;
};

template <class Node = Ticker>
CaseResult run(const std::string& lines, std::vector<Ticks> times) {
  const trace::Parsed parsed =
      trace::parse("%rtr 1\n%profile paper\n%node m5 mote id=5 iut\ncase x\n" + lines, "x.rtr");
  EXPECT_EQ(parsed.errors(), "");
  return run_case(parsed.file, parsed.file.cases.at(0),
                  [&](const trace::NodeHeader&) { return std::make_unique<Node>(times); });
}

struct Row {
  const char* name;
  const char* lines;
  std::vector<Ticks> times;
  CaseVerdict verdict;
  const char* text;  // In the first failure.
};

Row passes(const char* name, const char* lines, std::vector<Ticks> times) {
  return {name, lines, std::move(times), CaseVerdict::kPass, ""};
}
Row fails(const char* name, const char* lines, std::vector<Ticks> times, const char* text) {
  return {name, lines, std::move(times), CaseVerdict::kFail, text};
}

class Rows : public testing::TestWithParam<Row> {};

void judge(const Row& row, const CaseResult& result) {
  EXPECT_EQ(result.verdict, row.verdict) << explain(result, "x.rtr");
  if (result.failures.empty()) {
    EXPECT_STREQ(row.text, "");
  } else {
    EXPECT_EQ(result.failures[0].text, row.text);
  }
}

TEST_P(Rows, AreJudged) { judge(GetParam(), run(GetParam().lines, GetParam().times)); }

INSTANTIATE_TEST_SUITE_P(
    All, Rows,
    testing::Values(
        passes("InTime", "0..50 m5 > app clock(ms=30)\n", {30}),
        passes("FirstTick", "30..50 m5 > app clock(ms=30)\n", {30}),
        passes("LastTick", "0..30 m5 > app clock(ms=30)\n", {30}),
        fails("Late", "0..29 m5 > app clock(ms=30) [J4-ACK]\n", {30},
              "it came at 30, not from 0 to 29"),
        fails("Early", "31..50 m5 > app clock(ms=30)\n", {30}, "it came at 30, not from 31 to 50"),
        fails("EarlyAfterItIsAsked", "a: 20 m5 < app get_clock()\na+20..50 m5 > app clock(*)\n",
              {25}, "it came at 25, not from 40 to 70"),
        fails("BeforeItIsAsked", "a: 20 m5 < app get_clock()\na+20..50 m5 > app clock(*)\n", {15},
              "it emitted nothing there"),
        fails("LateByTheMost", "0..50 m5 > app clock(*)\n", {1550},
              "it came at 1550, not from 0 to 50"),
        fails("TooLateToBeIt", "0..50 m5 > app clock(*)\n9000 m5 < app get_clock()\n", {1551},
              "it emitted nothing there"),
        fails("AsTheNextIsAsked", "0..50 m5 > app clock(*)\n@60 m5 < app get_clock()\n", {60},
              "it emitted nothing there"),
        fails("AfterTheNextIsAsked", "0..50 m5 > app clock(*)\n@60 m5 < app get_clock()\n",
              {60, 61}, "it came at 61, not from 0 to 50"),
        fails("Silent", "0..50 m5 > app clock(*)\n", {}, "it emitted nothing there"),
        fails("OtherField", "0..50 m5 > app clock(ms=31)\n", {30},
              "nearest, at 30: app clock(ms=30): ms: expected 31, seen 30"),
        fails("OtherFieldAtAnotherTime", "0..29 m5 > app clock(ms=31)\n", {30},
              "it emitted nothing there"),
        fails("OtherMessage", "0..50 m5 > app joined(*)\n", {30}, "it emitted no joined there"),
        Row{"OnlyShould",
            "0..50 m5 > app clock(*) [J1-SEQ]\n",
            {},
            CaseVerdict::kWeak,
            "it emitted nothing there"},
        fails("ShouldAndMust", "0..50 m5 > app clock(*) [J1-SEQ J4-ACK]\n", {},
              "it emitted nothing there"),
        fails("Twice", "0..50 m5 > app clock(*)\n@0..90 m5 !> app clock(*)\n", {30, 60},
              "at 60 it emitted app clock(ms=60)"),
        passes("OnceIsTaken", "0..50 m5 > app clock(*)\n@0..50 m5 !> app clock(*)\n", {30, 60}),
        passes("AtMostTwo",
               "@0..90 m5 ?> app clock(*)\n@0..90 m5 ?> app clock(*)\n@0..90 m5 !> app clock(*)\n",
               {30, 60}),
        fails("AtMostTwoOfThree",
              "@0..90 m5 !> app clock(*)\n@0..90 m5 ?> app clock(*)\n@0..90 m5 ?> app clock(*)\n",
              {30, 60, 70}, "at 70 it emitted app clock(ms=70)"),
        fails("MayNotLate", "@0..50 m5 ?> app clock(*)\n@0..90 m5 !> app clock(*)\n", {60},
              "at 60 it emitted app clock(ms=60)"),
        fails("MayNotOther", "@0..90 m5 ?> app clock(ms=50)\n@0..90 m5 !> app clock(*)\n", {60},
              "at 60 it emitted app clock(ms=60)"),
        passes("NeedNot", "@0..90 m5 ?> app clock(*) [J4-ACK]\n", {}),
        passes("MayIsNoTimeToCountFrom",
               "0..50 m5 > app clock(*)\n0..90 m5 ?> app clock(*)\n30 m5 > app clock(ms=60)\n",
               {30, 60}),
        passes(
            "MayTakesWhatIsLeft",
            "@0..90 m5 ?> app clock(*)\n@0..90 m5 > app clock(ms=60)\n@0..90 m5 !> app clock(*)\n",
            {30, 60}),
        passes("Beyond", "0..50 m5 > app clock(ms=$t)\n0..90 m5 > app clock(ms=$t+30..$t+40)\n",
               {30, 60}),
        fails("TooFarBeyond",
              "0..50 m5 > app clock(ms=$t)\n0..90 m5 > app clock(ms=$t+20..$t+29)\n", {30, 60},
              "nearest, at 60: app clock(ms=60): ms: expected $t+20..$t+29 ($t = 30), seen 60"),
        fails("BelowAndNegated",
              "0..50 m5 > app clock(ms=$t)\n@0..90 m5 !> app clock(ms=!$t-5..$t+29)\n", {30, 60},
              "at 60 it emitted app clock(ms=60)"),
        passes("ForbiddenBeforeItIsTaken", "@0..90 m5 !> * *\n0..50 m5 > app clock(ms=30)\n", {30}),
        fails("BoundAndForbidden", "0..50 m5 > app clock(ms=$t)\n@0..90 m5 !> app clock(ms=!$t)\n",
              {30, 60}, "at 60 it emitted app clock(ms=60)"),
        passes("AfterALabel", "a: 0..50 m5 > app clock(*)\na+20..40 m5 > app clock(*)\n", {30, 60}),
        fails("AfterThePrevious", "0..50 m5 > app clock(*)\n0..29 m5 > app clock(*)\n", {30, 60},
              "it came at 60, not from 30 to 59"),
        fails("OutOfOrder", "@0..90 m5 > app clock(ms=60)\n@0..90 m5 > app clock(ms=30)\n",
              {30, 60}, "at 30 it came before one that was to come first")),
    [](const auto& row) { return std::string(row.param.name); });

// Among so many it looks only at those that a line can mean.
TEST(RunCase, JudgesALineAmongManyOutputs) {
  std::vector<Ticks> times(300);
  std::iota(times.begin(), times.end(), Ticks{1});
  judge(passes("", "", {}), run("@300 m5 > app clock(ms=300)\n", times));
  judge(passes("", "", {}),
        run("@0..400 m5 > app clock(ms=$t)\n@0..400 m5 > app clock(ms=$t+70)\n", times));
  judge(passes("", "", {}), run("@0..400 m5 ?> app clock(ms=270)\n@270 m5 !> app *\n", times));
  judge(passes("", "", {}), run("@0..400 m5 > * *\n@0..400 m5 !> app clock(ms=1)\n", times));
  judge(fails("", "", {}, "at 270 it emitted app clock(ms=270)"),
        run("@0..400 m5 !> app clock(ms=270)\n", times));
  judge(fails("", "", {}, "at 2 it emitted app clock(ms=2)"),
        run("@0..400 m5 > * *\n@0..400 m5 !> * *\n", times));
  judge(fails("", "", {}, "at 7 it came before one that was to come first"),
        run("@0..400 m5 > app clock(ms=270)\n@0..400 m5 > app clock(ms=7)\n", times));
  judge(fails("", "", {}, "it came at 7, not from 8 to 400"),
        run("@8..400 m5 > app clock(ms=7)\n", times));
  judge(fails("", "", {}, "nearest, at 8: app clock(ms=8): ms: expected 500, seen 8"),
        run("@8..400 m5 > app clock(ms=500)\n", times));
  judge(fails("", "", {}, "it emitted no joined there"),
        run("@8..400 m5 > app joined(*)\n", times));
  judge(fails("", "", {}, "it emitted nothing there"), run("@8..400 m5 > rA *\n", times));
}

// The ends of messages, whose numbers are those times: up to tick 50 none was acked.
class Awaiting : public Ticker {
 public:
  using Ticker::Ticker;
  machine::Notice news_at(Ticks time) const override {
    return machine::AckReceived{5, static_cast<std::uint16_t>(time), time > 50};
  }
};

// The signals of the channel from 2 up to tick 50, then of that from 3; the first one is new.
class Signalling : public Ticker {
 public:
  using Ticker::Ticker;
  machine::Notice news_at(Ticks time) const override {
    return machine::SynDataReceived{
        time > 50 ? 0x30005U : 0x20005U,
        time < 30 ? machine::DataStatus::kNew : machine::DataStatus::kOld};
  }
};

// Each has a timer of its own, which may be late.
TEST(RunCase, WhatTimersCauseIsInNoOrder) {
  const auto ends = [](int first, const char* how, int second, const char* also) {
    return fmt::format(
        "@0..90 m5 > app ack_received(mockup {} {})\n@0..90 m5 > app ack_received(mockup {} {})\n",
        first, how, second, also);
  };
  judge(passes("", "", {}), run<Awaiting>(ends(40, "fail", 30, "fail"), {30, 40}));
  judge(passes("", "", {}), run<Awaiting>(ends(60, "success", 40, "fail"), {40, 60}));
  judge(passes("", "", {}), run<Awaiting>(ends(40, "fail", 60, "success"), {40, 60}));
  judge(fails("", "", {}, "at 60 it came before one that was to come first"),
        run<Awaiting>(ends(70, "success", 60, "success"), {60, 70}));
  judge(fails("", "", {}, "it emitted nothing there"),
        run<Awaiting>(ends(40, "fail", 40, "fail"), {40}));
  judge(passes("", "", {}), run<Signalling>("@0..90 m5 > app syn_data(3->5 old)\n"
                                            "@0..90 m5 > app syn_data(2->5 new)\n",
                                            {20, 60}));
  judge(fails("", "", {}, "at 20 it came before one that was to come first"),
        run<Signalling>("@0..90 m5 > app syn_data(2->5 old)\n@0..90 m5 > app syn_data(2->5 new)\n",
                        {20, 40}));
}

// In real time: its times may be 10 ticks off, and it takes 4 to give it something.
class RealTicker : public Ticker {
 public:
  using Ticker::Ticker;
  void give(Ticks now, const machine::Event& event) override {
    Ticker::give(now, event);
    given_ = {now, now + 4};
  }
  Tolerance tolerance() const override { return {10, 10}; }
  std::optional<Window> given() const override { return given_; }

 private:
  Window given_;
};

class RealRows : public testing::TestWithParam<Row> {};

TEST_P(RealRows, AreJudged) {
  judge(GetParam(), run<RealTicker>(GetParam().lines, GetParam().times));
}

INSTANTIATE_TEST_SUITE_P(
    All, RealRows,
    testing::Values(
        passes("AnswersPromptly", "a: 100 m5 < app get_clock()\na+0..50 m5 > app clock(*)\n",
               {100}),
        passes("AnswersAtTheLimit", "a: 100 m5 < app get_clock()\na+0..50 m5 > app clock(*)\n",
               {164}),
        fails("AnswersTooLate", "a: 100 m5 < app get_clock()\na+0..50 m5 > app clock(*)\n", {165},
              "it came at 165, not from 100 to 164"),
        fails("EmitsBeforeItIsAsked", "a: 100 m5 < app get_clock()\na+0..50 m5 > app clock(*)\n",
              {99}, "it emitted nothing there"),
        passes("EmitsBeforeItIsTempted",
               "a: 100 m5 < app get_clock()\na+0..50 m5 !> app clock(*)\n", {99}),
        fails("FallsAtOnce", "a: 100 m5 < app get_clock()\na+0..50 m5 !> app clock(*)\n", {101},
              "at 101 it emitted app clock(ms=101)"),
        fails("FallsAfterAStimulusThatIsNoLabel",
              "a: 60 m5 < app get_clock()\na+40 m5 < app get_clock()\n"
              "a+40..90 m5 !> app clock(*)\n",
              {105}, "at 105 it emitted app clock(ms=105)"),
        fails("FallsAfterThePrevious", "100 m5 < app get_clock()\n0..50 m5 !> app clock(*)\n",
              {101}, "at 101 it emitted app clock(ms=101)"),
        fails("FallsAfterAnAbsoluteTime",
              "100 m5 < app get_clock()\n@100..150 m5 !> app clock(*)\n", {101},
              "at 101 it emitted app clock(ms=101)"),
        fails("FallsAtTheEnd", "a: 100 m5 < app get_clock()\na+0..50 m5 !> app clock(*)\n", {140},
              "at 140 it emitted app clock(ms=140)"),
        passes("MayBeAfterTheEnd", "a: 100 m5 < app get_clock()\na+0..50 m5 !> app clock(*)\n",
               {141}),
        fails("FallsInAShortWindow", "a: 100 m5 < app get_clock()\na+0..8 m5 !> app clock(*)\n",
              {103}, "at 103 it emitted app clock(ms=103)"),
        passes("MayBeBeforeALaterStart",
               "a: 100 m5 < app get_clock()\na+30..90 m5 !> app clock(*)\n", {143}),
        fails("FallsAfterALaterStart", "a: 100 m5 < app get_clock()\na+30..90 m5 !> app clock(*)\n",
              {144}, "at 144 it emitted app clock(ms=144)"),
        passes("MayComeLate",
               "a: 100 m5 < app get_clock()\na+0..50 m5 ?> app clock(*)\na+0..90 m5 !> app *\n",
               {164}),
        passes("AnswersTheFirstOfTwoAtOnce",
               "a: 100 m5 < app get_clock()\nb: a+0 m5 < app get_clock()\n"
               "b+0..50 m5 > app clock(*)\n",
               {102}),
        passes("CountsFromAnOutputBothWays",
               "a: 0..50 m5 > app clock(*)\na+30..50 m5 > app clock(*)\n", {30, 51}),
        Row{"ShorterThanTheTolerance",
            "a: 0..50 m5 > app clock(*)\na+1..20 m5 !> app clock(*)\n",
            {30, 40},
            CaseVerdict::kInconclusive,
            ""}),
    [](const auto& row) { return std::string(row.param.name); });

// A Ticker that takes no calls.
class Refuser : public Ticker {
 public:
  using Ticker::Ticker;
  void give(Ticks now, const machine::Event& event) override {
    Ticker::give(now, event);
    throw Unsupported("calls");
  }
};

TEST(RunCase, WhatIsUnsupportedIsSkipped) {
  const CaseResult result = run<Refuser>(
      "@90 m5 < app get_clock()\n0..50 m5 > app clock(ms=30)\n@0..90 m5 !> app *\n", {30});
  EXPECT_EQ(result.verdict, CaseVerdict::kSkip) << explain(result, "x.rtr");
  EXPECT_EQ(result.reason, "calls");
}

TEST(RunCase, NobodyWaitsForAnHour) {
  const char* const lines = "@4400000 m5 < app get_clock()\n";
  EXPECT_EQ(run(lines, {}).verdict, CaseVerdict::kPass);
  const CaseResult real = run<RealTicker>(lines, {});
  EXPECT_EQ(real.verdict, CaseVerdict::kSkip);
  EXPECT_TRUE(real.not_built);
}

// Sends a frame of this type and size at each of its times.
template <std::uint8_t kType, std::size_t kSize = 4>
class Sender : public Ticker {
 public:
  using Ticker::Ticker;
  Ticks run_until(Ticks time) override {
    const std::size_t before = Ticker::outputs().size();
    const Ticks reached = Ticker::run_until(time);
    if (Ticker::outputs().size() > before) {
      Output& output = sent_.emplace_back(Ticker::outputs().back());
      output.is_frame = true;
      output.frame.type = kType;
      output.frame.size_bytes = kSize;
    }
    return reached;
  }
  const std::vector<Output>& outputs() const override { return sent_; }

 private:
  std::vector<Output> sent_;
};

// A malformed message is the protocol's, also on a line where its type has no business.
TEST(RunCase, FramesOfOtherTypesAreNobodysMessages) {
  constexpr std::uint8_t kOwn = 200;
  constexpr std::uint8_t kNet = 28;
  constexpr std::uint8_t kConfig = 37;
  const char* const silent = "@0..90 m5 !> rA *\n";
  EXPECT_EQ(run<Sender<kOwn>>(silent, {30}).verdict, CaseVerdict::kPass);
  EXPECT_EQ(run<Sender<kNet>>(silent, {30}).verdict, CaseVerdict::kFail);
  EXPECT_EQ(run<Sender<kConfig>>(silent, {30}).verdict, CaseVerdict::kFail);
  EXPECT_EQ(run<Sender<kOwn>>("@0..90 m5 !> * *\n", {30}).verdict, CaseVerdict::kPass);
  EXPECT_EQ(run<Sender<kOwn>>("@0..90 m5 > rA *\n", {30}).verdict, CaseVerdict::kFail);
  EXPECT_EQ(run<Sender<kOwn>>("@0..90 m5 !> rA am(type=200 ...)\n", {30}).verdict,
            CaseVerdict::kFail);
}

// Fields are all as asked, and a net_msg may have stale bytes; a message of one size only may not.
TEST(RunCase, BytesAfterAMessageOfOneSizeAreNoPartOfIt) {
  constexpr std::uint8_t kJoin = 14;
  using Right = Sender<kJoin, 6>;
  using Longer = Sender<kJoin, 7>;
  const char* const asked = "@0..90 m5 > rA join_request(*) [J1-REQUEST]\n";
  EXPECT_EQ(run<Right>(asked, {30}).verdict, CaseVerdict::kPass);
  for (const char* lines :
       {asked, "@0..90 m5 !> app *\n", "@0..90 m5 ?> rA *\n@0..90 m5 !> rA *\n"}) {
    const CaseResult result = run<Longer>(lines, {30});
    EXPECT_EQ(result.verdict, CaseVerdict::kFail) << lines;
    ASSERT_EQ(result.failures.size(), 1u) << lines;
    EXPECT_EQ(result.failures[0].requirements, std::vector<std::string>{"WIRE-JOIN-REQUEST"});
    EXPECT_FALSE(result.failures[0].implied);
    EXPECT_EQ(result.failures[0].time, 30u);
  }
}

TEST(RunCase, ARuleBrokenBeforeASkipStaysBroken) {
  for (const char* lines : {"@0..90 m5 !> app clock(*) [J4-SEQ]\n@90 m5 < app get_clock()\n",
                            "@90 m5 < app get_clock()\n@0..80 m5 !> app clock(*) [J4-SEQ]\n"}) {
    const CaseResult result = run<Refuser>(lines, {30});
    EXPECT_EQ(result.verdict, CaseVerdict::kFail) << lines;
    ASSERT_EQ(result.failures.size(), 1u);
    EXPECT_EQ(result.failures[0].text, "at 30 it emitted app clock(ms=30)");
    EXPECT_EQ(result.reason, "calls");
  }
}

// A Ticker that dies of a call.
class Mortal : public Ticker {
 public:
  using Ticker::Ticker;
  void give(Ticks, const machine::Event&) override { throw TargetBroken("was killed"); }
};

TEST(RunCase, WhatKillsItBlamesTheRuleOfTheStimulus) {
  const trace::Parsed parsed = trace::parse(
      "%rtr 1\n%profile paper\n%node m5 mote id=5 iut\ncase x\n0..50 m5 > app clock(*) [J4-CLOCK]\n"
      "@90 m5 < app get_clock()\n0..50 m5 > app clock(*) [J4-SEQ J4-ACK]\n@0..90 m5 !> app * "
      "[J1-SEQ]\n",
      "x.rtr");
  ASSERT_EQ(parsed.errors(), "");
  const auto play = [&](std::vector<Ticks> times) {
    return run_case(parsed.file, parsed.file.cases.at(0),
                    [&](const trace::NodeHeader&) { return std::make_unique<Mortal>(times); });
  };
  const CaseResult result = play({30});
  EXPECT_EQ(result.verdict, CaseVerdict::kFail);
  EXPECT_EQ(result.reason, "was killed");
  ASSERT_EQ(result.failures.size(), 1u);
  EXPECT_TRUE(result.failures[0].crash);
  EXPECT_EQ(result.failures[0].place.line, 6u);
  EXPECT_EQ(result.failures[0].requirements, std::vector<std::string>{"J4-SEQ"});
  EXPECT_EQ(result.failures[0].suspected, std::vector<std::string>{"J4-ACK"});
  const CaseResult before = play({30, 60, 70});
  ASSERT_EQ(before.failures.size(), 2u) << "what it broke before stays broken";
  EXPECT_TRUE(before.failures[0].weak);
  EXPECT_FALSE(before.failures[1].implied) << "a SHOULD kills nobody";
}

// A Ticker that dies when it is reset.
class Stillborn : public Ticker {
 public:
  using Ticker::Ticker;
  void reset(const machine::Config&) override { throw BrokenAtReset("was killed"); }
};

TEST(RunCase, ADeathAtResetBlamesTheFirstRuleOfItsNode) {
  struct Death {
    const char* lines;
    const char* rule;
  };
  for (const Death& one :
       {Death{"0..50 m2 !> app * [J4-SEQ]\n0..50 m5 !> rA * [J4-ACK]\n", "J4-ACK"},
        Death{"0..50 m2 !> app * [J4-SEQ]\n0..50 m5 !> rA *\n", "J4-SEQ"}}) {
    const trace::Parsed parsed = trace::parse(
        std::string("%rtr 1\n%profile paper\n%node m2 mote id=2 iut\n%node m5 mote id=5 iut\n"
                    "case x\n") +
            one.lines,
        "x.rtr");
    ASSERT_EQ(parsed.errors(), "");
    const CaseResult result =
        run_case(parsed.file, parsed.file.cases.at(0),
                 [](const trace::NodeHeader& header) -> std::unique_ptr<Target> {
                   if (header.name == "m2") return std::make_unique<Ticker>(std::vector<Ticks>{30});
                   return std::make_unique<Stillborn>(std::vector<Ticks>{});
                 });
    EXPECT_EQ(result.verdict, CaseVerdict::kFail);
    ASSERT_EQ(result.failures.size(), 1u);
    EXPECT_TRUE(result.failures[0].crash);
    EXPECT_EQ(result.failures[0].node, "m5");
    EXPECT_EQ(result.failures[0].requirements, std::vector<std::string>{one.rule});
  }
}

// Records when it is reset.
class Started : public Ticker {
 public:
  explicit Started(std::string& happened) : Ticker({}), happened_(happened) {}
  void reset(const machine::Config&) override { happened_ += "reset "; }

 private:
  std::string& happened_;
};

TEST(RunCase, NoNodeIsResetBeforeAllAreThere) {  // In real time they would be out of step.
  const trace::Parsed parsed = trace::parse(
      "%rtr 1\n%profile paper\n%node m2 mote id=2 iut\n%node m5 mote id=5 iut\ncase x\n"
      "0..50 m5 !> app clock(*)\n",
      "x.rtr");
  ASSERT_EQ(parsed.errors(), "");
  std::string happened;
  run_case(parsed.file, parsed.file.cases.at(0), [&](const trace::NodeHeader& header) {
    happened += header.name + " ";
    return std::make_unique<Started>(happened);
  });
  EXPECT_EQ(happened, "m2 m5 reset reset ");
}

TEST(RunCase, GoesOnAfterAMissingOutput) {
  const auto lines_of = [](const CaseResult& result) {
    std::vector<std::pair<std::uint32_t, bool>> out;  // Line, and whether it is implied.
    for (const Failure& one : result.failures) out.emplace_back(one.place.line, one.implied);
    return out;
  };
  using Failed = std::vector<std::pair<std::uint32_t, bool>>;
  // The stimulus comes at the end of the missing output's window, and is judged for itself.
  EXPECT_EQ(lines_of(run("a: 0..50 m5 > app clock(ms=1) [J4-SEQ]\nb: a+100 m5 < app get_clock()\n"
                         "b+0..50 m5 > app clock(ms=160)\nb+0..90 m5 !> app clock(ms=170)\n"
                         "b+0..90 m5 > app clock(ms=999)\n",
                         {160, 170})),
            (Failed{{5, false}, {8, true}, {9, true}}));
  // Lines that count from it, or use its variable, are not judged, and take what may be theirs.
  EXPECT_EQ(lines_of(run("a: 0..50 m5 > app clock(ms=$t)\na+0..50 m5 > app clock(ms=100)\n"
                         "@0..900 m5 > app clock(ms=$t+1..$t+9)\na+0..900 m5 !> app clock(*)\n"
                         "a+0..50 m5 ?> app clock(ms=300)\n@0..900 m5 !> app clock(ms=300)\n",
                         {200, 300})),
            (Failed{{5, false}}));
  // Lines that count from the missing one take no output from before its window.
  EXPECT_EQ(lines_of(run("@0..99 m5 !> app clock(*)\na: @100..150 m5 > app clock(ms=1)\n"
                         "a+1..900 m5 ?> app clock(*)\n",
                         {60})),
            (Failed{{5, false}, {6, true}}));
  // A stimulus that needs its variable ends the case,
  EXPECT_EQ(lines_of(run("a: 0..50 m5 > app clock(ms=$t)\n"
                         "@90 m5 < app write_output(channel=5->1 pos=0 value=$t)\n"
                         "@90..200 m5 > app clock(ms=150)\n",
                         {})),
            (Failed{{5, false}}));
  // and so does a weak line: what comes late is not forbidden.
  EXPECT_EQ(lines_of(run("0..50 m5 > app clock(*) [J1-SEQ]\n@0..90 m5 !> app clock(*)\n", {60})),
            (Failed{{5, false}}));
}

TEST(RunCase, WhatDiffersIsBlamedBeforeWhatForbidsTheSameOutput) {
  const CaseResult result =
      run("0..50 m5 > app clock(ms=99) [T2-CONTENT]\n"
          "@0..90 m5 !> app clock(*) [T2-ONCE]\n",
          {30});
  ASSERT_EQ(result.failures.size(), 2u);
  EXPECT_EQ(result.failures[0].requirements, std::vector<std::string>{"T2-CONTENT"});
  EXPECT_EQ(result.failures[0].broken_at, 30u);
  EXPECT_EQ(result.failures[0].time, 50u);
  EXPECT_FALSE(result.failures[0].implied);
  EXPECT_TRUE(result.failures[1].implied);
  // Without an output in its window, the line is broken when its time is over.
  const CaseResult late =
      run("0..50 m5 > app clock(ms=99) [T2-ACK]\n"
          "@60..90 m5 !> app clock(*) [T2-ONCE]\n",
          {70});
  ASSERT_EQ(late.failures.size(), 2u);
  EXPECT_EQ(late.failures[0].broken_at, 50u);
  EXPECT_EQ(late.failures[0].requirements, std::vector<std::string>{"T2-ACK"});
}

TEST(RunCase, ATimeThatClocksCannotHoldIsAnError) {
  for (const char* late :
       {"@4294967400 m5 < app get_clock()\n", "@2147483648 m5 < app get_clock()\n",
        "a: @2147483000 m5 < app get_clock()\n"
        "a+0..700 m5 > app clock(*)\n"}) {
    const CaseResult result = run(late, {});
    EXPECT_EQ(result.verdict, CaseVerdict::kError) << late;
    EXPECT_NE(result.reason.find("a case ends by tick 2147483647"), std::string::npos)
        << result.reason;
  }
  EXPECT_EQ(run("@2147483647 m5 < app get_clock()\n", {}).verdict, CaseVerdict::kPass);
}

TEST(RunCase, NothingUnderTestIsAnError) {
  const trace::Parsed parsed =
      trace::parse("%rtr 1\n%profile paper\n%node m5 mote id=5\ncase x\n", "x.rtr");
  const CaseResult result = run_case(parsed.file, parsed.file.cases.at(0), {});
  EXPECT_EQ(result.verdict, CaseVerdict::kError);
}

}  // namespace
}  // namespace rubric::runner
