// Prompt, slow, bursty and late-starting nodes behind each kind of live target: those that keep the
// rules pass, and those that ack too much fail by the rules that they break, at whatever pace.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>
#include <set>
#include <thread>

#include "conformance/test/runner/case_files.h"
#include "conformance/test/runner/run_case.h"
#include "conformance/test/targets/attachment.h"
#include "conformance/test/targets/line_testing.h"
#include "conformance/test/targets/overacking.h"

namespace rubric::targets {
namespace {

using runner::CaseResult;
using runner::CaseVerdict;
using Rules = std::set<std::string>;

const Options kPatient{lines::Milliseconds(5000), lines::Milliseconds(20000)};

struct NamedPace {
  const char* name;
  Pace pace;
};
const NamedPace kLawfulPaces[] = {
    {"prompt", {}},
    {"slow", {230, 0, {}}},    // Of 300 ticks.
    {"bursty", {0, 200, {}}},  // Together, after up to 200 ticks.
    {"late", {0, 0, lines::Milliseconds(700)}},
};
const NamedPace kOverackingPaces[] = {
    {"prompt", {}},
    {"within 50 ms", {40, 0, {}}},
    {"after 0.1 s", {102, 0, {}}},
    {"slow", {230, 0, {}}},
    {"bursty", {0, 200, {}}},
    {"late", {0, 0, lines::Milliseconds(700)}},
};

const std::vector<trace::Parsed>& case_files() {
  static const std::vector<trace::Parsed> files = runner::load_cases("conformance/cases");
  return files;
}

// Runs a case. On a busy host the kit's own times may be too unsure to decide it: then once more.
CaseResult run(Attachment& attachment, const std::string& name) {
  CaseResult result;
  for (const trace::Parsed& file : case_files()) {
    const trace::Case* const one = file.file.find(name);
    for (int tries = 0; one && tries < 3; ++tries) {
      result = runner::run_case(file.file, *one,
                                [&](const trace::NodeHeader&) { return attachment.target(); });
      if (result.verdict != CaseVerdict::kInconclusive) return result;
    }
  }
  return result;
}

std::unique_ptr<runner::Subject> subject_of(bool overacks) {
  if (overacks) return std::make_unique<Overacking>();
  return std::make_unique<runner::Machine>();
}

struct Expected {
  std::string name;
  Rules broken;  // None: it passes.
};

// A node behind a target, and the cases to run on it, in a thread of its own.
struct Attempt {
  std::string what;
  std::vector<Expected> cases;
  std::function<std::vector<CaseResult>(const std::vector<Expected>&)> run;
  std::vector<CaseResult> results = {};
};

std::vector<CaseResult> run_all(Attachment& attachment, const std::vector<Expected>& cases) {
  std::vector<CaseResult> out;
  for (const Expected& one : cases) out.push_back(run(attachment, one.name));
  return out;
}

void try_all(std::vector<Attempt> attempts) {
  case_files();
  tolerance_of_this_host();
  std::vector<std::thread> threads;
  for (Attempt& one : attempts) threads.emplace_back([&one] { one.results = one.run(one.cases); });
  for (std::thread& one : threads) one.join();
  for (const Attempt& attempt : attempts) {
    if (attempt.results.empty()) std::printf("%s: not decided\n", attempt.what.c_str());
    if (attempt.results.empty()) continue;
    for (std::size_t i = 0; i < attempt.cases.size(); ++i) {
      const CaseResult& result = attempt.results[i];
      Rules broken;
      for (const runner::Failure& one : result.failures) {
        broken.insert(one.requirements.begin(), one.requirements.end());
      }
      const Rules& expected = attempt.cases[i].broken;
      EXPECT_EQ(broken, expected) << attempt.what << ", " << attempt.cases[i].name << ": "
                                  << result.reason << '\n'
                                  << runner::explain(result, "cases");
      EXPECT_EQ(runner::verdict_text(result.verdict), expected.empty() ? "pass" : "fail")
          << attempt.what << ", " << attempt.cases[i].name << ": " << result.reason;
    }
  }
}

std::vector<Expected> line_cases(const char* role, bool overacks) {
  if (!overacks) {
    return {{fmt::format("t2.{}_line", role), {}}, {fmt::format("t1.{}_line", role), {}}};
  }
  return {{fmt::format("t2.{}_line", role), {"T2-UNRELIABLE", "T2-BROADCAST", "T2-CONTENT"}},
          {fmt::format("t1.{}_line", role), {"T1-UNKNOWN"}}};
}

// Adds attempts of a kind of target, with all paces. `make` runs the cases with a node of a pace.
template <class Make>
void add(std::vector<Attempt>& attempts, const char* kind, const char* role, Make make) {
  for (const bool overacks : {false, true}) {
    const auto add_one = [&](const NamedPace& one) {
      attempts.push_back({fmt::format("{}, {}, {}", kind, one.name,
                                      overacks ? "acks too much" : "keeps the rules"),
                          line_cases(role, overacks),
                          [=, pace = one.pace](const std::vector<Expected>& cases) {
                            return make(cases, pace, overacks);
                          }});
    };
    if (overacks) {
      for (const NamedPace& one : kOverackingPaces) add_one(one);
    } else {
      for (const NamedPace& one : kLawfulPaces) add_one(one);
    }
  }
}

TEST(Live, BaseStations) {
  std::vector<Attempt> attempts;
  for (const char* restart : {"", ":restart"}) {
    add(attempts, *restart ? "sf-server, restarted" : "sf-server", "base_station",
        [=](const std::vector<Expected>& cases, const Pace& pace, bool overacks) {
          const std::uint16_t port = free_port();
          const auto attachment = attach(fmt::format("sf-server:{}{}", port, restart), kPatient);
          const RealNode station(forwarder_to(port), config_of(machine::Role::kBaseStation, 11),
                                 subject_of(overacks), pace);
          std::vector<CaseResult> out = run_all(*attachment, cases);
          attachment->finish();
          EXPECT_EQ(attachment->take_mishaps().size(), 0U);
          return out;
        });
  }
  try_all(std::move(attempts));
}

TEST(Live, Sinks) {
  std::vector<Attempt> attempts;
  const machine::Config config = config_of(machine::Role::kSink, 3);
  add(attempts, "sf", "sink",
      [=](const std::vector<Expected>& cases, const Pace& pace, bool overacks) {
        const std::uint16_t port = free_port();
        const RealNode sink(forwarder_at(port), config, subject_of(overacks), pace);
        return run_all(*attach(fmt::format("sf:127.0.0.1:{}", port), kPatient), cases);
      });
  add(attempts, "serial:tcp", "sink",
      [=](const std::vector<Expected>& cases, const Pace& pace, bool overacks) {
        const std::uint16_t port = free_port();
        const RealNode sink(mote_at(port), config, subject_of(overacks), pace);
        return run_all(*attach(fmt::format("serial:tcp:127.0.0.1:{}", port), kPatient), cases);
      });
  add(attempts, "serial device", "sink",
      [=](const std::vector<Expected>& cases, const Pace& pace, bool overacks) {
        for (int tries = 0; tries < 5; ++tries) {  // Again only if the terminals were at fault.
          const TerminalWatch watch;
          const Terminal terminal;
          const RealNode sink(terminal.mote_end(), config, subject_of(overacks), pace);
          std::vector<CaseResult> out =
              run_all(*attach(fmt::format("serial:{}:telosb", terminal.name()), kPatient), cases);
          if (watch.worst() < lines::Milliseconds(30)) return out;
        }
        // Undecided, where they always were.
        return std::vector<CaseResult>();
      });
  try_all(std::move(attempts));
}

std::string adapter(const Pace& pace, const char* flaw) {
  return fmt::format("{} {} {} {} {}", RUBRIC_LIVE_ADAPTER, pace.late, pace.burst,
                     pace.start.count(), flaw);
}

TEST(Live, AdaptersInRealTime) {
  std::vector<Attempt> attempts;
  for (const char* role : {"sink", "base_station"}) {
    add(attempts, role, role,
        [](const std::vector<Expected>& cases, const Pace& pace, bool overacks) {
          return run_all(*attach(adapter(pace, overacks ? "overacking" : "none"), kPatient), cases);
        });
  }
  for (const NamedPace& one : kLawfulPaces) {
    for (const bool wrong : {false, true}) {
      const std::vector<Expected> cases = {
          {"j4.wrong_seq", wrong ? Rules{"J4-SEQ", "J4-ACK"} : Rules{}}};
      attempts.push_back({fmt::format("mote, {}, {}", one.name, wrong), cases,
                          [=, pace = one.pace](const std::vector<Expected>& expected) {
                            const char* const flaw = wrong ? "accepts_wrong_seq" : "none";
                            return run_all(*attach(adapter(pace, flaw), kPatient), expected);
                          }});
    }
  }
  try_all(std::move(attempts));
}

// It may have told its sink the island before it came to us: its cases are judged, but the run says
// that N9-SET is open.
TEST(Live, BaseStationThatNeverTellsItsIsland) {
  class Silent : public runner::Machine {
   public:
    void step(machine::Ticks now, const machine::Event& event, machine::Actions& actions) override {
      if (std::holds_alternative<machine::Called>(event)) return actions.clear();
      Machine::step(now, event, actions);
    }
  };
  const std::uint16_t port = free_port();
  const auto attachment = attach(fmt::format("sf-server:{}", port), kPatient);
  const RealNode station(forwarder_to(port), config_of(machine::Role::kBaseStation, 11),
                         std::make_unique<Silent>());
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(run(*attachment, "t1.base_station_line").verdict, CaseVerdict::kPass);
  }
  attachment->finish();
  const std::vector<Mishap> mishaps = attachment->take_mishaps();
  ASSERT_EQ(mishaps.size(), 2U);
  EXPECT_EQ(mishaps[0].open, ReqId::kNone);
  EXPECT_EQ(mishaps[1].open, "N9-SET"_rule);
  EXPECT_EQ(mishaps[0].text,
            "did not tell its sink the island within 3 s after its line was opened");
  EXPECT_FALSE(mishaps[0].broke);
}

// Returns the cases of base stations alone, without those that last minutes.
std::vector<std::string> station_cases() {
  std::vector<std::string> out;
  for (const trace::Parsed& file : case_files()) {
    for (const trace::Case& one : file.file.cases) {
      std::vector<trace::Role> roles;
      for (const trace::NodeHeader& node : trace::scope_of(file.file, one).nodes) {
        if (node.iut) roles.push_back(node.role);
      }
      if (roles == std::vector{trace::Role::kBaseStation} && !one.name.starts_with("many.")) {
        out.push_back(one.name);
      }
    }
  }
  return out;
}

// Runs cases of a base station with its application, each in parallel to others.
std::vector<CaseResult> run_with_application(const std::vector<std::string>& names,
                                             const char* flaw) {
  constexpr std::size_t kAtOnce = 12;
  std::vector<CaseResult> out(names.size());
  std::vector<std::thread> threads;
  for (std::size_t first = 0; first < kAtOnce; ++first) {
    threads.emplace_back([&, first] {
      const std::uint16_t port = free_port();
      Options options = kPatient;
      options.app = fmt::format("{} {}", adapter({}, flaw), port);
      const auto attachment = attach(fmt::format("sf-server:{}:restart", port), options);
      for (std::size_t i = first; i < names.size(); i += kAtOnce) {
        out[i] = run(*attachment, names[i]);
      }
      // Before it is asked to end: on a busy host that takes longer than anybody waits.
      for (const Mishap& one : attachment->take_mishaps()) ADD_FAILURE() << one.text;
    });
  }
  for (std::thread& one : threads) one.join();
  return out;
}

// The program that shows its application and PEIS starts it anew for each case.
TEST(Live, BaseStationWithItsApplication) {
  const std::vector<std::string> names = station_cases();
  EXPECT_GE(names.size(), 25U);
  for (const CaseResult& result : run_with_application(names, "none")) {
    // This station calls no mote gone, and these cases are for one that states when. An hour is too
    // long for us.
    const bool not_built =
        result.name.starts_with("leaving.") || result.name == "narrow.base_station_hour";
    EXPECT_EQ(runner::verdict_text(result.verdict), not_built ? "skip" : "pass")
        << result.name << ": " << result.reason << runner::explain(result, "cases");
  }
  for (const CaseResult& result : run_with_application(
           {"t1.base_station_serial", "t2.base_station_serial", "t2.base_station_serial_broadcast"},
           "overacking")) {
    EXPECT_GT(result.failures.size(), 0U) << result.name << ": " << result.reason;
  }
}

}  // namespace
}  // namespace rubric::targets
