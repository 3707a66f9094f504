// Options of `rubric check`, and their use by the judge.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "conformance/check/input/read.h"
#include "conformance/check/observation.h"
#include "conformance/check/report/expect.h"
#include "conformance/check/report/text.h"
#include "conformance/check/report/window.h"
#include "tools/cli/each.h"
#include "tools/cli/input.h"
#include "tools/cli/write_options.h"

namespace rubric::tools {

constexpr const char* kCheckCommand = "check";

struct CheckOptions {
  cli::InputOptions input;
  std::string profile = "paper";
  std::string format = "text";
  std::string expect;
  std::string out = "-";
  std::string report;  ///< A folder; empty: none.
  std::string color = "auto";
  std::string sniffer = "unknown";
  std::string start = "unknown";
  std::string align = "auto";
  std::vector<std::string> nodes;
  std::vector<std::string> sinks;
  std::vector<std::string> frames;
  std::vector<std::string> testers;
  std::vector<std::string> stated;
  std::optional<double> response_ms;
  std::optional<double> ack_timeout_ms;
  std::optional<double> skew_ms;
  std::optional<double> keep_minutes;
  std::size_t width = 0;
  bool verbose = false;
  std::size_t findings_max = 20;
  cli::EachOptions each;
  cli::WriteOptions write;  ///< A capture of what lines in use send.
};

/// Returns the judge's options. Throws cli::UsageError, as the next two do.
check::Options oracle_options(const CheckOptions& options);
std::vector<report::FrameRange> frame_ranges(const CheckOptions& options);
/// What the file --expect names says; nothing without it.
report::KnownFailures expectations(const CheckOptions& options);

/// Throws cli::UsageError if an output is one of the files that are read.
void keep_outputs_apart(const CheckOptions& options);

/// Returns how clocks are put together.
check::AlignOptions align_options(const CheckOptions& options);
/// Returns whether there is a file of that name with an .rtr log in it.
bool is_log(const std::string& name);

/// Returns the options that a verdict depends on, so that the command can be repeated.
std::string command_of(const CheckOptions& options);
/// Returns how text goes to `fd`, -1 for a file; without the command and the judge.
report::TextOptions text_options(const CheckOptions& options, int fd);

}  // namespace rubric::tools
