// `rubric test` and `rubric check` agree about every run, in both directions.
//
// Each run of the suite goes through the judge as its log, which is whole (decision 24), and as a
// capture, once with nothing known of the recorder and once with the truth: it began with the node
// and missed nothing.
// - A run that the suite finds in order is not blamed: no lawful variant, no shipped
//   implementation; and a mutant only if the suite fails it in some case, since a case looks at
//   what it is about.
// - What an application asked for and what left in its place is before the eyes of both in a log:
//   such a run is not in order for the judge either (T1-WRAP, S2-CONTENT).
// - A frame that must not be on a link, by a line that fails, is before the eyes of both. The judge
//   may blame the node for it, by whatever rule, or say what it cannot know; it may not call the
//   rule of that line kept and leave the run in order.
// - A frame or an event that the suite misses the judge of the log misses as well, or it says what
//   it cannot know.
// Of forbidden frames both must know the same: a line with a variable may speak of what an
// application was told, and only a net_msg can break a rule of messages (N, S, T), however wide the
// line is. A judge sees what comes from outside of a node alone if the node's own address is not
// borrowed: of a run in which the case itself sends from that address only the log is judged.
//
// RUBRIC_ALL_RUNS tries each named mutant and each shipped implementation in each case, and
// RUBRIC_GENERATED_SECONDS the generated mutants; else chance chooses some, by RUBRIC_SEED.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <unordered_map>
#include <vector>

#include "codec/reflect/requirements.h"
#include "conformance/check/input/read.h"
#include "conformance/check/observation.h"
#include "conformance/selftest/mutants/fields.h"
#include "conformance/selftest/mutants/hunt.h"
#include "conformance/test/report/case_files.h"
#include "conformance/test/suite/cases.h"
#include "conformance/test/suite/run.h"
#include "conformance/test/suite/tests/testing.h"
#include "conformance/test/targets/attachment.h"
#include "conformance/trace/headers.h"

namespace rubric::mutants {
namespace {

using check::Severity;
using runner::CaseVerdict;

// One in so many is tried, of the cases that are not about a mutant's rules, of those in which the
// machine keeps one of them nevertheless, of all for implementations that ship, which are slow, and
// of those in which a generated mutant differs from the machine.
constexpr unsigned kEvery = 40;
constexpr unsigned kEveryShown = 4;
constexpr unsigned kEveryShipped = 8;
constexpr unsigned kEveryGenerated = 24;
const suite::Cases& cases() {
  static const suite::Cases own = suite::Cases::own();
  return own;
}

const Golden& golden() {
  static const Golden own("conformance/cases");
  return own;
}

std::string_view id_of(ReqId rule) { return reflect::requirement(rule).id; }

/// One recording of a run, and what its user knows.
struct Recording {
  std::string name;
  std::string bytes;
  check::Options options;
};

// Returns the options for a capture; none if the case itself sends from an address under test.
std::optional<check::Options> options_of(const suite::CaseRun& run,
                                         const trace::Statement& stated) {
  check::Options out{.deployed = run.profile == "deployed", .stated = stated};
  trace::Scope scope{.nodes = run.nodes, .links = run.links};
  std::set<std::uint16_t> own;
  bool host = false;
  for (const trace::NodeHeader& node : run.nodes) {
    if (node.iut && node.id) own.insert(*node.id);
    if (node.iut) out.stated = joined(std::move(out.stated), node.stated);
    host = host || (node.iut && node.role == trace::Role::kBaseStation);
  }
  // On a serial line AM sources say nothing: at its other end is the host, or the sink.
  if (!host) out.testers.push_back(0);
  if (host && !own.contains(machine::Profile{}.sink_id)) {
    out.testers.push_back(machine::Profile{}.sink_id);
  }
  const trace::Case log = run.result.log.read();
  for (const trace::Line* line : log.lines()) {
    trace::AmFrame frame;
    if (line->op == trace::Op::kEmits || !line->bytes) continue;
    if (scope.link(line->link) != trace::LinkKind::kRadio) continue;
    if (!trace::parse_packet(*line->bytes, frame)) continue;
    if (own.contains(frame.src)) return std::nullopt;
    out.testers.push_back(frame.src);
  }
  return out;
}

std::vector<Recording> recordings(const suite::CaseRun& run, const trace::Statement& stated) {
  check::Options plain{.deployed = run.profile == "deployed"};
  std::vector<Recording> out{{"log", suite::case_rtr(run), plain}};
  if (const auto options = options_of(run, stated)) {
    out.push_back({"capture", suite::case_pcapng(run), *options});
    if (out.back().bytes.empty()) out.pop_back();
  }
  if (out.size() > 1) {
    out.push_back(out.back());
    out.back().name = "whole capture";
    out.back().options.sniffer_complete = out.back().options.start_cold = true;
  }
  return out;
}

/// What the tests ask of a judgement.
struct Judgement {
  bool read = false;  ///< Else the judge refuses it: a node used a link that it does not have.
  bool passes = false;
  std::string blame;         ///< The first failure, as text, or that it cannot be read.
  std::vector<ReqId> kept;   ///< Rules that were exercised.
  std::vector<ReqId> named;  ///< By findings that are more than notes.
};

Judgement judged_anew(const suite::CaseRun& run, const Recording& recording) {
  check::RunReader reader;
  std::string error;
  Judgement out{.read = reader.add_bytes(run.name, recording.bytes, error)};
  if (!out.read) {
    out.blame = "it cannot be read";
    return out;
  }
  const check::Report report = check::judge(reader.finish(), recording.options);
  out.passes = report.verdict == check::Verdict::kPass;
  for (const check::Finding& finding : report.findings) {
    if (finding.severity != Severity::kNote) out.named.push_back(finding.requirement);
    if (finding.severity == Severity::kFail && out.blame.empty()) {
      out.blame = std::string(id_of(finding.requirement)) + ' ' + finding.text;
    }
  }
  for (const auto& [rule, times] : report.exercised) out.kept.push_back(rule);
  return out;
}

// Most variants and mutants do in most cases what the machine does: what was judged is remembered,
// with all that `recordings` chooses.
const Judgement& judged(const suite::CaseRun& run, const Recording& recording) {
  static std::unordered_map<std::size_t, Judgement> known;
  const check::Options& options = recording.options;
  std::string key = fmt::format("{} {} {} {} {} {} {}\n", run.name, recording.name,
                                options.deployed, options.sniffer_complete, options.start_cold,
                                statement_text(options.stated), fmt::join(options.testers, ","));
  const auto [at, fresh] = known.try_emplace(std::hash<std::string>()(key + recording.bytes));
  if (fresh) at->second = judged_anew(run, recording);
  return at->second;
}

bool in_order(const suite::CaseRun& run) {
  return run.result.verdict == CaseVerdict::kPass || run.result.verdict == CaseVerdict::kWeak;
}

// Returns the rules of lines that forbid a frame which came on a link that a recorder hears.
std::set<std::string> forbidden_frames(const suite::CaseRun& run) {
  trace::Scope scope{.nodes = run.nodes, .links = run.links};
  std::set<std::string> out;
  // Where an expected frame is missing, what came instead may be wrong only for this case.
  if (std::ranges::any_of(run.result.failures, [](const auto& one) { return !one.forbidden; })) {
    return out;
  }
  for (const runner::Failure& failure : run.result.failures) {
    if (!failure.forbidden || failure.weak || failure.implied || failure.crash) continue;
    if (failure.requirements.empty() || failure.expected.find('$') != std::string::npos) continue;
    const std::string& rule = failure.requirements.front();
    const bool of_messages = std::string_view("NST").find(rule.front()) != std::string_view::npos;
    std::size_t frames = 0;  // Any of those at that moment may be the forbidden one.
    std::size_t messages = 0;
    const trace::Case log = run.result.log.read();
    for (const trace::Line* line : log.lines()) {
      const trace::LinkKind kind = scope.link(line->link).value_or(trace::LinkKind::kAny);
      const bool heard = kind == trace::LinkKind::kRadio || kind == trace::LinkKind::kSerial;
      const bool its = line->op == trace::Op::kEmits && line->node == failure.node &&
                       line->time.from == failure.time;
      trace::AmFrame frame;
      if (!its || !heard || !line->bytes || !trace::parse_packet(*line->bytes, frame)) continue;
      ++frames;
      messages += frame.type == am::kNet ? 1 : 0;
    }
    if (frames > 0 && (frames == messages || !of_messages)) out.insert(rule);
  }
  return out;
}

// Expects that the judge does not call these rules kept and the run in order.
void expect_seen(const std::string& who, const suite::CaseRun& run, const Recording& recording,
                 const Judgement& judgement) {
  // A log says itself who sends a frame: no rule is about its AM source.
  if (!judgement.blame.empty() || who.find("am.src") != std::string::npos) return;
  for (const std::string& rule : forbidden_frames(run)) {
    EXPECT_TRUE(!judgement.named.empty() ||
                std::ranges::find(judgement.kept, rule, id_of) == judgement.kept.end())
        << who << ", " << run.name << " as " << recording.name << ": the suite blames " << rule
        << ", the judge has it kept";
  }
}

// Returns whether the suite misses a frame as an application asked for it, which another came for.
bool lacks_what_was_asked(const suite::CaseRun& run) {
  const runner::Failure& first = run.result.failures.front();
  const bool named = !first.requirements.empty() && (first.requirements.front() == "T1-WRAP" ||
                                                     first.requirements.front() == "S2-CONTENT");
  return named && !first.forbidden && !first.weak && !first.crash;
}

// Returns whether the suite misses a frame or an event first.
bool lacks_something(const suite::CaseRun& run) {
  const runner::Failure& first = run.result.failures.front();
  if (first.forbidden || first.weak || first.crash || first.requirements.empty()) return false;
  std::istringstream words(first.expected);
  std::string word;
  while (words >> word && word != ">") {
  }
  std::string link;
  std::string message;
  words >> link >> message;
  const std::string name = message.substr(0, message.find('('));
  static const std::set<std::string> kEvents{"received", "joined", "mote_joined", "ack_received",
                                             "syn_data"};
  return link != "app" || kEvents.contains(name);
}

struct Opinions {
  std::size_t runs = 0;
  std::size_t failed = 0;   ///< Or weak.
  std::string blamed;       ///< Where the judge alone blames.
  std::size_t asked = 0;    ///< Lack what an application asked for.
  std::size_t missing = 0;  ///< Lack a frame or an event.
  /// Those of these that the judge neither finds nor says that it cannot know.
  std::vector<std::string> untold;
};

// Returns the rules that the judge of the log names.
std::vector<ReqId> compare(const std::string& who, const suite::CaseRun& run,
                           const trace::Statement& stated, Opinions& out) {
  const bool fails = run.result.verdict == CaseVerdict::kFail;
  if (!fails && !in_order(run)) return {};
  std::vector<ReqId> named;
  ++out.runs;
  out.failed += run.result.verdict == CaseVerdict::kPass ? 0 : 1;
  for (const Recording& recording : recordings(run, stated)) {
    const Judgement& judgement = judged(run, recording);
    const std::string& blame = judgement.blame;
    const bool log = recording.name == "log";
    if (log) named = judgement.named;
    if (fails) {
      if (judgement.read && (log || recording.options.start_cold)) {
        expect_seen(who, run, recording, judgement);
      }
      const bool asked = log && lacks_what_was_asked(run);
      const bool missing = log && lacks_something(run);
      out.asked += asked ? 1 : 0;
      out.missing += missing ? 1 : 0;
      // Of a run in which it could judge nothing it says so.
      const bool told = judgement.read && (!judgement.passes || judgement.kept.empty());
      if ((asked && blame.empty()) || (missing && !told)) {
        out.untold.push_back(who + ", " + run.name + ": " + run.result.failures.front().expected);
      }
    } else if (!blame.empty() && out.blamed.empty()) {
      out.blamed = who + ", " + run.name + " as " + recording.name + ": " + blame;
    }
  }
  return named;
}

suite::testing::FakeAttachment attached(const StepMaker& step, const trace::Statement& stated) {
  suite::testing::FakeAttachment out;
  out.who.stated = stated;
  out.make = [step] { return std::make_unique<runner::SubjectTarget>(wrapped(step)()); };
  return out;
}

suite::CaseRun run_one(const suite::SuiteCase& one, targets::Attachment& attachment) {
  return suite::run_one(one, attachment, "", std::nullopt);
}

void expect_conforms(const LawfulVariant& variant) {
  suite::testing::FakeAttachment attachment = attached(variant.step, variant.stated);
  Opinions all;
  for (const suite::SuiteCase& one : cases().all()) {
    compare(variant.name, run_one(one, attachment), variant.stated, all);
  }
  EXPECT_EQ(all.blamed, "");
  EXPECT_TRUE(all.failed == 0 || variant.weak) << variant.name;
  EXPECT_GT(all.runs, cases().all().size() * 9 / 10);
}

TEST(TwoTools, NoRunOfALawfulVariantIsBlamed) {
  for (const auto& variants : {lawful_variants(), stated_variants()}) {
    for (const LawfulVariant& variant : variants) expect_conforms(variant);
  }
}

/// Chooses cases: one in so many, or all.
class Chance {
 public:
  explicit Chance(bool all = std::getenv("RUBRIC_ALL_RUNS") != nullptr) : all_(all) {}
  bool takes_all() const { return all_; }
  bool takes(unsigned every) { return all_ || random_() % every == 0; }

  /// Returns what chance begins with.
  static std::minstd_rand random() { return std::minstd_rand{seed()}; }

 private:
  static std::uint32_t seed() {
    const char* const asked = std::getenv("RUBRIC_SEED");
    return asked == nullptr ? 1 : static_cast<std::uint32_t>(std::strtoul(asked, nullptr, 10));
  }

  const bool all_;
  std::minstd_rand random_ = random();
};

TEST(TwoTools, NoRunWithBackOffIsBlamed) {
  const std::uint32_t seeds = Chance().takes_all() ? 10 : 3;
  for (std::uint32_t seed = 0; seed < seeds; ++seed) {
    expect_conforms(
        {"back_off", "", backing_off(seed, 10), false, {{trace::ParameterId::kChannelAccess, 30}}});
  }
}

TEST(TwoTools, NoRunOfAShippedImplementationIsBlamed) {
  for (const char* const target : {RUBRIC_SHIPPED}) {
    const auto attachment = targets::attach(target, {});
    Chance chance;
    Opinions all;
    for (const suite::SuiteCase& one : cases().all()) {
      if (!chance.takes(kEveryShipped)) continue;
      // An hour of the simulated processor takes half a minute.
      if (!chance.takes_all() && one.one->name.ends_with("_hour")) continue;
      compare(target, run_one(one, *attachment), attachment->identity().stated, all);
    }
    attachment->finish();
    EXPECT_EQ(all.blamed, "");
    EXPECT_GT(all.runs, 10U) << target;
    std::printf("%zu runs, %zu of which fail or are weak: %s\n", all.runs, all.failed, target);
  }
}

bool about(const suite::SuiteCase& one, const Mutant& mutant) {
  const std::vector<std::string> rules = one.rules();
  return std::ranges::any_of(mutant.requirements, [&](ReqId rule) {
    return std::ranges::find(rules, id_of(rule)) != rules.end();
  });
}

// Returns whether the machine does or tells something by one of the mutant's rules there.
bool shows(const suite::SuiteCase& one, const Mutant& mutant) {
  const std::set<std::string>& kinds = golden().kinds(one.one->name);
  return std::ranges::any_of(mutant.requirements, [&](ReqId rule) {
    const std::string word = ' ' + std::string(id_of(rule)) + ' ';
    return std::ranges::any_of(
        kinds, [&](const std::string& kind) { return kind.find(word) != std::string::npos; });
  });
}

// Returns the rules in the first column of the table below a heading of the checker's page.
std::set<std::string> listed_below(const std::string& heading) {
  std::ifstream page("conformance/check/README.md");
  std::set<std::string> out;
  std::string line;
  while (std::getline(page, line) && line != heading) {
  }
  for (bool table = false; std::getline(page, line) && !(table && line.empty());) {
    if (!line.starts_with("| ")) continue;
    table = true;
    std::istringstream cell(line.substr(2, line.find(" |") - 2));
    for (std::string rule; cell >> rule;) out.insert(rule.substr(0, rule.find(',')));
  }
  out.erase("rule");
  return out;
}

using Clock = std::chrono::steady_clock;

struct Tried {
  std::size_t mutants = 0;      ///< For so many there was time.
  std::set<std::string> named;  ///< By the judge of the logs of the cases that are about them.
};

// Tries each of them in the cases that are about it, and in some others.
Tried expect_same(const Mutants& mutants, Chance& chance, unsigned every, std::size_t at_least,
                  Clock::time_point end = Clock::time_point::max()) {
  Tried tried;
  std::size_t runs = 0;
  std::size_t failed = 0;
  std::size_t asked = 0;
  std::size_t missing = 0;
  std::vector<std::string> untold;
  for (const Mutant& mutant : mutants) {
    if (Clock::now() >= end) break;
    ++tried.mutants;
    suite::testing::FakeAttachment attachment = attached(mutant.step, {});
    Opinions all;
    for (const suite::SuiteCase& one : cases().all()) {
      if (!golden().acts(mutant, one.one->name)) continue;
      const bool its = about(one, mutant);
      const bool likely = its || (shows(one, mutant) && chance.takes(kEveryShown));
      if (!likely && !chance.takes(every)) continue;
      for (const ReqId rule : compare(mutant.name, run_one(one, attachment), {}, all)) {
        if (its) tried.named.emplace(id_of(rule));
      }
    }
    for (const suite::SuiteCase& one : cases().all()) {
      if (all.blamed.empty() || all.failed > 0) break;
      const CaseVerdict verdict = run_one(one, attachment).result.verdict;
      all.failed += verdict == CaseVerdict::kFail || verdict == CaseVerdict::kWeak ? 1 : 0;
    }
    // A sink may count old bytes behind its data (N6-CONTENT), so that no line can say what the
    // data of its own message on the serial line are; a log shows the call.
    const bool unsayable = mutant.name.ends_with("N6-OWN net_msg by serial: payload.payload");
    EXPECT_TRUE(all.blamed.empty() || all.failed > 0 || unsayable)
        << all.blamed << "; no case fails it";
    runs += all.runs;
    failed += all.failed;
    asked += all.asked;
    missing += all.missing;
    // A log says itself who sends a frame: no rule is about its AM source. A sink that counts old
    // bytes behind whole floats is free to (N6-CONTENT), but no line can say that.
    if (mutant.name.find("am.src") != std::string::npos ||
        mutant.name.find("synaptic_data by serial: nbytes") != std::string::npos) {
      continue;
    }
    untold.insert(untold.end(), all.untold.begin(), all.untold.end());
  }
  std::printf(
      "runs of mutants: %zu, of which the suite fails %zu, %zu for what was asked for and %zu for "
      "what is missing\n",
      runs, failed, asked, missing);
  EXPECT_GT(failed, at_least);
  for (const std::string& one : untold) ADD_FAILURE() << "the log is in order: " << one;
  return tried;
}

// A rule that the judge never names is no use to whom it should tell of a broken node.
void expect_listed(std::set<std::string> named) {
  std::ifstream logs("conformance/check/tests/testdata/whole_logs.txt");
  for (std::string line; std::getline(logs, line);) {
    if (!line.starts_with("== ")) continue;
    std::istringstream rules(line.substr(3, line.find(':') - 3));
    for (std::string rule; rules >> rule;) named.insert(rule);
  }
  std::set<std::string> never;
  for (const reflect::Requirement& rule : reflect::requirements()) {
    if (rule.roles != 0 && !named.contains(rule.id)) never.insert(rule.id);
  }
  EXPECT_EQ(never, listed_below("### Rules that are never named"));
}

TEST(TwoTools, NoRunOfAMutantIsJudgedOtherwiseAndEachRuleIsNamedOrListed) {
  Chance chance;
  std::set<std::string> named = expect_same(named_mutants(), chance, kEvery, 1000).named;
  // Where a mutant does not act, its log is the machine's.
  suite::testing::FakeAttachment machine;
  Opinions all;
  for (const suite::SuiteCase& one : cases().all()) {
    for (const ReqId rule : compare("machine", run_one(one, machine), {}, all)) {
      named.emplace(id_of(rule));
    }
  }
  EXPECT_EQ(all.blamed, "");
  expect_listed(std::move(named));
}

// RUBRIC_GENERATED_SECONDS tries all of them in all cases, in an order that RUBRIC_SEED chooses, as
// far as that time goes.
TEST(TwoTools, NoRunOfAGeneratedMutantIsJudgedOtherwise) {
  Mutants all = generated_mutants(golden());
  if (const char* const seconds = std::getenv("RUBRIC_GENERATED_SECONDS")) {
    Chance every(true);
    std::ranges::shuffle(all, Chance::random());
    const auto end = Clock::now() + std::chrono::seconds(std::atoi(seconds));
    const std::size_t tried = expect_same(all, every, 1, 10, end).mutants;
    std::printf("%zu of %zu generated mutants\n", tried, all.size());
    return;
  }
  Chance chance(false);
  expect_same(all, chance, kEveryGenerated, 10);
}

}  // namespace
}  // namespace rubric::mutants
