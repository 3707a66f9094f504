// A target that shows only a serial line: whatever that line can decide is judged, and nothing
// else.
#include <gtest/gtest.h>

#include "conformance/test/runner/case_files.h"
#include "conformance/test/runner/expectation.h"
#include "conformance/test/runner/run_case.h"
#include "conformance/test/runner/subject_target.h"

namespace rubric::runner {
namespace {

class SerialOnly : public SubjectTarget {
 public:
  using SubjectTarget::SubjectTarget;
  Reach reach() const override { return {false, true, false, false}; }
  void reset(const machine::Config& config) override {
    SubjectTarget::reset(config);
    shown_.clear();
    seen_ = 0;
  }
  const std::vector<Output>& outputs() const override {
    const std::vector<Output>& all = SubjectTarget::outputs();
    for (; seen_ < all.size(); ++seen_) {
      const Output& one = all[seen_];
      if (one.is_frame && one.frame.link == machine::Link::kSerial) shown_.push_back(one);
    }
    return shown_;
  }

 private:
  mutable std::vector<Output> shown_;
  mutable std::size_t seen_ = 0;
};

// Acks nothing.
class Mute : public Machine {
 public:
  void step(Ticks now, const machine::Event& event, machine::Actions& actions) override {
    Machine::step(now, event, actions);
    actions.clear();
  }
};

template <class Subject>
CaseResult run(const trace::File& file, const trace::Case& one) {
  return run_case(file, one, [](const trace::NodeHeader&) {
    return std::make_unique<SerialOnly>(std::make_unique<Subject>());
  });
}

// Returns for each line of a case whether a later one needs it.
std::string needed(const std::string& lines) {
  const trace::Parsed parsed = trace::parse_syntax("%rtr 1\ncase a\n" + lines, "a.rtr");
  EXPECT_TRUE(parsed.ok()) << parsed.errors();
  const trace::Case& one = parsed.file.cases.at(0);
  std::string out;
  for (const trace::Line* line : one.lines()) out += is_needed_later(one, *line) ? 'y' : 'n';
  return out;
}

TEST(Dependence, ByTimeByLabelAndByVariable) {
  EXPECT_EQ(needed("   0 m > app x(1)\n"), "n");
  EXPECT_EQ(needed("   0 m > app x(1)\n 5 m > app y(1)\n"), "yn");
  EXPECT_EQ(needed("   0 m > app x(1)\n @5 m > app y(1)\n"), "nn");
  EXPECT_EQ(needed("   0 m > app x(1)\n @5 m !> app y(1)\n 5 m > app z(1)\n"), "ynn");
  EXPECT_EQ(needed("   0 m > app x(1)\n @5 m > app y(1)\n 5 m > app z(1)\n"), "nyn");
  EXPECT_EQ(needed("a: 0 m > app x(1)\n @5 m > app y(1)\n a+5 m > app z(1)\n"), "ynn");
  EXPECT_EQ(needed("   @0 m > app x(v=$q)\n @5 m > app y(v=1)\n @9 m > app z(v=!$q)\n"), "ynn");
  EXPECT_EQ(needed("   @0 m > app x(v=$q:5)\n @9 m > app z(v=$q+1..$q+3)\n"), "yn");
  EXPECT_EQ(needed("   @0 m > app x(v=$q)\n @9 m > app z(v=$r)\n"), "nn");
}

TEST(SerialOnly, MachineFailsNothing) {
  std::size_t passed = 0;
  std::size_t inconclusive = 0;
  std::size_t mute_fails = 0;
  for (const trace::Parsed& file : load_cases("conformance/cases")) {
    for (const trace::Case& one : file.file.cases) {
      const CaseVerdict verdict = run<Machine>(file.file, one).verdict;
      EXPECT_TRUE(verdict == CaseVerdict::kPass || verdict == CaseVerdict::kInconclusive)
          << one.name << ": " << verdict_text(verdict);
      passed += verdict == CaseVerdict::kPass;
      inconclusive += verdict == CaseVerdict::kInconclusive;
      mute_fails += run<Mute>(file.file, one).verdict == CaseVerdict::kFail;
    }
  }
  std::printf("by a serial line alone: %zu pass, %zu inconclusive; a mute node fails %zu\n", passed,
              inconclusive, mute_fails);
  EXPECT_GE(passed, 4U);
  EXPECT_GT(mute_fails, passed);  // Inconclusive ones are judged as far as they can be seen.
}

// Silence on every link takes more than a serial line to be seen; its contrary does not.
TEST(SerialOnly, SilenceEverywhereIsNotKeptForSure) {
  const trace::Parsed parsed = trace::parse(
      "%rtr 1\n%node sA sink id=1 island=11 iut\n"
      "case silent\n @0..50 sA !> * * [J10-SINK]\n"
      "case heard\n 5 sA < serA am=0->1 net_msg(dest=11:1 src=11:null reliable=1 seq_num=7 "
      "payload.trans_id=connless payload.app_id=mockup payload.payload=x01)\n"
      " @0..400 sA !> * * [J10-SINK]\n",
      "a.rtr");
  ASSERT_TRUE(parsed.ok()) << parsed.errors();
  const CaseResult silent = run<Machine>(parsed.file, parsed.file.cases.at(0));
  EXPECT_EQ(silent.verdict, CaseVerdict::kInconclusive);
  EXPECT_EQ(silent.reason, "the target does not show app and peis and radio");
  EXPECT_EQ(run<Machine>(parsed.file, parsed.file.cases.at(1)).verdict, CaseVerdict::kFail);
}

class Blind : public SerialOnly {
 public:
  using SerialOnly::SerialOnly;
  Reach reach() const override { return {false, false, false, false}; }
  const std::vector<Output>& outputs() const override { return none_; }

 private:
  std::vector<Output> none_;
};

TEST(Blind, WhatIsNotSeenDoesNotPass) {
  for (const trace::Parsed& file : load_cases("conformance/cases")) {
    for (const trace::Case& one : file.file.cases) {
      const CaseResult result = run_case(file.file, one, [](const trace::NodeHeader&) {
        return std::make_unique<Blind>(std::make_unique<Machine>());
      });
      EXPECT_EQ(result.verdict, CaseVerdict::kInconclusive) << one.name;
    }
  }
}

}  // namespace
}  // namespace rubric::runner
