// Lawful traffic, made by a generator that knows the rules and not this checker: nothing may fail.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <string>
#include <utility>

#include "codec/reflect/requirements.h"
#include "conformance/check/observation.h"
#include "conformance/check/tests/frames_testing.h"
#include "conformance/check/tests/lawful_testing.h"
#include "conformance/check/tests/must_read.h"
#include "conformance/selftest/lawful_traffic/generate.h"
#include "conformance/selftest/lawful_traffic/recorder.h"
#include "conformance/selftest/lawful_traffic/variants.h"
#include "tools/tests/readme/number.h"

namespace rubric::check {
namespace {

constexpr std::uint64_t kSeeds = 4;
constexpr std::uint64_t kMixedSeeds = 60;

struct Count {
  bool different = true;  ///< Whether to count different frames; a thousand seeds have too many.
  std::uint64_t judgements = 0;
  FrameSet frames;
  std::uint64_t fails = 0;
  std::uint64_t known = 0;  ///< False alarms that the README of check admits.
};

// A line that lost one frame looks whole where the capture shows no other loss. Where it begins
// later, nodes of one address whose DSNs agree look like one. Where lines are late, what a sink
// did and what it was given may lie so close that no frame shows which came first.
bool is_known(const std::string& recorder, ReqId rule) {
  constexpr ReqId kOfALostFrame[] = {"J6-REPORT"_rule, "T2-ACK"_rule, "N2-ONCE"_rule,
                                     "J6-CONTENT"_rule, "N6-COLLISION"_rule};
  constexpr ReqId kOfALostCopy[] = {"T2-ONCE"_rule, "N6-OWN"_rule, "T3-RESEND"_rule};
  constexpr ReqId kOfNamesakes[] = {"N2-ORDER"_rule, "N5-FOREIGN"_rule, "N6-ONCE"_rule,
                                    "N7-RADIO"_rule};
  constexpr ReqId kOfLateLines[] = {"N2-ORDER"_rule, "N7-CONTENT"_rule, "N7-RADIO"_rule};
  const auto has = [rule](const auto& rules) {
    return std::ranges::find(rules, rule) != std::end(rules);
  };
  return (recorder == "drops_few" && has(kOfALostFrame)) ||
         (recorder == "drops_on_lines" && (has(kOfALostFrame) || has(kOfALostCopy))) ||
         (recorder == "begins_late" && has(kOfNamesakes)) ||
         (recorder == "late_lines" && has(kOfLateLines));
}

void judge_one(const lawful::Traffic& traffic, const std::string& recorder, const Options& options,
               Count& count) {
  const check::Run run = must_read(traffic.variant, lawful::to_pcapng(traffic));
  const Report report = judge(run, options);
  ++count.judgements;
  if (count.different) add_frames(run, count.frames);
  for (const Finding& finding : report.findings) {
    bool fails = finding.severity == Severity::kFail;
    if (fails && is_known(recorder, finding.requirement)) {
      ++count.known;
      fails = false;
    }
    count.fails += fails ? 1 : 0;
    EXPECT_FALSE(fails) << traffic.variant << " seed " << traffic.seed << ", recorder " << recorder
                        << ", frame " << finding.place.frame << ": "
                        << reflect::requirement(finding.requirement).id << " " << finding.text
                        << " Allowed: " << finding.expected;
  }
}

void judge_both(const std::string& variant, std::uint64_t seed, const std::string& recorder,
                Count& count) {
  lawful::Traffic traffic = lawful::generate(variant, seed);
  lawful::record(traffic, recorder, seed);
  judge_one(traffic, recorder, options_of(traffic), count);
  judge_one(traffic, recorder, options_of_whole(traffic), count);
}

TEST(Lawful, NothingFails) {
  Count count;
  for (const lawful::Variant& variant : lawful::variants()) {
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      judge_both(std::string(variant.name), seed, "exact", count);
    }
  }
  const std::uint64_t variants = lawful::variants().size();
  for (std::uint64_t seed = 1; seed <= kMixedSeeds; ++seed)
    judge_both("mixed", seed, "exact", count);
  std::printf("%llu lawful variants, %llu judgements of %zu frames, %llu false alarms\n",
              static_cast<unsigned long long>(variants),
              static_cast<unsigned long long>(count.judgements), count.frames.size(),
              static_cast<unsigned long long>(count.fails));
  EXPECT_EQ(count.frames.size(), readme_number("alarm in # different frames"));
  EXPECT_GE(variants, 20U);
}

// Each of these raised a false alarm once.
TEST(Lawful, NoAlarmComesBack) {
  struct Alarm {
    const char* variant;
    std::uint64_t seed;
    const char* recorder;
  };
  constexpr Alarm kAlarms[] = {
      {"same_devid", 323, "exact"},               // A message of the namesake in the other island.
      {"in_full", 634, "exact"},                  // A buffer filled over the response time.
      {"host_loops_radiated", 975, "exact"},      // The other sink's own message.
      {"host_loops_radiated", 974, "exact"},      // The other sink has the same DSN.
      {"ack_join_often", 12, "drops_and_steps"},  // A step between repeats; the reply was dropped.
      {"stated_slow", 13, "steps_forth"},         // A step among reactions that all are slow.
      {"link_ack_lost_same_dsn", 237, "steps_forth"},  // A step between a frame and its copy.
      {"stated_slow_join_timer", 364, "steps_back"},   // A step as long as the silence before it.
      {"mixed", 6602, "steps_often"},                  // Two steps forth in one join.
      {"stated_slow", 294, "steps_often"},             // A step forth that looks like a silence.
      {"mixed", 16304, "steps_often"},                 // The same, with packets that are missing.
      {"seq_near_end", 71,
       "drops"},  // An ack of a message that was dropped, with a report's number.
      {"unconfirmed_requests_again", 59, "drops"},  // The request of a later ack_join was dropped.
      {"link_ack_lost_same_dsn", 111, "drops"},     // An ack_join without a gap was dropped.
      {"serial_ack_lost", 245, "drops"},        // A report was dropped from a line of 24 packets.
      {"stated_slow", 189, "drops"},            // A link's repeat was dropped, without a gap.
      {"island_change_forgets", 619, "drops"},  // SET_ISLAND_ID was dropped.
      {"same_devid", 573, "drops"},             // The request of a namesake was dropped.
      {"interleaved_joins", 858, "drops_and_steps"},  // A step between two replies.
      {"foreign_mote_to_sink", 46, "steps_forth"},    // A step before an ack to another island.
      {"mixed", 372, "drops"},           // A lossy line, shown by an ack without packet.
      {"mixed", 584, "steps_often"},     // A step after a damaged frame.
      {"mixed", 275, "drops"},           // A repeat after a message; the join was dropped.
      {"two_sinks_first", 14, "exact"},  // A PC's message on the other island's line.
      {"in_full", 195, "exact"},         // A buffer filled by messages that only passed through.
      {"host_loops_radiated", 89, "exact"},    // A frame taken for that of the other sink.
      {"island_change_forgets", 91, "exact"},  // An ack of before SET_ISLAND_ID.
      {"mixed", 2754, "exact"},  // A repeat of an ack_join whose first was not captured.
      {"host_loops_radiated", 615, "radio_alone"},  // A sink's own message, handed down again.
      {"host_loops_radiated", 671, "radio_alone"},  // A reliable one.
      {"host_loops_radiated", 968, "radio_alone"},
      {"same_devid", 42, "exact"},                // Namesakes with the same DSNs that join at once.
      {"same_devid", 189, "exact"},               // The same; the second accepts first.
      {"corrupt_frames", 65, "late_lines"},       // Radiated by a late line's clock before it came.
      {"host_loops_ignored", 106, "late_lines"},  // Radiated by a sink taken for a stray sender.
      {"other_mote_relayed", 12, "begins_late"},  // The same, relayed.
      {"in_full", 335, "begins_late"},            // An ack of what came before the capture began.
      {"host_loops_ignored", 696, "begins_late"},     // A message that came before it, too.
      {"island_change_forgets", 898, "begins_late"},  // An island that was told before it.
  };
  Count count;
  for (const Alarm& one : kAlarms) judge_both(one.variant, one.seed, one.recorder, count);
  EXPECT_EQ(count.known, 0U);
}

TEST(Lawful, ACoarseClockIsSeenAndSaid) {
  for (const bool coarse : {true, false}) {
    lawful::Traffic traffic = lawful::generate("home", 1);
    lawful::record(traffic, coarse ? "coarse_stamps" : "exact", 1);
    const check::Run run = must_read("home", lawful::to_pcapng(traffic));
    EXPECT_EQ(run.grid_us, coarse ? 50'000 : 0);
    const auto says = [](const std::string& fact) {
      return fact.starts_with("stamps are whole steps of 50000 us apart");
    };
    EXPECT_EQ(std::ranges::any_of(run.facts, says), coarse);
  }
}

// Traffic that is lawful only by what its nodes state fails when they state nothing.
TEST(Lawful, UnstatedItFails) {
  for (const char* name : {"stated_join_timer", "stated_requests", "stated_busy_channel"}) {
    std::size_t fails = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      fails +=
          judge(must_read(name, lawful::to_pcapng(lawful::generate(name, seed))), {}).verdict ==
          Verdict::kFail;
    }
    EXPECT_GT(fails, 0U) << name;
  }
}

// Returns the first and the last seed that RUBRIC_SEEDS asks for: "12" is 1 to 12, "13-40" a part.
std::pair<std::uint64_t, std::uint64_t> seeds() {
  const char* const asked = std::getenv("RUBRIC_SEEDS");
  if (asked == nullptr) return {1, 1};
  char* end = nullptr;
  const std::uint64_t number = std::strtoull(asked, &end, 10);
  if (*end != '-') return {1, number};
  return {number, std::strtoull(end + 1, nullptr, 10)};
}

class Recorded : public testing::TestWithParam<lawful::Recorder> {};

// The stamps are wrong and packets are missing; the nodes are honest all the same.
TEST_P(Recorded, NothingFails) {
  const auto [first, last] = seeds();
  const std::string how(GetParam().name);
  Count count;
  count.different = first == last;
  for (std::uint64_t seed = first; seed <= last; ++seed) {
    for (const lawful::Variant& variant : lawful::variants()) {
      judge_both(std::string(variant.name), seed, how, count);
    }
    for (std::uint64_t mixed = 20 * seed - 19; mixed <= 20 * seed; ++mixed) {
      judge_both("mixed", mixed, how, count);
    }
  }
  EXPECT_LE(count.known, 1 + count.judgements / (how == "drops_on_lines" ? 1500 : 2000));
  std::printf("%s: %llu judgements of %zu frames, %llu false alarms, %llu known ones\n",
              how.c_str(), static_cast<unsigned long long>(count.judgements), count.frames.size(),
              static_cast<unsigned long long>(count.fails),
              static_cast<unsigned long long>(count.known));
}

INSTANTIATE_TEST_SUITE_P(Lawful, Recorded, testing::ValuesIn(lawful::recorders()),
                         [](const auto& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace rubric::check
