// Measures how many frames a second one core judges: a clean capture of a network of twelve motes
// and two sinks, read and judged, and judged alone.
#include <benchmark/benchmark.h>

#include <string>
#include <utility>

#include "conformance/check/input/read.h"
#include "conformance/check/observation.h"
#include "conformance/simulate/recorder.h"
#include "conformance/simulate/scenarios.h"
#include "conformance/simulate/simulation.h"

namespace rubric::check {
namespace {

constexpr std::uint64_t kFrames = 1'000'000;
constexpr simulate::Micros kSliceUs = 60'000'000;

const std::string& capture() {
  static const std::string bytes = [] {
    const simulate::Scenario& scenario = *simulate::find_scenario("free");
    simulate::Network network = simulate::make_network(scenario, {1, 0.01, 0, 12, 2});
    simulate::CaptureRecorder recorder(network);
    simulate::Simulation simulation(std::move(network), {&recorder});
    const simulate::Statistics& done = simulation.statistics();
    for (simulate::Micros end = kSliceUs; done.radio_frames + done.serial_frames < kFrames;
         end += kSliceUs) {
      simulation.run_until(end);
    }
    return recorder.finish();
  }();
  return bytes;
}

bool read_capture(benchmark::State& state, Run& run) {
  RunReader reader;
  std::string error;
  if (!reader.add_bytes("capture", capture(), error)) {
    state.SkipWithError(error.c_str());
    return false;
  }
  run = reader.finish();
  return true;
}

// Returns the number of judged frames; 0 if something failed.
std::uint64_t judged(benchmark::State& state, const Run& run) {
  Options options;
  options.sniffer_complete = options.start_cold = true;
  const Report report = judge(run, options);
  if (report.verdict == Verdict::kFail) state.SkipWithError("a clean capture failed");
  return report.verdict == Verdict::kFail ? 0 : report.frames;
}

void BM_ReadAndJudge(benchmark::State& state) {
  std::uint64_t frames = 0;
  capture();
  for (auto _ : state) {
    Run run;
    if (!read_capture(state, run)) return;
    const std::uint64_t count = judged(state, run);
    if (count == 0) return;
    frames += count;
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(frames));
}
BENCHMARK(BM_ReadAndJudge)->Unit(benchmark::kMillisecond);

void BM_Judge(benchmark::State& state) {
  Run run;
  if (!read_capture(state, run)) return;
  std::uint64_t frames = 0;
  for (auto _ : state) {
    const std::uint64_t count = judged(state, run);
    if (count == 0) return;
    frames += count;
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(frames));
}
BENCHMARK(BM_Judge)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rubric::check
