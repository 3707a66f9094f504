#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "codec/text/text.h"
#include "conformance/simulate/recorder.h"
#include "conformance/simulate/scenarios.h"
#include "conformance/simulate/simulation.h"
#include "conformance/trace/print.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/input.h"
#include "tools/cli/output.h"
#include "tools/commands/commands.h"

namespace rubric::tools {
namespace {

using simulate::Scenario;
using simulate::Statistics;

constexpr const char* kFree = "free";

struct SimulateOptions {
  simulate::ScenarioOptions network;
  std::string scenario = kFree;
  double seconds = 0;  ///< 0: as long as the scenario's story.
  std::string rtr;
  std::string pcapng;
};

std::string simulate_footer() {
  std::string text =
      "For RUBICON alone, of whose reference machine the nodes are made.\nScenarios:\n";
  for (const Scenario& scenario : simulate::scenarios()) {
    text += fmt::format("  {:<13} {} ({} s)\n", scenario.name, scenario.doc,
                        scenario.length_us / simulate::kUsPerSecond);
  }
  return text +
         "The same options give the same run, byte for byte.\n"
         "Examples:\n"
         "  rubric simulate --scenario timeline --out-pcapng run.pcapng --out-rtr run.rtr\n"
         "  rubric simulate --motes 12 --sinks 2 --loss 0.1 --seed 7 --seconds 60 --out-rtr -\n"
         "Exit codes: 0 done, 64 usage, 74 output cannot be written.";
}

std::string summary(const Statistics& s) {
  return fmt::format(
      "joins              {:>8}   failed {}\n"
      "delivered          {:>8}\n"
      "acks               {:>8}   missed {}\n"
      "synaptic data new  {:>8}   old {}, of unknown channels {}\n"
      "radio frames       {:>8}   link acks {}\n"
      "  receptions lost  {:>8}   collided {}, doubled {}, receiver off {}\n"
      "serial frames      {:>8}\n"
      "PEIS messages      {:>8}\n",
      s.joins, s.join_failures, s.received, s.acks, s.ack_failures, s.synaptic_new, s.synaptic_old,
      s.synaptic_unknown, s.radio_frames, s.link_acks, s.lost, s.collided, s.doubled, s.unheard,
      s.serial_frames, s.peis_messages);
}

void run_simulate(const SimulateOptions& options) {
  cli::keep_apart("--out-pcapng", options.pcapng, {options.rtr});
  const Scenario& scenario = *simulate::find_scenario(options.scenario);
  const auto length_us =
      options.seconds == 0
          ? scenario.length_us
          : static_cast<simulate::Micros>(options.seconds * simulate::kUsPerSecond);
  simulate::Network network = simulate::make_network(scenario, options.network);
  std::optional<simulate::CaptureRecorder> capture;
  std::optional<simulate::TraceRecorder> log;
  std::vector<simulate::Recorder*> recorders;
  if (!options.pcapng.empty()) recorders.push_back(&capture.emplace(network));
  if (!options.rtr.empty()) recorders.push_back(&log.emplace(network, scenario.name));
  simulate::Simulation simulation(std::move(network), recorders);
  simulation.run_until(length_us);
  bool good = true;
  if (log) good = cli::write_file(options.rtr, trace::print(log->file()));
  if (capture) good = cli::write_file(options.pcapng, capture->finish()) && good;
  const bool taken = options.rtr == "-" || options.pcapng == "-";
  text::print_harmless(taken ? stderr : stdout, summary(simulation.statistics()));
  if (!good) cli::exit_with(cli::kExitOutput);
}

std::vector<std::string> scenario_names() {
  std::vector<std::string> names;
  for (const Scenario& scenario : simulate::scenarios()) names.emplace_back(scenario.name);
  return names;
}

}  // namespace

void add_simulate(cli::Command& app) {
  constexpr std::size_t kMotesMax = 200;  // Anchors have the addresses above.
  constexpr std::size_t kSinksMax = 26;   // A letter distinguishes each island.
  constexpr double kSecondsMax = 86'400;
  auto options = std::make_shared<SimulateOptions>();
  cli::Command& sub = app.add_subcommand("simulate", "Run a network of reference machines");
  sub.footer(simulate_footer());
  const cli::Option motes =
      sub.add_option("--motes", options->network.motes, "Run this many motes, in scenario free")
          .between(std::size_t{0}, kMotesMax);
  const cli::Option sinks =
      sub.add_option("--sinks", options->network.sinks, "Run this many sinks, in scenario free")
          .between(std::size_t{0}, kSinksMax);
  sub.add_option("--seed", options->network.seed, "Seed all that is left to chance")
      .check(cli::whole_number);
  sub.add_option("--loss", options->network.loss,
                 "Let a receiver miss a radio frame with this probability")
      .between(0.0, 1.0);
  sub.add_option("--dup", options->network.duplication,
                 "Let a receiver get a radio frame twice with this probability: the sender's link "
                 "repeats it on the air")
      .between(0.0, 1.0);
  sub.add_option("--seconds", options->seconds, "Run for this long (default: as the scenario says)")
      .between(0.001, kSecondsMax);
  sub.add_option("--scenario", options->scenario, "Run this network").one_of(scenario_names());
  sub.add_option("--out-rtr", options->rtr, "Write a log of every node; - is stdout");
  sub.add_option("--out-pcapng", options->pcapng,
                 "Write a capture of the radio and of the serial lines; - is stdout");
  sub.callback([options, motes, sinks] {
    if (options->scenario != kFree && (motes.is_given() || sinks.is_given())) {
      throw cli::UsageError("--motes and --sinks are for scenario free; " + options->scenario +
                            " has its own");
    }
    if (options->rtr == "-" && options->pcapng == "-") {
      throw cli::UsageError("--out-rtr and --out-pcapng cannot both be stdout");
    }
    run_simulate(*options);
  });
}

}  // namespace rubric::tools
