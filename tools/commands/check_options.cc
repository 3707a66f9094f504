#include "tools/commands/check_options.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <utility>

#include "codec/text/shell.h"
#include "codec/text/text.h"
#include "conformance/check/input/read_trace.h"
#include "tools/cli/color.h"
#include "tools/cli/terminal.h"
#include "tools/cli/verdict.h"
#include "tools/commands/report_folder.h"
#include "tools/commands/stated.h"

namespace rubric::tools {
namespace {

constexpr std::size_t kLogLook = 4096;  // Comments may precede its header.

std::uint16_t address(const std::string& option, std::string_view text) {
  std::uint32_t value = 0;
  const bool hex = text.starts_with("0x") || text.starts_with("0X");
  const std::string_view digits = hex ? text.substr(2) : text;
  const auto [end, fault] =
      std::from_chars(digits.data(), digits.data() + digits.size(), value, hex ? 16 : 10);
  if (fault != std::errc() || end != digits.data() + digits.size() || value > 0xFFFF) {
    throw cli::UsageError(option, fmt::format("expected 0 to 65535, given '{}'", text));
  }
  return static_cast<std::uint16_t>(value);
}

/// Splits "2=mote".
std::pair<std::string, std::string> pair_of(const std::string& option, const std::string& text,
                                            const char* form) {
  const std::size_t equals = text.find('=');
  if (equals == text.npos) {
    throw cli::UsageError(option, fmt::format("expected {}, given '{}'", form, text));
  }
  return {text.substr(0, equals), text.substr(equals + 1)};
}

void add_node(const std::string& option, const std::string& text, check::KnownNode node,
              std::vector<check::KnownNode>& nodes) {
  for (const check::KnownNode& other : nodes) {
    const bool sinks = node.role == machine::Role::kSink && other.role == machine::Role::kSink;
    if (other.id == node.id && !(sinks && other.island != node.island)) {
      throw cli::UsageError(option,
                            fmt::format("'{}' says another time what node {} is", text, node.id));
    }
  }
  nodes.push_back(node);
}

std::vector<check::KnownNode> known_nodes(const CheckOptions& options) {
  std::vector<check::KnownNode> out;
  for (const std::string& text : options.nodes) {
    const auto [id, role] = pair_of("--node", text, "ID=ROLE as in 2=mote");
    check::KnownNode node;
    node.id = address("--node", id);
    if (role == "sink") {
      node.role = machine::Role::kSink;
    } else if (role == "base-station" || role == "base_station") {
      node.role = machine::Role::kBaseStation;
    } else if (role != "mote") {
      throw cli::UsageError("--node",
                            fmt::format("a role is mote, sink or base-station, not '{}'", role));
    }
    add_node("--node", text, node, out);
  }
  for (const std::string& text : options.sinks) {
    const auto [id, island] = pair_of("--sink", text, "ID=ISLAND as in 1=11");
    check::KnownNode node{address("--sink", id), machine::Role::kSink, address("--sink", island)};
    if (machine::is_reserved(node.island)) {
      throw cli::UsageError("--sink", island + " is reserved: no island has this number");
    }
    add_node("--sink", text, node, out);
  }
  return out;
}

std::optional<std::int64_t> microseconds(const std::optional<double>& ms) {
  if (!ms) return std::nullopt;
  return static_cast<std::int64_t>(std::llround(*ms * 1000));
}

}  // namespace

check::Options oracle_options(const CheckOptions& options) {
  check::Options out{.deployed = options.profile == "deployed",
                     .sniffer_complete = options.sniffer == "complete",
                     .start_cold = options.start == "cold",
                     .response_us = microseconds(options.response_ms),
                     .ack_timeout_us = microseconds(options.ack_timeout_ms)};
  out.skew_us = microseconds(options.skew_ms).value_or(out.skew_us);
  out.stated = statement_of(options.stated);
  out.nodes = known_nodes(options);
  for (const std::string& text : options.testers) out.testers.push_back(address("--tester", text));
  return out;
}

void keep_outputs_apart(const CheckOptions& options) {
  std::vector<std::string> inputs = options.input.files;
  if (!options.expect.empty()) inputs.push_back(options.expect);
  cli::keep_apart("--out", options.out, inputs);
  cli::keep_apart("--write", options.write.path, inputs);
  inputs.insert(inputs.end(), {options.out, options.write.path});
  keep_report_apart(options.report, inputs);
}

std::vector<report::FrameRange> frame_ranges(const CheckOptions& options) {
  std::vector<report::FrameRange> out;
  for (const std::string& text : options.frames) {
    report::FrameRange range;
    std::string error;
    if (!report::parse_range(text, range, error)) throw cli::UsageError("--frames", error);
    if (range.file == UINT32_MAX) {
      if (options.input.files.size() > 1) {
        throw cli::UsageError("--frames", fmt::format("of which file? 1:{} is of {}", text,
                                                      options.input.files.front()));
      }
      range.file = 0;
    }
    if (range.file >= options.input.files.size()) {
      throw cli::UsageError("--frames",
                            fmt::format("'{}': the run has {}", text,
                                        text::counted(options.input.files.size(), "file")));
    }
    for (const report::FrameRange& other : out) {
      if (other.file == range.file) {
        throw cli::UsageError("--frames", fmt::format("'{}': one range for each file", text));
      }
    }
    out.push_back(range);
  }
  return out;
}

report::KnownFailures expectations(const CheckOptions& options) {
  const std::string& path = options.expect;
  if (path.empty()) return {};
  const std::string text = cli::text_of_file(path);
  try {
    return report::parse_expectations(text, path);
  } catch (const std::runtime_error& mistake) {
    throw cli::UsageError("--expect", mistake.what());
  }
}

check::AlignOptions align_options(const CheckOptions& options) {
  check::AlignOptions out{.enabled = options.align == "auto"};
  out.skew_us = microseconds(options.skew_ms).value_or(out.skew_us);
  const trace::Statement stated = statement_of(options.stated);
  if (const std::int64_t* const ticks = find(stated, trace::ParameterId::kResponse)) {
    out.response_us = machine::us_of(static_cast<machine::Ticks>(*ticks));
  }
  out.response_us = microseconds(options.response_ms).value_or(out.response_us);
  return out;
}

bool is_log(const std::string& name) {
  // Data read from a pipe here would be missing later.
  std::error_code none;
  if (!std::filesystem::is_regular_file(name, none)) return false;
  std::ifstream file(name, std::ios::binary);
  std::string start(kLogLook, '\0');
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(file.gcount()));
  return check::looks_like_trace(start);
}

std::string command_of(const CheckOptions& options) {
  std::string out = "rubric check";
  const auto add = [&](const char* name, const std::string& value) {
    out += fmt::format(" {} {}", name, text::shell_word(value));
  };
  if (options.profile != "paper") add("--profile", options.profile);
  for (const std::string& node : options.nodes) add("--node", node);
  for (const std::string& sink : options.sinks) add("--sink", sink);
  if (options.sniffer != "unknown") add("--sniffer", options.sniffer);
  if (options.start != "unknown") add("--start", options.start);
  for (const std::string& tester : options.testers) add("--tester", tester);
  for (const std::string& one : options.stated) add("--state", one);
  if (options.response_ms) add("--response", fmt::format("{}", *options.response_ms));
  if (options.ack_timeout_ms) add("--ack-timeout", fmt::format("{}", *options.ack_timeout_ms));
  if (options.skew_ms) add("--skew", fmt::format("{}", *options.skew_ms));
  if (options.align != "auto") add("--align", options.align);
  if (options.input.format != "auto") add("--input-format", options.input.format);
  if (options.input.fcs != "auto") add("--fcs", options.input.fcs);
  for (const std::string& link : options.input.links) add("--link-type", link);
  return out;
}

report::TextOptions text_options(const CheckOptions& options, int fd) {
  report::TextOptions text;
  text.width = cli::columns(options.width, fd);
  text.color = cli::use_color(options.color, fd);
  text.verbose = options.verbose;
  text.findings_max = options.findings_max;
  return text;
}

}  // namespace rubric::tools
