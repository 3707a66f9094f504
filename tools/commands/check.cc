#include <unistd.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "codec/lines/line.h"
#include "codec/reflect/requirements.h"
#include "codec/text/json.h"
#include "codec/text/text.h"
#include "conformance/check/input/duplicates.h"
#include "conformance/check/input/read_trace.h"
#include "conformance/check/observation.h"
#include "conformance/check/report/words.h"
#include "tools/cli/choose_spec.h"
#include "tools/cli/color.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/output.h"
#include "tools/cli/specs.h"
#include "tools/cli/terminal.h"
#include "tools/cli/text_file.h"
#include "tools/cli/verdict.h"
#include "tools/commands/check_live.h"
#include "tools/commands/check_news.h"
#include "tools/commands/check_options.h"
#include "tools/commands/commands.h"
#include "tools/commands/stated.h"

namespace rubric::tools {
namespace {

constexpr const char* kCheckFooter =
    "For RUBICON alone, whose reference machine judges.\n"
    "All files are one run: taps of the same network, and .rtr logs with what applications did.\n"
    "Examples:\n"
    "  rubric check capture.pcapng\n"
    "  rubric check capture.pcapng --sink 1=11 --sniffer complete --start cold\n"
    "  rubric check sniffer.pcap sink.serial.bin app.rtr --format junit --out result.xml\n"
    "  rubric check capture.pcapng --expect known.yaml\n"
    "  rubric check serial@/dev/ttyUSB0:telosb sniffer.pcapng --follow --write line.pcapng\n"
    "  rubric check sf@localhost:9002 --format jsonl | jq -r .finding.text\n"
    "  rubric check --each captures/ --resume done.jsonl --out results.jsonl\n"
    "What two files both have of one air or line is judged once; files of one air or line that\n"
    "disagree are refused (66). Beside a capture a log has application lines.\n"
    "A node that --node or --sink names is never an unknown sender, and what they say wins over\n"
    "guesses. What the run plainly shows wins over them, and is reported as inconclusive.\n"
    "Frames count from 1, times from the first one.\n"
    "Lines in use, and with --follow files that grow, are judged as frames come, several at a\n"
    "time. A finding is reported when 1 s more than nodes may take has passed, and withdrawn when\n"
    "later frames explain it. Ctrl-C, or the end of all sources, ends with the report;\n"
    "'rubric check' of the capture that --write keeps says the same. Sniffers should write packet\n"
    "by packet, as dumpcap and tcpdump -U do. While a run grows, frames older than some minutes\n"
    "(--keep) are dropped, except those that show who the nodes are and what they joined. "
    "Findings\n"
    "stay; what only a dropped frame could decide is inconclusive. With --format json or junit\n"
    "findings go to stderr as they come; jsonl has a line for each.\n"
    "Exit codes: 0 as expected (weak findings, strays, notes and what stays inconclusive beside\n"
    "decided things included), 1 an unexpected failure, or an expectation that is not true, 2 the\n"
    "kit broke, 3 nothing but inconclusive: no rule was found kept or broken,\n"
    "64 usage, 66 input cannot be read, or is damaged or broke off and nothing failed, 74\n"
    "output cannot be written.";

// Adds a file to a run, as every command reads captures; a log is taken whole. Returns false if it
// has damaged places.
bool add_file(const CheckOptions& options, const std::string& file, check::RunReader& reader) {
  const std::string name = file == "-" ? "stdin" : file;
  bool is_log = false;
  std::string error;
  const cli::OtherText logs{
      [](Bytes beginning) {
        return check::looks_like_trace(
            {reinterpret_cast<const char*>(beginning.data()), beginning.size()});
      },
      [&](const cli::Source&, std::string text) {
        is_log = true;
        reader.add_bytes(name, text, error);
      }};
  std::optional<std::uint32_t> index;
  const auto take = [&](const Packet& packet, const cli::Source& source) {
    if (!index) index = reader.open(name);
    reader.take(*index, packet, source.interface_name, source.number);
    return true;
  };
  cli::InputOptions one = options.input;
  one.files = {file};
  one.prints = false;
  cli::say_if_another_spec_fits(one);
  const cli::InputResult result = cli::read_packets(one, take, {}, logs);
  if (!error.empty()) cli::unreadable(error);
  if (result.failed && !result.damaged) cli::exit_with(cli::kExitInput);
  if (!is_log && !index) reader.open(name);
  return !result.damaged;
}

check::Run read_run(const CheckOptions& options, bool& undamaged) {
  check::RunReader reader(align_options(options));
  std::vector<std::string> facts;
  for (const std::string& file : options.input.files) {
    if (add_file(options, file, reader)) continue;
    undamaged = false;
    facts.push_back((file == "-" ? "stdin" : file) + " is damaged or cut; the rest is judged");
  }
  check::Run run = reader.finish();
  if (run.cut) {
    undamaged = false;
    facts.emplace_back("A log ends within a line; the rest is judged");
  }
  run.facts.insert(run.facts.begin(), facts.begin(), facts.end());
  return run;
}

int check_files(const CheckOptions& options) {
  const auto& files = options.input.files;
  check::Options judged = oracle_options(options);
  const std::vector<report::FrameRange> ranges = frame_ranges(options);
  if (!options.write.path.empty()) {
    throw cli::UsageError("--write", "none of the sources is a line in use");
  }
  if (options.keep_minutes) {
    throw cli::UsageError("--keep", "no source grows, so all frames are held");
  }
  keep_outputs_apart(options);
  const report::KnownFailures expected = expectations(options);
  bool undamaged = true;
  check::Run whole = read_run(options, undamaged);
  check::Run part = ranges.empty() ? std::move(whole) : report::part_of(whole, ranges, judged);
  if (std::string error; !check::drop_duplicates(part, judged, error)) cli::unreadable(error);
  const check::Report found = check::judge(part, judged);
  report::Outcome outcome = report::compare(part, judged, found, expected);
  outcome.input_missing = !undamaged;
  const report::Story story{part, judged, found, expected, outcome};
  const int terminal = options.out == "-" ? STDOUT_FILENO : -1;
  const bool written = cli::write_file(options.out, report_text(options, story, terminal, files));
  const bool kept = write_report_folder(options, story);
  return written && kept ? outcome.exit_code() : cli::kExitOutput;
}

// Returns what a line of --each says of a run.
std::string line_members(const report::Story& story) {
  using text::Json;
  std::map<std::string, std::uint64_t> failures;
  for (std::size_t i = 0; i < story.report.findings.size(); ++i) {
    const check::Finding& finding = story.report.findings[i];
    const bool known = story.outcome.expected_by[i] != report::kUnexpected;
    if (finding.severity != check::Severity::kFail || known) continue;
    ++failures[reflect::requirement(finding.requirement).id];
  }
  const auto failure = [](const auto& one) {
    return Json::object({{"requirement", one.first}, {"findings", one.second}});
  };
  const Json whole = Json::object({{"verdict", report::verdict_name(story.outcome.verdict)},
                                   {"frames", story.report.frames},
                                   {"begin", Json::raw(text::seconds_text(story.run.begin_us))},
                                   {"seconds", Json::raw(text::seconds_text(story.run.end_us))},
                                   {"failures", Json::array(failures, failure)}});
  return whole.text().substr(1, whole.text().size() - 2);
}

// Checks each file as a run of its own.
int check_each_run(const CheckOptions& options) {
  if (is_live(options)) throw cli::UsageError("--each", "is for runs that are over");
  if (!options.frames.empty()) throw cli::UsageError("--frames", "of which run? --each has many");
  if (!options.write.path.empty()) throw cli::UsageError("--write", "no source is a line in use");
  if (options.keep_minutes) throw cli::UsageError("--keep", "no source grows");
  if (!options.report.empty()) throw cli::UsageError("--report", "of which run? --each has many");
  if (options.format != "text" && options.format != "jsonl") {
    throw cli::UsageError("--format", "--each prints a line of JSON for each run");
  }
  const check::Options judged = oracle_options(options);
  const report::KnownFailures expected = expectations(options);
  const std::string known = options.expect.empty() ? "" : cli::text_of_file(options.expect);
  const cli::EachJob job{kCheckCommand, command_of(options) + "\n" + known, cli::read_all_specs};
  keep_outputs_apart(options);
  if (!options.each.resume.empty()) cli::keep_apart("--out", options.out, {options.each.resume});
  return cli::each(options.each, job, options.input.files, options.out,
                   [&](const std::string& file, std::string& members) {
                     CheckOptions one = options;
                     one.input.files = {file};
                     one.input.progress = false;
                     bool undamaged = true;
                     check::Run run = read_run(one, undamaged);
                     check::Options its = judged;
                     const check::Report found = check::judge(run, its);
                     report::Outcome outcome = report::compare(run, its, found, expected);
                     outcome.input_missing = !undamaged;
                     members = line_members({run, its, found, expected, outcome});
                     return outcome.exit_code();
                   });
}

int run_check(CheckOptions options) {
  cli::check_each(options.each);
  if (options.each.each && !options.input.files.empty()) return check_each_run(options);
  if (options.input.files.empty()) {
    if (!lines::asked_by_motecom()) throw cli::UsageError("FILE is required");
    options.input.files.push_back(lines::default_address());
  }
  return is_live(options) ? check_live(options) : check_files(options);
}

void add_options(cli::Command& command, CheckOptions& options) {
  command.add_option("FILE", options.input.files, "");
  cli::add_live_options(command, options.input);
  command.get_option("FILE").description(
      "Captures and .rtr logs of one run; - is stdin. Or lines in use: serial@DEVICE:BAUD (or a "
      "platform, as serial@/dev/ttyUSB0:telosb), network@HOST:PORT, sf@HOST:PORT, zep:PORT; at a "
      "terminal "
      "$MOTECOM");
  cli::add_each_options(command, options.each);
  cli::add_write_options(command, options.write, "Keep what lines in use send in this pcapng file",
                         false);
  command
      .add_option("--profile", options.profile,
                  "Judge by the rules of the paper, or as release 1.0 has them")
      .one_of({"paper", "deployed"});
  command
      .add_option("--format", options.format,
                  "Print text, json (rubric.check/1), jsonl (an event a line) or junit")
      .one_of({"text", "json", "jsonl", "junit"});
  command.add_option("--expect", options.expect,
                     "Read known failures with their reasons from this YAML file");
  command.add_option("-o,--out", options.out, "Write to this file; - is stdout");
  command.add_option("--report", options.report,
                     "Write index.html, report.json and junit.xml into this folder");
  command.add_option("--node", options.nodes,
                     "Name a node's role as ID=ROLE: 2=mote; mote, sink or base-station");
  command.add_option("--sink", options.sinks, "Name a sink's island as ID=ISLAND: 1=11");
  command.add_option("--tester", options.testers, "Do not judge the sender with this AM address");
  command
      .add_option("--sniffer", options.sniffer,
                  "Say that every frame on the air is in the capture: complete, else unknown")
      .one_of({"complete", "unknown"});
  command
      .add_option("--start", options.start,
                  "Say that nothing had happened before the first frame: cold, else unknown")
      .one_of({"cold", "unknown"});
  add_state_option(command, options.stated);
  command
      .add_option("--response", options.response_ms,
                  "Give nodes this many ms to react (default: the profile's 300 ticks, 293 ms)")
      .between(0.0, 3.6e6);
  command
      .add_option(
          "--ack-timeout", options.ack_timeout_ms,
          "Let a reliable message time out after this many ms (default: the profile's 1000 ticks, "
          "976.6 ms)")
      .between(0.0, 3.6e6);
  command
      .add_option("--skew", options.skew_ms,
                  "Allow this many ms between the clocks of two taps (default: 50)")
      .between(0.0, 3.6e6);
  command
      .add_option("--align", options.align,
                  "Put captures whose clocks differ on one clock, by the frames that they share: "
                  "auto; off takes stamps as they are")
      .one_of({"auto", "off"});
  command
      .add_option(
          "--keep", options.keep_minutes,
          "Hold frames of a growing run for at least this many minutes (default: as long as "
          "the stated times ask for, at least 1)")
      .between(0.0, 1e6);
  command.add_option("--frames", options.frames,
                     "Judge only frames A..B; N:A..B those of the Nth file, N:none none of it");
  cli::add_capture_options(command, options.input);
  command.add_flag("--verbose", options.verbose,
                   "Print also further findings of a rule and node in full; live, also notes");
  command
      .add_option("--max-findings", options.findings_max,
                  "Print at most this many findings of a rule in full, and count the others")
      .check(cli::whole_number);
  cli::add_width_option(command, options.width);
  cli::add_color_option(command, options.color);
  for (const char* name : {"--node", "--sink", "--tester", "--frames"}) {
    command.get_option(name).one_at_a_time();  // One at a time: files may follow.
  }
}

}  // namespace

void add_check(cli::Command& app) {
  cli::Command& command =
      app.add_subcommand(kCheckCommand, "Check captures and logs against the rules");
  auto options = std::make_shared<CheckOptions>();
  add_options(command, *options);
  command.footer(kCheckFooter);
  cli::set_verdict(command, [options] { return run_check(*options); });
}

}  // namespace rubric::tools
