// The explorer's shortest traces of the named flaws: the checker must come to the same verdict.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>

#include "codec/reflect/requirements.h"
#include "conformance/check/observation.h"
#include "conformance/check/tests/must_read.h"
#include "conformance/explore/counterexample.h"
#include "conformance/explore/search.h"
#include "conformance/generated/profiles.h"
#include "conformance/machine/flaws/flaws.h"
#include "conformance/trace/print.h"

namespace rubric::check {
namespace {

using explore::Property;

struct Flawed {
  const char* flaw;
  std::uint8_t motes;
  Property property;
  bool reorder = false;
};

explore::Options network_of(const Flawed& flawed, const flaws::Flaw& flaw) {
  explore::Options options{.profile = machine::kPaper, .motes = flawed.motes, .calls = 2};
  options.loss = options.dup = true;
  options.reorder = flawed.reorder;
  options.properties = explore::bit(flawed.property);
  options.step = flaw.step;
  if (flaw.seen == flaws::Seen::kMessages) {
    options.scope = explore::Scope::kFull;
    options.dup = false;
  }
  return options;
}

std::string text_of(const Report& report) {
  std::string text;
  for (const Finding& finding : report.findings) {
    text += std::string(reflect::requirement(finding.requirement).id) + " " +
            std::to_string(static_cast<int>(finding.severity)) + " line " +
            std::to_string(finding.place.offset_bytes) + " " + finding.node + ": " + finding.text +
            "\n";
  }
  return text;
}

Report judge_text(const std::string& text) {
  Options options{.sniffer_complete = true, .start_cold = true};
  options.ack_timeout_us = machine::us_of(machine::Profile{}.ack_timeout_ticks);  // That of all.
  return judge(must_read("counterexample.rtr", text), options);
}

// Expects the shortest trace to fail by a rule that the flaw breaks.
void expect_failure(const explore::Options& options, const flaws::Flaw& flaw) {
  const auto nodes = std::make_unique<explore::Nodes>(options);
  const explore::Result result = explore::explore(*nodes);
  ASSERT_TRUE(result.violation.has_value());
  const std::string text =
      trace::print(explore::counterexample(*nodes, *result.violation, {"paper", "explore.x", ""}));
  const Report report = judge_text(text);
  EXPECT_EQ(report.verdict, Verdict::kFail) << text;
  bool named = false;
  for (const Finding& finding : report.findings) {
    const auto& broken = flaw.requirements;
    named = named || (finding.severity == Severity::kFail &&
                      std::find(broken.begin(), broken.end(), finding.requirement) != broken.end());
  }
  EXPECT_TRUE(named) << text << text_of(report);
}

class ExplorerFlaws : public testing::TestWithParam<Flawed> {};

TEST_P(ExplorerFlaws, FailByARequirementOfTheFlaw) {
  const flaws::Flaw* const flaw = flaws::find(GetParam().flaw);
  ASSERT_NE(flaw, nullptr);
  expect_failure(network_of(GetParam(), *flaw), *flaw);
}

// Takes the first property that breaks, as the program does.
TEST_P(ExplorerFlaws, FailWhateverPropertyBreaksFirst) {
  const flaws::Flaw* const flaw = flaws::find(GetParam().flaw);
  ASSERT_NE(flaw, nullptr);
  explore::Options options = network_of(GetParam(), *flaw);
  options.properties = explore::Options{}.properties;
  for (std::uint8_t motes = GetParam().motes; motes <= 2; ++motes) {
    for (std::uint8_t sinks = 1; sinks <= 2; ++sinks) {
      options.motes = motes;
      options.sinks = sinks;
      SCOPED_TRACE(std::to_string(motes) + " motes, " + std::to_string(sinks) + " sinks");
      expect_failure(options, *flaw);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, ExplorerFlaws,
    testing::Values(Flawed{"accepts_wrong_seq", 1, Property::kJoinedAfterReply},
                    Flawed{"one_pending_seq", 2, Property::kAdmitted},
                    Flawed{"joined_on_link_ack", 1, Property::kJoinedAfterReply},
                    Flawed{"no_fail", 1, Property::kOneTerminal},
                    Flawed{"seven_requests", 1, Property::kRequestsBounded},
                    Flawed{"acks_wrong_seq", 1, Property::kAckRightSeq},
                    Flawed{"answers_members", 1, Property::kListedSilent, true},
                    Flawed{"no_ack_timeout", 1, Property::kReliableEnds},
                    Flawed{"misread_acks", 1, Property::kAckCounts}),
    [](const auto& param) { return std::string(param.param.flaw); });

}  // namespace
}  // namespace rubric::check
