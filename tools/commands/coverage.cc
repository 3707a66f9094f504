#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "codec/reflect/requirements.h"
#include "codec/text/json.h"
#include "conformance/explore/search.h"
#include "conformance/selftest/mutants/hunt.h"
#include "conformance/test/suite/cases.h"
#include "conformance/trace/protocol.h"
#include "tools/cli/command.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/output.h"
#include "tools/cli/verdict.h"
#include "tools/commands/commands.h"
#include "tools/commands/protocol_folder.h"

namespace rubric::tools {
namespace {

using text::Json;

constexpr const char* kCoverage = "coverage";

std::size_t rule_count() { return reflect::requirements().size(); }

struct CoverageOptions {
  std::string cases;     ///< Empty: the kit's own, or those of the protocol.
  std::string protocol;  ///< A folder; empty: RUBICON.
  std::string format = "text";
};

// A test or tool that touches a rule.
struct Touch {
  std::set<std::string> positive;  // Golden traces.
  std::set<std::string> negative;
  std::uint64_t transitions = 0;  // Steps of the machine, in these traces.
  std::uint64_t ignores = 0;
  bool explored = false;
  std::size_t mutants = 0;  // Named ones that break it.
};

// What the machine, the explorer and the mutants show is counted for the machine's protocol only.
struct Coverage {
  bool has_machine = trace::protocol().has_machine;
  std::vector<Touch> rules{rule_count()};
  std::size_t cases = 0;
  std::vector<std::string> problems;
};

// Vectors cover the rules of the wire, which RUBICON's catalogue has apart.
bool is_wire(std::size_t i) {
  return trace::protocol().has_machine &&
         std::strncmp(reflect::requirements()[i].id, "WIRE-", 5) == 0;
}
bool is_must(std::size_t i) { return std::strcmp(reflect::requirements()[i].level, "MUST") == 0; }

void read_case(const std::string& file_name, const trace::Case& one, Coverage& coverage) {
  ++coverage.cases;
  for (const trace::Line* line : one.lines()) {
    for (const std::string& name : line->requirements) {
      const ReqId id = trace::requirement_id(name);
      if (id == ReqId::kNone) {
        coverage.problems.push_back(
            fmt::format("{}:{}: the catalogue has no rule {}", file_name, line->place.line, name));
        continue;
      }
      Touch& touch = coverage.rules[reflect::requirement_index(id)];
      (line->op == trace::Op::kMustNot ? touch.negative : touch.positive).insert(one.name);
    }
  }
}

void read_cases(const mutants::Golden& golden, Coverage& coverage) {
  for (const trace::Parsed& file : golden.files()) {
    for (const trace::Case& one : file.file.cases) read_case(file.file_name, one, coverage);
  }
  for (const mutants::CaseRef& ref : golden.broken()) {
    coverage.problems.push_back(ref.one->name + ": the machine does not pass it");
  }
}

void run_cases(const mutants::Golden& golden, Coverage& coverage) {
  mutants::watch(golden, [&](const machine::State&, machine::Ticks, const machine::Event&,
                             const machine::State&, const machine::Actions& actions) {
    for (const machine::Action& action : actions.all()) {
      Touch& touch = coverage.rules[reflect::requirement_index(action.requirement)];
      const bool ignored = action.what == machine::Action::What::kIgnored;
      ++(ignored ? touch.ignores : touch.transitions);
    }
  });
}

// The explorer takes a plain function, so its results are kept here.
std::vector<std::atomic<bool>>& explored_rules() {
  static std::vector<std::atomic<bool>> kept(rule_count());
  return kept;
}

void seen_step(machine::State& state, machine::Ticks now, const machine::Event& event,
               machine::Actions& actions) {
  machine::step(state, now, event, actions);
  for (const machine::Action& action : actions.all()) {
    explored_rules()[reflect::requirement_index(action.requirement)] = true;
  }
}

// Explores small networks: two sinks and a lossy air in join scope, messages between a mote and its
// sink.
void explore(Coverage& coverage) {
  explore::Options join{.step = seen_step, .sinks = 2};
  join.loss = join.dup = true;
  join.calls = 2;  // So that replies to the first meet the second.
  explore::Options full{.step = seen_step, .scope = explore::Scope::kFull, .loss = true};
  for (const explore::Options& options : {join, full}) {
    explore::Nodes nodes(options);
    explore::explore(nodes);
  }
  for (std::size_t i = 0; i < rule_count(); ++i) coverage.rules[i].explored = explored_rules()[i];
}

void judge(Coverage& coverage) {
  for (std::size_t i = 1; i < rule_count(); ++i) {
    if (is_wire(i)) continue;
    const reflect::Requirement& rule = reflect::requirements()[i];
    const Touch& touch = coverage.rules[i];
    if (is_must(i) && touch.positive.empty() && touch.negative.empty()) {
      coverage.problems.push_back(fmt::format("{} is a MUST without a case", rule.id));
    } else if (rule.forbids && touch.negative.empty()) {
      coverage.problems.push_back(fmt::format("{} forbids, but no case attempts it", rule.id));
    }
  }
}

mutants::Golden golden_of(const CoverageOptions& options) {
  if (!options.cases.empty()) return mutants::Golden(options.cases);
  std::vector<trace::Parsed> files;
  for (const suite::EmbeddedFile& one : suite::embedded_files()) {
    files.push_back(trace::parse(one.text, one.name));
  }
  return mutants::Golden(std::move(files));
}

// Reads the traces of a protocol that no machine plays.
Coverage read_protocol_cases(const std::vector<std::string>& traces) {
  Coverage coverage;
  const suite::Cases cases = suite::Cases::of(traces);
  for (const suite::SuiteCase& one : cases.all()) {
    read_case(one.file->file_name, one.whole(), coverage);
  }
  judge(coverage);
  return coverage;
}

Coverage measure(const CoverageOptions& options) {
  if (!options.protocol.empty()) {
    std::vector<std::string> traces;
    if (!options.cases.empty()) traces.push_back(options.cases);
    use_protocol(options.protocol, {}, traces);
    return read_protocol_cases(traces);
  }
  Coverage coverage;
  const mutants::Golden golden = golden_of(options);
  read_cases(golden, coverage);
  run_cases(golden, coverage);
  explore(coverage);
  for (const mutants::Mutant& mutant : mutants::named_mutants()) {
    for (const ReqId id : mutant.requirements) {
      ++coverage.rules[reflect::requirement_index(id)].mutants;
    }
  }
  judge(coverage);
  return coverage;
}

// Counts wire rules by level: those that are MUST, and the others.
std::map<std::string, std::size_t> wire_levels() {
  std::map<std::string, std::size_t> levels;
  for (std::size_t i = 1; i < rule_count(); ++i) {
    if (is_wire(i)) ++levels[reflect::requirements()[i].level];
  }
  return levels;
}

struct Totals {
  std::size_t rules = 0;
  std::size_t with_case = 0;
  std::size_t positive = 0;
  std::size_t negative = 0;
  std::size_t exercised = 0;
  std::size_t explored = 0;
  std::size_t mutated = 0;
};

Totals total(const Coverage& coverage) {
  Totals totals;
  for (std::size_t i = 1; i < rule_count(); ++i) {
    if (is_wire(i)) continue;
    const Touch& touch = coverage.rules[i];
    ++totals.rules;
    totals.with_case += !touch.positive.empty() || !touch.negative.empty();
    totals.positive += !touch.positive.empty();
    totals.negative += !touch.negative.empty();
    totals.exercised += touch.transitions + touch.ignores > 0;
    totals.explored += touch.explored;
    totals.mutated += touch.mutants > 0;
  }
  return totals;
}

std::string text_of(const Coverage& coverage) {
  std::size_t width = 13;
  for (std::size_t i = 1; i < rule_count(); ++i) {
    if (!is_wire(i)) width = std::max(width, std::strlen(reflect::requirements()[i].id));
  }
  std::string out = fmt::format("{:<{}} {:<8}{:>6}{:>6}", "rule", width, "level", "cases", "!>");
  if (coverage.has_machine) {
    out += fmt::format("{:>12}{:>9}  {:<10}{:>7}", "transitions", "ignores", "explored", "mutants");
  }
  out += '\n';
  for (std::size_t i = 1; i < rule_count(); ++i) {
    if (is_wire(i)) continue;
    const Touch& touch = coverage.rules[i];
    const reflect::Requirement& rule = reflect::requirements()[i];
    out += fmt::format("{:<{}} {:<8}{:>6}{:>6}", rule.id, width, rule.level, touch.positive.size(),
                       touch.negative.size());
    if (coverage.has_machine) {
      out += fmt::format("{:>12}{:>9}  {:<10}{:>7}", touch.transitions, touch.ignores,
                         touch.explored ? "yes" : "-", touch.mutants);
    }
    out += '\n';
  }
  const Totals totals = total(coverage);
  out += fmt::format(
      "{} rules of behaviour, {} golden traces: {} rules with a case ({} positive, {} negative)",
      totals.rules, coverage.cases, totals.with_case, totals.positive, totals.negative);
  if (coverage.has_machine) {
    out += fmt::format(", {} exercised on the machine, {} explored, {} with a named mutant",
                       totals.exercised, totals.explored, totals.mutated);
  }
  out += '\n';
  if (coverage.has_machine) {
    const std::map<std::string, std::size_t> levels = wire_levels();
    out += "rules of the wire, which spec/vectors cover:";
    for (const auto& [level, count] : levels) out += fmt::format(" {} {}", count, level);
    out += '\n';
  }
  for (const std::string& problem : coverage.problems) out += "problem: " + problem + '\n';
  return out;
}

std::string json_of(const Coverage& coverage) {
  // Without a machine its counts are null.
  const auto counted = [&](auto value) {
    return coverage.has_machine ? Json(value) : Json::raw("");
  };
  std::vector<Json> rules;
  for (std::size_t i = 1; i < rule_count(); ++i) {
    if (is_wire(i)) continue;
    const Touch& touch = coverage.rules[i];
    rules.push_back(Json::object({{"id", reflect::requirements()[i].id},
                                  {"level", reflect::requirements()[i].level},
                                  {"positive", touch.positive.size()},
                                  {"negative", touch.negative.size()},
                                  {"transitions", counted(touch.transitions)},
                                  {"ignores", counted(touch.ignores)},
                                  {"explored", counted(touch.explored)},
                                  {"mutants", counted(touch.mutants)}}));
  }
  const Totals totals = total(coverage);
  const std::map<std::string, std::size_t> levels = wire_levels();
  const Json out =
      Json::object({{"schema", "rubric.coverage/1"},
                    {"rules", Json::array(rules)},
                    {"cases", coverage.cases},
                    {"totals", Json::object({{"rules", totals.rules},
                                             {"with_case", totals.with_case},
                                             {"positive", totals.positive},
                                             {"negative", totals.negative},
                                             {"exercised", counted(totals.exercised)},
                                             {"explored", counted(totals.explored)},
                                             {"with_mutant", counted(totals.mutated)}})},
                    {"wire", Json::object({levels.begin(), levels.end()})},
                    {"problems", Json::array(coverage.problems)}});
  return out.text() + '\n';
}

int run_coverage(const CoverageOptions& options) {
  Coverage coverage;
  try {
    coverage = measure(options);
  } catch (const cli::Ending&) {
    throw;
  } catch (const std::exception& error) {
    cli::unreadable(error.what());
  }
  const std::string text = options.format == "json" ? json_of(coverage) : text_of(coverage);
  if (!cli::write_file("-", text)) return cli::kExitOutput;
  return coverage.problems.empty() ? cli::kExitClean : cli::kExitFindings;
}

}  // namespace

void add_coverage(cli::Command& app) {
  auto options = std::make_shared<CoverageOptions>();
  cli::Command& sub = app.add_subcommand(kCoverage, "Count what tests each rule");
  sub.footer(
      "Counts for each rule of behaviour: golden traces that ask for it, golden traces that "
      "forbid\n"
      "something by it, steps of the machine that name it in these traces, and named mutants that\n"
      "break it; and says whether the explorer meets it in small networks. Of another protocol's\n"
      "rules it counts the golden traces.\n"
      "Exit codes: 0 covered, 1 a MUST without a case, a forbidding rule that no case attempts, "
      "or\n"
      "a case that is wrong, 64 usage, 66 the cases cannot be read, 74 output cannot be written.");
  sub.add_option(
      "--cases", options->cases,
      "Read golden traces from this folder, in place of the kit's own or the protocol's");
  add_protocol_option(sub, options->protocol);
  sub.add_option("--format", options->format, "Print text or json").one_of({"text", "json"});
  sub.exit_code_of([options] { return run_coverage(*options); });
}

}  // namespace rubric::tools
