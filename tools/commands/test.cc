#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "codec/text/text.h"
#include "conformance/test/report/github.h"
#include "conformance/test/report/html.h"
#include "conformance/test/report/json.h"
#include "conformance/test/report/junit.h"
#include "conformance/test/report/known_list.h"
#include "conformance/test/report/tap.h"
#include "conformance/test/report/text/text.h"
#include "conformance/test/suite/run.h"
#include "conformance/test/suite/select.h"
#include "conformance/test/targets/groups.h"
#include "conformance/trace/protocol.h"
#include "tools/cli/color.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/input.h"
#include "tools/cli/output.h"
#include "tools/cli/progress.h"
#include "tools/cli/terminal.h"
#include "tools/cli/verdict.h"
#include "tools/commands/commands.h"
#include "tools/commands/protocol_folder.h"
#include "tools/commands/report_folder.h"
#include "tools/commands/stated.h"

namespace rubric::tools {
namespace {

using Milliseconds = std::chrono::milliseconds;

constexpr const char* kCommand = "test";

constexpr const char* kTestFooter =
    "A target is a command that speaks rct/1, a real node at its own line, or the reference\n"
    "machine in this program (conformance/PORTING.md):\n"
    "  './my_adapter --fast'     started as a child process\n"
    "  machine, machine:no_fail  the machine, or with a flaw (see rubric explore --help)\n"
    "  sf-server:PORT            a base station that connects to a Serial Forwarder: to us\n"
    "  sf:HOST:PORT              a sink behind a Serial Forwarder\n"
    "  serial:DEVICE[:BAUD]      a sink at a serial line; serial:tcp:HOST:PORT at an emulator's\n"
    "  sf:HOST:PORT:mote         a mote there, also serial:...:mote; its line decides nothing\n"
    "A line shows a part of a node; --app COMMAND adds its application, for cases that need it.\n"
    "Without TRACES it is tested with the kit's own golden traces, which the program contains, or\n"
    "with those of --protocol DIR.\n"
    "Examples:\n"
    "  rubric test --target ./my_adapter\n"
    "  rubric test --target 'python3 mote.py' --role mote --rule J --quiet\n"
    "  rubric test --target ./a --target ./b --jobs 4 --expect known.yaml --report out\n"
    "  rubric test --list --rule J4-SEQ\n"
    "  rubric test --protocol my_protocol --target 'python3 my_protocol/node.py'\n"
    "Before its first case each implementation has to refuse an unknown command, and to fail\n"
    "cases that no implementation can pass.\n"
    "Exit codes: 0 as expected, 1 an unexpected failure, or an expectation that is not true, 2 an\n"
    "implementation or the kit broke (between cases, too), or was not honest, 3 incomplete: a "
    "case\n"
    "of a role that it plays was not decided, and --expect does not list it with a reason;\n"
    "64 usage, 66 traces cannot be read, 74 output cannot be written.";

struct TestOptions {
  std::string protocol;
  std::vector<std::string> traces;
  std::vector<std::string> targets;
  std::string app;
  suite::Selection selection;
  std::string profile;
  std::string role;
  std::string shard;
  std::optional<std::uint64_t> seed;
  std::uint32_t repeats = 1;
  unsigned jobs = 1;
  double timeout_s = 5;
  std::vector<std::string> stated;
  std::string expect;
  std::string write_expect;
  std::size_t rules_required = 0;
  std::string format = "text";
  std::string out = "-";
  std::string report;
  std::string compare;
  std::string color = "auto";
  std::size_t width = 0;
  bool list = false;
  bool quiet = false;
  bool verbose = false;
};

suite::Cases read_cases(const TestOptions& options) {
  if (options.traces.empty()) return suite::Cases::own();
  try {
    return suite::Cases::of(options.traces);
  } catch (const std::runtime_error& error) {
    cli::unreadable(error.what());
  }
}

report::KnownFailures read_expected(const TestOptions& options) {
  if (options.expect.empty()) return {};
  const std::string text = cli::text_of_file(options.expect);
  try {
    return suite::parse_expected(text, options.expect);
  } catch (const std::runtime_error& mistake) {
    throw cli::UsageError("--expect", mistake.what());
  }
}

std::optional<suite::EarlierRun> read_earlier(const TestOptions& options) {
  if (options.compare.empty()) return std::nullopt;
  const std::string text = cli::text_of_file(options.compare);
  try {
    return suite::read_json_report(text);
  } catch (const std::runtime_error& mistake) {
    cli::unreadable(fmt::format("{}: {}", options.compare, mistake.what()));
  }
}

std::vector<suite::SuiteCase> selected(const TestOptions& options, const suite::Cases& cases) {
  suite::Selection selection = options.selection;
  if (!options.role.empty()) {
    const auto role = trace::find_role(options.role);
    if (!role) {
      throw cli::UsageError("--role",
                            fmt::format("expected one of {}; given '{}'",
                                        fmt::join(trace::role_names(), ", "), options.role));
    }
    selection.role = static_cast<machine::Role>(*role);
  }
  if (!options.shard.empty()) {
    const auto shard = suite::parse_shard(options.shard);
    if (!shard) {
      throw cli::UsageError("--shard",
                            fmt::format("expected I/N as in 2/8, given '{}'", options.shard));
    }
    selection.shard = *shard;
  }
  try {
    return suite::select(cases, selection);
  } catch (const std::invalid_argument& error) {
    throw cli::UsageError(error.what());
  }
}

std::string list_line(const suite::SuiteCase& one) {
  std::string roles;
  for (const machine::Role role : one.roles()) {
    if (!roles.empty()) roles += '+';
    roles += trace::role_text(static_cast<trace::Role>(role));
  }
  std::string line = fmt::format("{:<40} {:<12}", one.one->name, roles);
  for (const std::string& rule : one.rules()) line += ' ' + rule;
  line.erase(line.find_last_not_of(' ') + 1);
  return line + '\n';
}

int list(const TestOptions& options, const std::vector<suite::SuiteCase>& cases) {
  if (options.format != "text" && options.format != "json") {
    throw cli::UsageError("--list", "prints text or json, no " + options.format);
  }
  cli::Output output(options.out, cli::Output::Mode::kWhole);
  if (options.format == "json") output.buffer().append(suite::json_list(cases));
  for (std::size_t i = 0; options.format == "text" && i < cases.size(); ++i) {
    output.buffer().append(list_line(cases[i]));
    if (!output.drain()) break;
  }
  return output.finish() ? cli::kExitClean : cli::kExitOutput;
}

void check_seeds(const TestOptions& options) {
  using suite::kSeedMax;
  const std::uint64_t first = options.seed.value_or(0);
  if (first > kSeedMax) {
    throw cli::UsageError("--seed", fmt::format("expected 0 to {}, given {}", kSeedMax, first));
  }
  if (first + options.repeats - 1 > kSeedMax) {
    throw cli::UsageError("--repeat", fmt::format("{} seeds from {} on go beyond {}",
                                                  options.repeats, first, kSeedMax));
  }
}

// Prints text as it is made, on a terminal each line at once; to a file when it is whole.
class Text {
 public:
  Text(const TestOptions& options, bool wanted)
      : wanted_(wanted), to_stdout_(options.out == "-"), at_once_(isatty(STDOUT_FILENO) == 1) {}

  void add(const std::string& text) {
    if (!wanted_) return;
    if (!to_stdout_) {
      whole_ += text;
      return;
    }
    output_.buffer().append(text);
    if (at_once_)
      output_.flush();
    else
      output_.drain();
  }
  bool finish(const TestOptions& options) {
    if (!wanted_) return true;
    if (!to_stdout_) return cli::write_file(options.out, whole_);
    return output_.finish();
  }

 private:
  bool wanted_;
  bool to_stdout_;
  bool at_once_;
  cli::Output output_;
  std::string whole_;
};

suite::SuiteRun work(const TestOptions& options, const suite::Cases& cases, suite::Plan plan,
                     const std::optional<suite::EarlierRun>& earlier, const suite::TextOptions& how,
                     Text& text) {
  suite::SuiteRun all{.protocol = options.protocol,
                      .seed = options.seed.value_or(0),
                      .shard = options.shard,
                      .app = options.app,
                      .stated = statement_of(options.stated),
                      .traces = options.traces,
                      .rules_required = options.rules_required};
  const std::vector<std::string>& profiles = trace::protocol().profiles;
  all.profile = options.profile.empty() && !profiles.empty() ? profiles.front() : options.profile;
  targets::Options attached;
  attached.step_timeout = Milliseconds(static_cast<std::int64_t>(options.timeout_s * 1000));
  attached.start_timeout = std::max(attached.start_timeout, attached.step_timeout);
  attached.stated = all.stated;
  attached.app = options.app;
  const std::size_t worked = plan.cases.size() * plan.repeats;
  cli::Progress progress(worked * options.targets.size(), true, true, cli::Progress::Unit::kCases);
  for (const std::string& target : options.targets) {
    const auto make = [&] { return targets::attach(target, attached); };
    suite::Watcher watcher;
    watcher.started = [&](const suite::ImplementationRun& run) {
      text.add((all.implementations.empty() ? "" : "\n") +
               suite::opening_text(all, run, worked, how));
    };
    watcher.case_done = [&](const suite::CaseRun& one) {
      text.add(suite::case_text(one, how));
      progress.advance(1);
    };
    all.implementations.push_back(suite::run(target, make, plan, watcher));
    const suite::ImplementationRun& run = all.implementations.back();
    text.add(suite::story_text(all, run, how) + suite::totals_text(all, run, how));
  }
  all.stale = suite::stale_expectations(plan.expected, all, cases);
  if (earlier) text.add(suite::changes_text(all, *earlier, options.compare, how));
  text.add(suite::closing_text(all, how));
  return all;
}

// Writes everything into one folder: the page with its files, and reports for programs.
bool write_folder(const TestOptions& options, const suite::SuiteRun& run,
                  const std::optional<suite::EarlierRun>& earlier) {
  try {
    suite::ReportFolder folder(options.report);
    suite::write_html_report(run, earlier ? &*earlier : nullptr, folder);
    folder.write(suite::ReportFolder::kJson, suite::json_report(run));
    folder.write(suite::ReportFolder::kJunit, suite::junit_report(run));
    folder.write(suite::ReportFolder::kTap, suite::tap_report(run));
    folder.finish();
    return true;
  } catch (const std::system_error& error) {
    cli::cannot_write(error);
    return false;
  }
}

bool write_formats(const TestOptions& options, const suite::SuiteRun& run,
                   const std::optional<suite::EarlierRun>& earlier) {
  bool good = true;
  // The report of a run that broke must not cost that of one that did not.
  const bool keep = suite::exit_code(run) == cli::kExitBroken && options.out != "-" &&
                    std::filesystem::is_regular_file(options.out);
  if (keep && options.format != "text") {
    text::print(stderr, "rubric test: the run broke; {} stays as it was\n", options.out);
  } else if (options.format == "json") {
    good = cli::write_file(options.out, suite::json_report(run));
  } else if (options.format == "junit") {
    good = cli::write_file(options.out, suite::junit_report(run));
  } else if (options.format == "tap") {
    good = cli::write_file(options.out, suite::tap_report(run));
  }
  const char* actions = std::getenv("GITHUB_ACTIONS");
  if (actions && std::string_view(actions) == "true") {
    text::print_harmless(stderr, suite::github_annotations(run));
  }
  return (options.report.empty() || write_folder(options, run, earlier)) && good;
}

int run_test(TestOptions options) {
  const bool starts_processes =
      !options.app.empty() ||
      std::any_of(options.targets.begin(), options.targets.end(), targets::is_command);
  if (starts_processes && !options.list) targets::guard_children();
  use_protocol(options.protocol, {options.profile}, options.traces);
  const suite::Cases cases = read_cases(options);
  suite::Plan plan{.expected = read_expected(options)};
  const std::optional<suite::EarlierRun> earlier = read_earlier(options);
  check_seeds(options);
  for (const std::string& input : {options.expect, options.compare}) {
    if (!input.empty()) cli::keep_apart("--out", options.out, {input});
  }
  if (!options.traces.empty()) {
    cli::keep_apart("--out", options.out, options.traces);
    cli::keep_apart("--write-expect", options.write_expect, options.traces);
  }
  if (!options.write_expect.empty()) {
    cli::keep_apart("--write-expect", options.write_expect, {options.out});
  }
  std::vector<std::string> files = options.traces;
  files.insert(files.end(), {options.expect, options.out, options.write_expect});
  keep_report_apart(options.report, files);
  plan.cases = selected(options, cases);
  if (options.list) return list(options, plan.cases);
  if (options.targets.empty()) throw cli::UsageError("--target is required");
  statement_of(options.stated);
  for (const std::string& target : options.targets) {
    try {
      targets::Options attached{.app = options.app};
      targets::attach(target, attached);
    } catch (const std::invalid_argument& error) {
      throw cli::UsageError("--target", fmt::format("'{}': {}", target, error.what()));
    }
  }
  targets::end_groups_on_signals();
  plan.profile = options.profile;
  plan.seed = options.seed;
  plan.repeats = options.repeats;
  plan.jobs = options.jobs != 0 ? options.jobs : std::max(1U, std::thread::hardware_concurrency());
  const int fd = options.out == "-" ? STDOUT_FILENO : -1;
  suite::TextOptions how;
  how.width = cli::columns(options.width, fd);
  how.color = cli::use_color(options.color, fd);
  how.quiet = options.quiet;
  how.verbose = options.verbose;
  const bool terminal = fd >= 0 && isatty(fd) == 1;
  how.cuts = terminal || options.width != 0;
  how.times = options.verbose || terminal;
  Text text(options, options.format == "text");
  const report::KnownFailures expected = plan.expected;
  const suite::SuiteRun all = work(options, cases, std::move(plan), earlier, how, text);
  const bool told = text.finish(options);
  const bool written = write_formats(options, all, earlier) &&
                       (options.write_expect.empty() ||
                        cli::write_file(options.write_expect, suite::known_list(all, expected)));
  return written && told ? suite::exit_code(all) : cli::kExitOutput;
}

void add_selection(cli::Command& command, TestOptions& options) {
  command.add_option(
      "TRACES", options.traces,
      "Golden traces, .rtr files or folders of them (default: those that were built in)");
  command.add_option("--cases", options.selection.globs,
                     "Run only cases with such names: 'j4.*'; repeat for others");
  command.add_option("--except", options.selection.excepted,
                     "Leave out the cases with such names; repeat for others");
  command.add_option(
      "--rule", options.selection.requirements,
      "Run only cases that try this rule or family: J4-SEQ, J4, J; repeat for others");
  command.add_option("--role", options.role, "Run only cases with a node of this role under test")
      .type_name("TEXT:{mote,sink,base_station}");
  command.add_option("--shard", options.shard, "Run only the Ith of N parts of the cases: I/N");
  command.add_flag("--list", options.list,
                   "Print names, roles and rules of the cases, as text or JSON");
}

void add_options(cli::Command& command, TestOptions& options) {
  command.add_option("--target", options.targets,
                     "Test this implementation: a command, or machine; repeat for others");
  command.add_option(
      "--app", options.app,
      "Run this command as the application, and perhaps PEIS, of a node at its line");
  add_selection(command, options);
  add_protocol_option(command, options.protocol);
  command
      .add_option("--profile", options.profile,
                  "Tell nodes to keep to paper or deployed, whatever the traces say")
      .one_of({"paper", "deployed"});
  add_state_option(command, options.stated);
  command
      .add_option("--seed", options.seed,
                  "Seed what is random in nodes, where a trace has no seed; 0 to 65535")
      .check(cli::whole_number);
  command
      .add_option("--repeat", options.repeats,
                  "Run each case this many times, each time with the next seed")
      .between(1, 10000);
  command
      .add_option("--jobs", options.jobs,
                  "Run this many cases at once, each in a process; 0: one a core")
      .between(0, 256);
  command.add_option("--timeout", options.timeout_s, "Wait at most this many seconds for a step")
      .between(0.01, 3600.0);
  command.add_option("--expect", options.expect,
                     "Read known failures with their reasons from this YAML file");
  command.add_option(
      "--write-expect", options.write_expect,
      "Write what failed or was not decided as such a file, with reasons to fill in");
  command
      .add_option("--require-rules", options.rules_required,
                  "Require this many rules to be decided, else the run is incomplete")
      .check(cli::whole_number);
  command.add_option("--format", options.format, "Print text, json (rubric.test/1), junit or tap")
      .one_of({"text", "json", "junit", "tap"});
  command.add_option("-o,--out", options.out, "Write to this file; - is stdout");
  command.add_option("--report", options.report,
                     "Write index.html and all other reports into this folder");
  command.add_option("--compare", options.compare,
                     "Say which verdicts have changed since this report.json");
  command.add_flag("--quiet", options.quiet, "Print no lines for cases that are as expected");
  command.add_flag("--verbose", options.verbose, "Print every failure in full");
  cli::add_width_option(command, options.width);
  cli::add_color_option(command, options.color);
  for (const char* name : {"--target", "--cases", "--except", "--rule"}) {
    command.get_option(name).repeatable();  // Traces may follow.
  }
}

}  // namespace

void add_test(cli::Command& app) {
  cli::Command& command = app.add_subcommand(kCommand, "Test implementations with golden traces");
  auto options = std::make_shared<TestOptions>();
  add_options(command, *options);
  command.footer(kTestFooter);
  cli::set_verdict(command, [options] { return run_test(*options); });
}

}  // namespace rubric::tools
