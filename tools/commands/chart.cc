#include "conformance/test/report/chart.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "codec/reflect/suggest.h"
#include "codec/text/text.h"
#include "conformance/report/sequence_svg.h"
#include "conformance/test/suite/run.h"
#include "conformance/trace/protocol.h"
#include "tools/cli/command.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/input.h"
#include "tools/cli/output.h"
#include "tools/cli/terminal.h"
#include "tools/cli/verdict.h"
#include "tools/commands/commands.h"
#include "tools/commands/protocol_folder.h"

namespace rubric::tools {
namespace {

constexpr const char* kChartFooter =
    "A case is one of the kit's own golden traces (rubric test --list) or one of a file of yours:\n"
    "FILE.rtr, or FILE.rtr:CASE. The reference machine runs it, and the chart shows who sends "
    "what\n"
    "to whom, when (a tick is 1/1024 s) and by which rule; a stimulus without effect has the rule\n"
    "that says so beside it. rubric explain RULE prints a rule.\n"
    "An SVG needs nothing else and follows the page's text colour.\n"
    "Examples:\n"
    "  rubric chart j4.wrong_seq\n"
    "  rubric chart open_door.lost --format svg --out open_door.svg\n"
    "  rubric chart my_traces.rtr:mine --target ./my_adapter\n"
    "  rubric chart --protocol my_protocol answer.value --target 'python3 my_protocol/node.py'\n"
    "Exit codes: 0 drawn, 1 drawn, but the trace was not kept, 2 the trace cannot be\n"
    "run, 64 usage, 66 the file cannot be read, 74 output cannot be written.";

struct ChartOptions {
  std::string what;
  std::string format = "text";
  std::string target;
  std::string out = "-";
  std::size_t width = 0;
  std::string folder;  // Of another protocol.
};

// Returns the cases that the user means; they point into `cases`. `traces`: of another protocol.
std::vector<const suite::SuiteCase*> chosen(const std::string& what,
                                            const std::vector<std::string>& traces,
                                            suite::Cases& cases) {
  constexpr std::string_view kEnding = ".rtr";
  const std::size_t colon = what.rfind(".rtr:");
  const bool named = colon != what.npos;
  const std::string path = named ? what.substr(0, colon + kEnding.size()) : what;
  const std::string name = named ? what.substr(colon + kEnding.size() + 1) : "";
  const bool is_file = named || what.ends_with(kEnding) || what.find('/') != what.npos ||
                       std::filesystem::exists(what);
  try {
    cases = is_file          ? suite::Cases::of({path})
            : traces.empty() ? suite::Cases::own()
                             : suite::Cases::of(traces);
  } catch (const std::runtime_error& error) {
    cli::unreadable(error.what());
  }
  std::vector<const suite::SuiteCase*> out;
  std::vector<std::string> names;
  for (const suite::SuiteCase& one : cases.all()) {
    names.push_back(one.one->name);
    const bool meant = is_file ? name.empty() || name == names.back() : what == names.back();
    if (meant) out.push_back(&one);
  }
  const std::string& asked = is_file ? name : what;
  if (out.empty()) {
    throw cli::UsageError(fmt::format("{}no case is called '{}'{}{}", is_file ? path + ": " : "",
                                      asked, reflect::did_you_mean(asked, names),
                                      is_file ? "" : "; rubric test --list shows them"));
  }
  return out;
}

suite::MachineRun work(const suite::SuiteCase& one, const std::string& target) {
  if (target.empty() || target == "machine") return suite::run_on_machine(one);
  try {
    const auto attachment = targets::attach(target, {});
    suite::MachineRun out;
    out.run = suite::run_one(one, *attachment, "", {});
    attachment->finish();
    return out;
  } catch (const std::invalid_argument& error) {
    throw cli::UsageError("--target " + target + ": " + error.what());
  }
}

// Prints what is wrong with the run; returns the program's exit code.
int judged(const suite::CaseRun& run) {
  using runner::CaseVerdict;
  switch (run.result.verdict) {
    case CaseVerdict::kPass:
    case CaseVerdict::kWeak: return cli::kExitClean;
    case CaseVerdict::kFail:
      for (const runner::Failure& failure : run.result.failures) {
        text::print(stderr, "{}:{}: not kept at tick {}: {}\n", run.file, failure.place.line,
                    failure.time, failure.text);
      }
      return cli::kExitFindings;
    case CaseVerdict::kInconclusive:
    case CaseVerdict::kError:
    case CaseVerdict::kSkip: break;
  }
  text::print(stderr, "{}: {}\n", run.name, run.result.reason);
  return run.result.verdict == CaseVerdict::kError ? cli::kExitBroken : cli::kExitClean;
}

std::string text_of(const suite::MachineRun& one, std::size_t width) {
  const report::Sequence sequence = suite::chart(one.run, one.reactions);
  std::string out = text::wrapped(one.run.name + ": ", one.run.comment, width, 2) + "\n";
  if (sequence.rows.empty()) return out + "Nothing was given, and nothing came.\n";
  return out + report::sequence_text(sequence, 2, width);
}

void run_chart(const ChartOptions& options) {
  const std::size_t suffix = options.what.rfind(".rtr");  // FILE.rtr:CASE
  const std::size_t end = suffix == std::string::npos ? suffix : suffix + 4;
  cli::keep_apart("--out", options.out, {options.what.substr(0, end)});
  std::vector<std::string> traces;
  use_protocol(options.folder, {}, traces);
  if (!trace::protocol().has_machine && options.target.empty()) {
    throw cli::UsageError("--protocol", "the reference machine plays RUBICON alone; give --target");
  }
  suite::Cases cases;
  const std::vector<const suite::SuiteCase*> all = chosen(options.what, traces, cases);
  const bool picture = options.format == "svg";
  if (picture && all.size() > 1) {
    throw cli::UsageError(fmt::format("{} has {} cases; name the one to draw: {}:{}", options.what,
                                      all.size(), options.what, all.front()->one->name));
  }
  const std::size_t width = cli::columns(options.width, 1);
  std::string out;
  int code = cli::kExitClean;
  for (const suite::SuiteCase* one : all) {
    const suite::MachineRun worked = work(*one, options.target);
    code = std::max(code, judged(worked.run));
    if (picture) {
      const std::string comment = worked.run.comment;
      out += report::sequence_svg(
          suite::chart(worked.run, worked.reactions),
          {"chart-" + worked.run.name,
           "Sequence chart of " + worked.run.name + (comment.empty() ? "" : ": " + comment)});
    } else {
      out += (out.empty() ? "" : "\n") + text_of(worked, width);
    }
  }
  if (code == cli::kExitBroken && options.out != "-") {  // An old file is better than half a one.
    cli::exit_with(code);
  }
  if (!cli::write_file(options.out, out)) cli::exit_with(cli::kExitOutput);
  if (code != cli::kExitClean) cli::exit_with(code);
}

}  // namespace

void add_chart(cli::Command& app) {
  auto options = std::make_shared<ChartOptions>();
  cli::Command& sub = app.add_subcommand("chart", "Draw a golden trace as a sequence chart");
  sub.footer(kChartFooter);
  sub.add_option("CASE", options->what, "A case's name, FILE.rtr or FILE.rtr:CASE").required();
  add_protocol_option(sub, options->folder);
  sub.add_option("--format", options->format, "Draw as text or svg").one_of({"text", "svg"});
  sub.add_option("--target", options->target,
                 "Draw what this implementation does instead, as rubric test has it");
  sub.add_option("-o,--out", options->out, "Write to this file; - is stdout");
  cli::add_width_option(sub, options->width);
  sub.callback([options] { run_chart(*options); });
}

}  // namespace rubric::tools
