#include <fmt/format.h>

#include <memory>

#include "codec/reflect/frame.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/input.h"
#include "tools/cli/output.h"
#include "tools/cli/specs.h"
#include "tools/commands/commands.h"
#include "tools/commands/stats/counters.h"
#include "tools/commands/stats/report.h"

namespace rubric::tools {
namespace {

struct StatsOptions {
  cli::InputOptions input;
  std::string format = "text";
};

constexpr const char* kStatsFooter =
    "A gap is the time between neighbouring frames of one file. A frame counts as repeated if the\n"
    "one before it with the same addresses, message and interface had the same seq_num.\n"
    "A line in use, and with --follow a file that grows, is counted until Ctrl-C.\n"
    "Exit codes: 0 clean, 1 malformed frames were seen, 64 usage, 66 an input is missing or\n"
    "damaged (what can be read of all inputs is counted), 74 output cannot be written.";

int run_stats(const StatsOptions& options) {
  const reflect::Protocol& protocol = cli::chosen_protocol(options.input);
  const reflect::FrameDecoder decoder(protocol, cli::chosen_message(options.input, protocol));
  cli::OtherSpecs others(protocol);
  reflect::Frame frame;
  stats::Counters counters;
  std::uint64_t index = 0;
  const cli::InputResult result =
      cli::read_packets(options.input, [&](const Packet& packet, const cli::Source& source) {
        decoder.decode(packet, frame);
        others.look(frame);
        counters.take(frame, {source.file, source.interface_name, index++, source.number});
        return true;
      });
  cli::Output output;
  output.buffer().append(options.format == "json" ? stats::json_report(counters)
                                                  : stats::text_report(counters));
  if (!output.finish()) return cli::kExitOutput;
  if (result.failed) return cli::kExitInput;
  return counters.all().malformed ? cli::kExitFindings : cli::kExitClean;
}

}  // namespace

void add_stats(cli::Command& app) {
  auto options = std::make_shared<StatsOptions>();
  options->input.prints = false;
  cli::Command& sub = app.add_subcommand(
      "stats", "Count frames by message, addresses and fault; find rates, gaps and repetitions");
  sub.footer(kStatsFooter);
  cli::add_input_options(sub, options->input);
  cli::add_live_options(sub, options->input);
  sub.add_option("--format", options->format, "Print text or json").one_of({"text", "json"});
  sub.exit_code_of([options] { return run_stats(*options); });
}

}  // namespace rubric::tools
