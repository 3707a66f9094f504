#include "tools/check.h"

#include <fmt/format.h>
#include <unistd.h>

#include <charconv>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "conformance/oracle/duplicates.h"
#include "conformance/oracle/judge.h"
#include "conformance/oracle/read.h"
#include "conformance/oracle/report/json.h"
#include "conformance/oracle/report/junit.h"
#include "conformance/oracle/report/text.h"
#include "conformance/report/shell.h"
#include "tools/cli/color.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/input.h"
#include "tools/cli/output.h"
#include "tools/cli/terminal.h"
#include "tools/cli/verdict.h"
#include "tools/record/packet_output.h"

namespace rubric::tools {
namespace {

constexpr const char* kFooter =
    "All files are one run: taps of the same network, and .rtr logs with what applications did.\n"
    "Examples:\n"
    "  rubric check capture.pcapng\n"
    "  rubric check capture.pcapng --sink 1=11 --sniffer complete --start cold\n"
    "  rubric check sniffer.pcap sink.serial.bin app.rtr --format junit --out result.xml\n"
    "  rubric check capture.pcapng --expect known.yaml\n"
    "What two files both have of one air or line is judged once; files of one air or line that\n"
    "disagree are refused (66). Beside a capture a log has application lines.\n"
    "A node that --node or --sink names is never an unknown sender, and what they say wins over\n"
    "guesses. What the run plainly shows wins over them, and that is said as inconclusive.\n"
    "Frames count from 1, times from the first one. PEIS messages of a log are not read.\n"
    "Exit codes: 0 as expected (weak findings, strays, notes and what stays inconclusive beside\n"
    "decided things included), 1 a failure that nobody expected, or an expectation that is not\n"
    "true, 2 the kit broke or could not write, 3 nothing but inconclusive: no rule was found\n"
    "kept or broken, 64 usage,\n"
    "66 input cannot be read.";

struct CheckOptions {
  std::vector<std::string> files;
  std::string input_format = "auto";
  std::string profile = "paper";
  std::string format = "text";
  std::string expect;
  std::string out = "-";
  std::string color = "auto";
  std::string sniffer = "unknown";
  std::string start = "unknown";
  std::vector<std::string> nodes;
  std::vector<std::string> sinks;
  std::vector<std::string> frames;
  std::vector<std::string> testers;
  std::optional<double> response_ms;
  std::optional<double> ack_timeout_ms;
  std::optional<double> skew_ms;
  std::size_t width = 0;
  bool verbose = false;
};

std::uint16_t address(const std::string& option, std::string_view text) {
  std::uint32_t value = 0;
  const bool hex = text.starts_with("0x") || text.starts_with("0X");
  const std::string_view digits = hex ? text.substr(2) : text;
  const auto [end, fault] =
      std::from_chars(digits.data(), digits.data() + digits.size(), value, hex ? 16 : 10);
  if (fault != std::errc() || end != digits.data() + digits.size() || value > 0xFFFF) {
    throw CLI::ValidationError(option,
                               fmt::format("expected 0 to 65535, given '{}'", text));
  }
  return static_cast<std::uint16_t>(value);
}

/// "2=mote", split.
std::pair<std::string, std::string> pair_of(const std::string& option, const std::string& text,
                                            const char* form) {
  const std::size_t equals = text.find('=');
  if (equals == text.npos) {
    throw CLI::ValidationError(option, fmt::format("expected {}, given '{}'", form, text));
  }
  return {text.substr(0, equals), text.substr(equals + 1)};
}

void add_node(const std::string& option, const std::string& text, oracle::KnownNode node,
              std::vector<oracle::KnownNode>& nodes) {
  for (const oracle::KnownNode& other : nodes) {
    const bool sinks = node.role == machine::Role::kSink && other.role == machine::Role::kSink;
    if (other.id == node.id && !(sinks && other.island != node.island)) {
      throw CLI::ValidationError(option, fmt::format("'{}' says another time what node {} is",
                                                     text, node.id));
    }
  }
  nodes.push_back(node);
}

std::vector<oracle::KnownNode> known_nodes(const CheckOptions& options) {
  std::vector<oracle::KnownNode> out;
  for (const std::string& text : options.nodes) {
    const auto [id, role] = pair_of("--node", text, "ID=ROLE as in 2=mote");
    oracle::KnownNode node;
    node.id = address("--node", id);
    if (role == "sink") {
      node.role = machine::Role::kSink;
    } else if (role == "base-station" || role == "base_station") {
      node.role = machine::Role::kBaseStation;
    } else if (role != "mote") {
      throw CLI::ValidationError(
          "--node", fmt::format("a role is mote, sink or base-station, not '{}'", role));
    }
    add_node("--node", text, node, out);
  }
  for (const std::string& text : options.sinks) {
    const auto [id, island] = pair_of("--sink", text, "ID=ISLAND as in 1=11");
    oracle::KnownNode node{address("--sink", id), machine::Role::kSink,
                           address("--sink", island)};
    if (node.island == 0) throw CLI::ValidationError("--sink", "no island has the number 0");
    add_node("--sink", text, node, out);
  }
  return out;
}

std::optional<std::int64_t> microseconds(const std::optional<double>& ms) {
  if (!ms) return std::nullopt;
  return static_cast<std::int64_t>(std::llround(*ms * 1000));
}

oracle::Options oracle_options(const CheckOptions& options) {
  oracle::Options out;
  out.deployed = options.profile == "deployed";
  out.sniffer_complete = options.sniffer == "complete";
  out.start_cold = options.start == "cold";
  out.response_us = microseconds(options.response_ms);
  out.ack_timeout_us = microseconds(options.ack_timeout_ms);
  out.skew_us = microseconds(options.skew_ms).value_or(out.skew_us);
  out.nodes = known_nodes(options);
  for (const std::string& text : options.testers) out.testers.push_back(address("--tester", text));
  return out;
}

oracle::ReadAs read_as(const std::string& format) {
  if (format == "hdlc") return {InputFormat::kHdlc, Framing::kSf};
  if (format == "sf") return {InputFormat::kSf, Framing::kSf};
  if (format == "pcap") return {InputFormat::kPcap, Framing::kSf};
  if (format == "pcapng") return {InputFormat::kPcapng, Framing::kSf};
  if (format == "hex") return {InputFormat::kHex, Framing::kSf};
  if (format == "hex-radio") return {InputFormat::kHex, Framing::kRadio};
  return {};
}

constexpr const char* kCommand = "check";

oracle::Run read_run(const CheckOptions& options) {
  oracle::RunReader reader(read_as(options.input_format));
  std::string error;
  for (const std::string& file : options.files) {
    const bool good =
        file == "-" ? reader.add_bytes("stdin", cli::text_of_file(kCommand, file), error)
                    : reader.add_file(file, error);
    if (!good) cli::unreadable(kCommand, error);
  }
  return reader.finish();
}

std::vector<report::FrameRange> frame_ranges(const CheckOptions& options) {
  std::vector<report::FrameRange> out;
  for (const std::string& text : options.frames) {
    report::FrameRange range;
    std::string error;
    if (!report::parse_range(text, range, error)) throw CLI::ValidationError("--frames", error);
    if (range.file == UINT32_MAX) {
      if (options.files.size() > 1) {
        throw CLI::ValidationError("--frames", fmt::format(
            "of which file? 1:{} is of {}", text, options.files.front()));
      }
      range.file = 0;
    }
    if (range.file >= options.files.size()) {
      throw CLI::ValidationError("--frames", fmt::format(
          "'{}': there are {} files", text, options.files.size()));
    }
    for (const report::FrameRange& other : out) {
      if (other.file == range.file) {
        throw CLI::ValidationError("--frames", fmt::format(
            "'{}': one range for each file", text));
      }
    }
    out.push_back(range);
  }
  return out;
}

report::ExpectationFile expectations(const std::string& path) {
  report::ExpectationFile file;
  if (path.empty()) return file;
  std::string error;
  if (!report::parse_expectations(cli::text_of_file(kCommand, path), path, file, error)) {
    throw CLI::ValidationError("--expect", error);
  }
  return file;
}

// The options that a verdict depends on, so that the command can be given again.
std::string command_of(const CheckOptions& options) {
  std::string out = "rubric check";
  const auto add = [&](const char* name, const std::string& value) {
    out += fmt::format(" {} {}", name, report::shell_word(value));
  };
  if (options.profile != "paper") add("--profile", options.profile);
  for (const std::string& node : options.nodes) add("--node", node);
  for (const std::string& sink : options.sinks) add("--sink", sink);
  if (options.sniffer != "unknown") add("--sniffer", options.sniffer);
  if (options.start != "unknown") add("--start", options.start);
  for (const std::string& tester : options.testers) add("--tester", tester);
  if (options.response_ms) add("--response", fmt::format("{}", *options.response_ms));
  if (options.ack_timeout_ms) add("--ack-timeout", fmt::format("{}", *options.ack_timeout_ms));
  if (options.skew_ms) add("--skew", fmt::format("{}", *options.skew_ms));
  if (options.input_format != "auto") add("--input-format", options.input_format);
  return out;
}

std::string report_text(const CheckOptions& options, const report::Story& story, int fd) {
  if (options.format == "json") return report::json_report(story);
  if (options.format == "junit") return report::junit_report(story);
  report::TextOptions text;
  text.width = cli::columns(options.width, fd);
  text.color = cli::use_color(options.color, fd);
  text.verbose = options.verbose;
  text.command = command_of(options);
  for (const std::string& file : options.files) text.files += " " + report::shell_word(file);
  text.judge = oracle::judge;
  return report::text_report(story, text);
}

int run(const CheckOptions& options) {
  oracle::Options judged = oracle_options(options);
  const std::vector<report::FrameRange> ranges = frame_ranges(options);
  if (record::overwrites(options.out, options.files)) {
    throw CLI::ValidationError("--out", options.out + " is one of the files to read");
  }
  const report::ExpectationFile expected = expectations(options.expect);
  oracle::Run whole = read_run(options);
  oracle::Run part = ranges.empty() ? std::move(whole) : report::part_of(whole, ranges, judged);
  if (std::string error; !oracle::drop_duplicates(part, judged, error)) {
    cli::unreadable(kCommand, error);
  }
  const oracle::Report found = oracle::judge(part, judged);
  const report::Outcome outcome = report::compare(part, judged, found, expected);
  const report::Story story{part, judged, found, expected, outcome};
  const int terminal = options.out == "-" ? STDOUT_FILENO : -1;
  const bool written = cli::write_file(options.out, report_text(options, story, terminal));
  return written ? outcome.exit_code() : cli::kVerdictBroken;
}

void add_options(CLI::App& command, CheckOptions& options) {
  command.add_option("FILE", options.files, "Captures and .rtr logs of one run; - is stdin")
      ->required();
  command.add_option("--profile", options.profile, "Rules of the paper, or as release 1.0 has them")
      ->check(CLI::IsMember({"paper", "deployed"}))
      ->capture_default_str();
  command.add_option("--format", options.format, "text, json (rubric.check/1) or junit")
      ->check(CLI::IsMember({"text", "json", "junit"}))
      ->capture_default_str();
  command.add_option("--expect", options.expect, "Known failures with their reasons, as YAML")
      ->check(cli::given());
  command.add_option("--out", options.out, "Write to this file; - is stdout")
      ->check(cli::given())
      ->capture_default_str();
  command.add_option("--node", options.nodes, "ID=ROLE: 2=mote; mote, sink or base-station");
  command.add_option("--sink", options.sinks, "ID=ISLAND of a sink: 1=11");
  command.add_option("--tester", options.testers,
                     "AM address of a sender that is not to be judged");
  command.add_option("--sniffer", options.sniffer,
                     "complete: every frame on the air is in the capture; else unknown")
      ->check(CLI::IsMember({"complete", "unknown"}))
      ->capture_default_str();
  command.add_option("--start", options.start,
                     "cold: nothing had happened before the first frame; else unknown")
      ->check(CLI::IsMember({"cold", "unknown"}))
      ->capture_default_str();
  command.add_option("--response", options.response_ms,
                     "ms until a node must have reacted (the profile's 300 ticks, 293 ms)")
      ->check(CLI::Range(0.0, 3.6e6));
  command.add_option("--ack-timeout", options.ack_timeout_ms,
                     "ms until a reliable message has timed out (the profile's 1000 ticks, "
                     "976.6 ms)")
      ->check(CLI::Range(0.0, 3.6e6));
  command.add_option("--skew", options.skew_ms, "ms between the clocks of two taps, at most (50)")
      ->check(CLI::Range(0.0, 3.6e6));
  command.add_option("--frames", options.frames,
                     "A..B: only these frames; N:A..B of the Nth file, N:none none of it");
  command.add_option("--input-format", options.input_format,
                     "What captures are: auto, hdlc (bytes of a serial line), sf (serial "
                     "forwarder), pcap, pcapng, hex (text, from the dispatch byte on), hex-radio "
                     "(text, 802.15.4 without FCS)")
      ->check(CLI::IsMember({"auto", "hdlc", "sf", "pcap", "pcapng", "hex", "hex-radio"}))
      ->capture_default_str();
  command.add_flag("--verbose", options.verbose, "Text: every finding in full");
  command.add_option("--width", options.width, "Text: columns (those of the terminal, else 100)")
      ->check(CLI::Range(cli::kColumnsMin, std::size_t{1000}));
  cli::add_color_option(command, options.color);
  for (const char* name : {"--node", "--sink", "--tester", "--frames"}) {
    command.get_option(name)->allow_extra_args(false);  // One at a time: files may follow.
  }
}

}  // namespace

void add_check(CLI::App& app) {
  CLI::App* command = app.add_subcommand(kCommand, "Hold captures and logs against the rules");
  auto options = std::make_shared<CheckOptions>();
  add_options(*command, *options);
  command->footer(kFooter);
  cli::set_verdict(*command, [options] { return run(*options); });
}

}  // namespace rubric::tools
