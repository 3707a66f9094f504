// The golden traces find every broken machine.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <regex>
#include <set>
#include <thread>

#include "codec/reflect/requirements.h"
#include "conformance/selftest/mutants/fields.h"
#include "conformance/selftest/mutants/hunt.h"
#include "conformance/test/suite/cases.h"
#include "conformance/test/suite/causes.h"
#include "tools/tests/readme/number.h"

namespace rubric::mutants {
namespace {

struct Hunted {
  Mutants mutants;
  std::vector<Found> found;
};

const Golden& golden() {
  static const Golden cases("conformance/cases");
  return cases;
}

Hunted hunted(Mutants mutants) {
  const unsigned threads = std::clamp(std::thread::hardware_concurrency(), 1U, 4U);
  std::vector<Found> found = hunt_all(golden(), mutants, threads);
  return {std::move(mutants), std::move(found)};
}
const Hunted& named() {
  static const Hunted all = hunted(named_mutants());
  return all;
}
const Hunted& generated() {
  static const Hunted all = hunted(generated_mutants(golden()));
  return all;
}

// A survivor must be listed with its reason, and each listed one must survive.
void expect_found(const Hunted& all) {
  for (std::size_t i = 0; i < all.mutants.size(); ++i) {
    const Mutant& mutant = all.mutants[i];
    const Survivor* const listed = find_survivor(mutant.name);
    if (all.found[i].killed) {
      EXPECT_EQ(listed, nullptr) << mutant.name << " is listed as a survivor (" << listed->name
                                 << "), but found by " << all.found[i].by;
    } else {
      EXPECT_NE(listed, nullptr) << "no golden trace finds " << mutant.name << ": "
                                 << mutant.breaks;
    }
  }
}

TEST(Mutants, MachineItselfPasses) {
  EXPECT_EQ(golden().cases().size(), readme_number("passes # golden traces"));
  for (const CaseRef& ref : golden().broken()) ADD_FAILURE() << ref.one->name;
  for (const CaseRef& ref : golden().cases()) {  // So does a wrapper that changes nothing.
    const auto idle = run(ref, wrapped(always([](Moment& moment) {
                            moment.honest();
                            moment.rewrite([&](const Action& action) { moment.keep(action); });
                          })));
    EXPECT_EQ(idle.verdict, runner::CaseVerdict::kPass)
        << runner::explain(idle, ref.file->file_name);
  }
}

TEST(Mutants, NamedOnesAreFound) { expect_found(named()); }
TEST(Mutants, GeneratedOnesAreFound) { expect_found(generated()); }

TEST(Mutants, NamedOnesAreFoundByTheirRule) {
  for (std::size_t i = 0; i < named().mutants.size(); ++i) {
    const Found& found = named().found[i];
    EXPECT_TRUE(!found.killed || found.named)
        << named().mutants[i].name << " is found, but by no rule of its own:\n"
        << found.lines;
  }
}

// The rule that is blamed is far more often the broken one than any rule that a failing line names.
TEST(Mutants, TheRightRuleIsBlamed) {
  Blame named_there;
  Blame blamed;
  std::size_t hit = 0;
  std::size_t killed = 0;
  for (std::size_t i = 0; i < named().mutants.size(); ++i) {
    const Found& found = named().found[i];
    if (!found.killed) continue;
    ++killed;
    hit += found.blamed_there.right > 0;
    if (found.blamed_there.right == 0) std::printf("%s\n", named().mutants[i].name.c_str());
    named_there.rules += found.named_there.rules;
    named_there.right += found.named_there.right;
    blamed.rules += found.blamed_there.rules;
    blamed.right += found.blamed_there.right;
  }
  std::printf(
      "of %zu rules that failing lines name %zu are broken; of %zu blamed %zu; %zu of %zu "
      "mutants are blamed for a rule of theirs\n",
      named_there.rules, named_there.right, blamed.rules, blamed.right, hit, killed);
  EXPECT_GT(blamed.right * named_there.rules, named_there.right * blamed.rules);
  EXPECT_GT(blamed.right * 100, blamed.rules * 85);
}

suite::ImplementationRun whole_suite(const runner::SubjectFactory& factory) {
  static const suite::Cases cases = suite::Cases::own();
  suite::ImplementationRun all;
  for (const suite::SuiteCase& each : cases.all()) {
    suite::CaseRun& one = all.cases.emplace_back(each.blank());
    one.profile = "paper";
    one.result = run({each.file, each.one}, factory);
    if (one.result.failures.empty()) continue;
    suite::compare_with_machine(each.file->file, *each.one, one);
  }
  return all;
}

// One mistake shows in cases of many rules. Half of the rules that are blamed there are not called
// broken, and hardly ever is that of the mistake among them.
TEST(Mutants, TheWholeSuiteCallsFewRulesBroken) {
  constexpr std::size_t kEach = 12;  // Takes a third of a second for each mutant.
  Blame blamed;
  Blame broken;
  std::size_t hit = 0;
  std::size_t tried = 0;
  const auto count = [](const suite::ImplementationRun& run, const Mutant& mutant, Blame& sum) {
    std::size_t right = 0;
    for (const suite::RequirementSummary& rule : suite::by_requirement(run)) {
      if (rule.broken == 0) continue;
      ++sum.rules;
      right +=
          std::ranges::find(mutant.requirements, rule.requirement) != mutant.requirements.end();
    }
    sum.right += right;
    return right > 0;
  };
  for (std::size_t i = 0; i < named().mutants.size(); i += kEach) {
    const Mutant& mutant = named().mutants[i];
    if (!named().found[i].killed) continue;
    suite::ImplementationRun all = whole_suite(mutant.factory());
    count(all, mutant, blamed);
    suite::find_causes(all);
    ++tried;
    const bool found = count(all, mutant, broken);
    hit += found;
    if (!found) std::printf("%s\n", mutant.name.c_str());
  }
  std::printf(
      "%zu mutants: of %zu rules that failures blame %zu are theirs; of %zu called broken %zu; "
      "%zu are called broken by a rule of theirs\n",
      tried, blamed.rules, blamed.right, broken.rules, broken.right, hit);
  EXPECT_GT(tried, 20U);
  EXPECT_LT(broken.rules * 10, blamed.rules * 6);
  EXPECT_GE(hit * 10, tried * 9);
}

struct AckFaults {
  bool unreliable = false;     // Are acked.
  bool broadcasts = false;     // Are acked, by motes.
  std::uint8_t unacked = 255;  // What is for this application is not acked.
  bool next_number = false;    // Acks name the next number.
};

StepMaker acking_wrongly(AckFaults faults) {
  const auto step = [=](Moment& moment) {
    const Frame* const frame = moment.heard(am::kNet);
    if (frame != nullptr && is_net(*frame) && !is_ack(*frame)) {
      Forged& heard = moment.forge(*frame);
      std::uint8_t& reliable = heard.bytes[net::kReliable];
      const std::uint16_t dest = get(heard, net::kDestDevid);
      if (dest == own(moment).devid && get(heard, net::kDestPid) == own(moment).pid) {
        const bool unacked = reliable == 1 && heard.bytes[net::kAppId] == faults.unacked;
        if (faults.unreliable && reliable == 0) reliable = 1;
        if (unacked) reliable = 0;
      }
      const bool broadcast = dest == machine::kBroadcastDevid && moment.is(Role::kMote);
      if (faults.broadcasts && broadcast && reliable == 1) {
        put(heard, net::kDestDevid, own(moment).devid);
      }
      moment.honest(machine::Heard{heard.frame});
    } else {
      moment.honest();
    }
    if (!faults.next_number) return;
    moment.rewrite([&](const Action& action) {
      if (action.what != Action::What::kTransmit) return moment.keep(action);
      Transmit sent = moment.sent(action);
      if (is_ack(sent) && get(sent, net::kSrcDevid) == own(moment).devid) {
        put(sent, net::kPaperSeq, get(sent, net::kPaperSeq) + 1U);
      }
      moment.keep(action, sent);
    });
  };
  return [=]() -> Step { return step; };
}

// Faults that prove themselves are all broken, although acks of one look like acks of the other. Of
// one fault only its own rules are, although it makes lines of others fail.
TEST(Mutants, IndependentFaultsAreAllBroken) {
  using Rules = std::set<std::string>;
  constexpr auto kMockup = static_cast<std::uint8_t>(rubicon::Component::kMockup);
  const struct {
    AckFaults faults;
    Rules broken;
  } rows[] = {
      {{.unreliable = true}, {"T2-UNRELIABLE"}},
      {{.unacked = component::kControlLayer}, {"T2-ACK"}},
      {{.next_number = true}, {"T2-ACK", "T2-CONTENT"}},  // The message has no ack of its own.
      {{.unreliable = true, .broadcasts = true}, {"T2-UNRELIABLE", "T2-BROADCAST"}},
      {{.unreliable = true, .broadcasts = true, .unacked = component::kControlLayer},
       {"T2-UNRELIABLE", "T2-BROADCAST", "T2-ACK"}},
      {{.unacked = kMockup, .next_number = true}, {"T2-ACK", "T2-CONTENT"}},
      {{.unreliable = true, .unacked = kMockup, .next_number = true},
       {"T2-UNRELIABLE", "T2-ACK", "T2-CONTENT"}},
  };
  for (const auto& row : rows) {
    suite::ImplementationRun run = whole_suite(wrapped(acking_wrongly(row.faults)));
    suite::find_causes(run);
    Rules broken;
    std::size_t suspected = 0;
    for (const suite::RequirementSummary& rule : suite::by_requirement(run)) {
      if (rule.broken > 0) broken.emplace(trace::requirement_text(rule.requirement));
      suspected += rule.broken == 0 && rule.suspected > 0;
    }
    EXPECT_EQ(broken, row.broken);
    EXPECT_GT(suspected, 3U) << "or nothing of others fails";
  }
}

TEST(Mutants, WhatIsDeliveredTwiceWasNotLostFromAFullBuffer) {
  const auto twice = std::ranges::find(named().mutants, "delivered_twice", &Mutant::name);
  ASSERT_NE(twice, named().mutants.end());
  suite::ImplementationRun run = whole_suite(twice->factory());
  suite::find_causes(run);
  std::map<std::string, std::size_t> broken;
  for (const suite::RequirementSummary& rule : suite::by_requirement(run)) {
    broken.emplace(trace::requirement_text(rule.requirement), rule.broken);
  }
  EXPECT_GT(broken["N2-IN-ORDER"], 0U);
  EXPECT_EQ(broken["N2-IN-FULL"], 0U);
}

// Makes a wrapper that acks what must not be acked, 800 ticks after it came by its line.
StepMaker acking_late(bool (*which)(const Forged&)) {
  return [=]() -> Step {
    return [=](Moment& moment) {
      const Frame* const frame = moment.heard(am::kNet);
      Forged* const forged = frame == nullptr ? nullptr : &moment.forge(*frame);
      if (forged == nullptr || !which(*forged)) return moment.honest();
      forged->bytes[net::kReliable] = 1;
      const bool sink = moment.is(Role::kSink);
      put(*forged, net::kDestDevid, sink ? own(moment).devid : machine::kNullDevid);
      moment.honest(machine::Heard{forged->frame});
      moment.rewrite([&](const Action& action) { moment.hold(action, 800); });
    };
  };
}

// The number tells which message it answers, also where the next one has come.
TEST(Mutants, AnAckThatComesLateIsBlamedForItsMessage) {
  const auto blamed = [](const CaseRef& ref, const StepMaker& step) {
    std::set<std::string> out;
    for (const runner::Failure& failure : run(ref, wrapped(step)).failures) {
      out.insert(failure.requirements.begin(), failure.requirements.end());
    }
    return out;
  };
  using Rules = std::set<std::string>;
  int tried = 0;
  for (const CaseRef& ref : golden().cases()) {
    if (ref.one->name != "t2.sink_line" && ref.one->name != "t2.base_station_line") continue;
    ++tried;
    EXPECT_EQ(blamed(ref, acking_late([](const Forged& heard) {
                       return heard.bytes[net::kReliable] == 0;
                     })),
              Rules{"T2-UNRELIABLE"});
    EXPECT_EQ(blamed(ref, acking_late([](const Forged& heard) {
                       return get(heard, net::kDestDevid) == machine::kBroadcastDevid;
                     })),
              Rules{"T2-BROADCAST"});
  }
  EXPECT_EQ(tried, 2);
}

// The nearest miss of a failure has the message that was expected, and is in its window.
TEST(Mutants, NearestHintsAreOfTheMessageAndInItsWindow) {
  const std::regex nearest(R"(^nearest, at (\d+): \S+ (\w+)\()");
  std::size_t hints = 0;
  for (const Hunted* all : {&named(), &generated()}) {
    for (std::size_t i = 0; i < all->mutants.size(); ++i) {
      const auto ref =
          std::find_if(golden().cases().begin(), golden().cases().end(),
                       [&](const CaseRef& one) { return one.one->name == all->found[i].by; });
      if (ref == golden().cases().end()) continue;
      for (const runner::Failure& failure : run(*ref, all->mutants[i].factory()).failures) {
        std::smatch hint;
        if (!std::regex_search(failure.text, hint, nearest)) continue;
        ++hints;
        const std::uint64_t at = std::stoull(hint[1]);
        EXPECT_TRUE(failure.from <= at && at <= failure.to)
            << all->mutants[i].name << ": " << failure.text;
        EXPECT_TRUE(std::regex_search(failure.expected, std::regex("\\b" + hint[2].str() + "\\(")))
            << all->mutants[i].name << ": " << failure.expected << ", but " << failure.text;
      }
    }
  }
  EXPECT_GT(hints, 300U);
}

TEST(Mutants, NamesAreUnique) {
  std::set<std::string> names;
  for (const Mutant& mutant : named().mutants) {
    EXPECT_TRUE(names.insert(mutant.name).second) << mutant.name;
    EXPECT_FALSE(mutant.requirements.empty()) << mutant.name;
    EXPECT_TRUE(mutant.breaks.ends_with('.')) << mutant.name;
  }
}

// Every MUST of the behaviour has its mutant.
TEST(Mutants, EveryRuleIsBroken) {
  std::set<ReqId, reflect::CatalogueOrder> broken;
  for (const Mutant& mutant : named().mutants) {
    broken.insert(mutant.requirements.begin(), mutant.requirements.end());
  }
  for (const reflect::Requirement& rule : reflect::requirements().subspan(1)) {
    const bool behaviour = std::strncmp(rule.id, "WIRE-", 5) != 0;
    if (!behaviour) continue;
    EXPECT_TRUE(broken.contains(rule.number())) << rule.id;
  }
}

TEST(Mutants, EverySurvivorIsAMutant) {
  std::set<std::string_view> used;
  for (const Hunted* all : {&named(), &generated()}) {
    for (const Mutant& mutant : all->mutants) {
      if (const auto* listed = find_survivor(mutant.name)) used.insert(listed->name);
    }
  }
  for (const Survivor& one : survivors()) EXPECT_TRUE(used.contains(one.name)) << one.name;
}

TEST(Mutants, Score) {
  std::size_t killed = 0;
  std::size_t equivalent = 0;
  std::size_t not_judged = 0;
  for (const Hunted* all : {&named(), &generated()}) {
    for (std::size_t i = 0; i < all->mutants.size(); ++i) {
      killed += all->found[i].killed;
      const Survivor* const listed = find_survivor(all->mutants[i].name);
      if (listed != nullptr) ++(listed->equivalent ? equivalent : not_judged);
    }
  }
  const std::size_t count = named().mutants.size() + generated().mutants.size();
  std::printf("mutants: %zu named, %zu generated; killed %zu; equivalent %zu; not judged %zu\n",
              named().mutants.size(), generated().mutants.size(), killed, equivalent, not_judged);
  for (const std::string& rule : never_accepted(golden())) {
    std::printf("not turned into acceptance: %s\n", rule.c_str());
  }
  EXPECT_EQ(killed + equivalent + not_judged, count);
  EXPECT_EQ(count, readme_number("# mutants"));
  EXPECT_EQ(named().mutants.size(), readme_number("# made by hand"));
  EXPECT_EQ(generated().mutants.size(), readme_number("by hand, # by rule"));
  EXPECT_EQ(killed, readme_number("they find #"));
  EXPECT_EQ(equivalent, readme_number("# are equivalent"));
  EXPECT_EQ(not_judged, readme_number("# are not judged"));
}

}  // namespace
}  // namespace rubric::mutants
