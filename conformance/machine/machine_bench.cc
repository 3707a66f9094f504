// Measures how many events a second one core steps through: a mote and its sink join, exchange data
// with acks, and reboot; and parts of that alone.
#include <benchmark/benchmark.h>

#include "conformance/machine/step.h"

namespace rubric::machine {
namespace {

constexpr std::uint8_t kReading[] = {34, 0, 1, 2, 3, 4, 5, 6, 7, 8};

/// A mote in range of its sink, whose base station takes everything and sends nothing.
class Pair {
 public:
  Pair() : mote_(start(mote())), sink_(start(sink())) {}

  void join() {
    step(mote_, now_, Called{JoinIsland{{1, 1, 0x43}}}, from_mote_);
    to_sink();  // join_request, answered by join_reply,
    to_mote();  // answered by ack_join,
    to_sink();  // announced and reported.
    step(sink_, now_, SendDone{Link::kSerial, true}, from_sink_);
    ++events_;
  }
  /// Sends a reliable message from the mote and its ack.
  void exchange() {
    now_ += 2;
    step(mote_, now_, Called{Send{{11, 1}, 5, true, kReading}}, from_mote_);
    to_sink();
    to_mote();
  }
  /// Sends a message that the sink passes up to its base station.
  void forward() {
    now_ += 2;
    step(mote_, now_, Called{Send{{11, kNullDevid}, 5, false, kReading}}, from_mote_);
    to_sink();
    step(sink_, now_, SendDone{Link::kSerial, true}, from_sink_);
    ++events_;
  }
  void reboot() {
    step(mote_, now_, Reboot{}, from_mote_);
    step(sink_, now_, Reboot{}, from_sink_);
    events_ += 2;
  }
  std::int64_t events() const { return events_; }
  bool all_acked() const { return mote_.awaited.empty(); }
  bool joined() const { return mote_.join.phase == JoinMote::Phase::kMember; }
  State& node() { return mote_; }

 private:
  static Config mote() { return {.id = 2}; }
  static Config sink() { return {.role = Role::kSink, .id = 1, .island = 11}; }
  void to_sink() {
    const Transmit& frame = from_mote_.transmits()[0];
    step(sink_, now_, Heard{frame.frame()}, from_sink_);
    step(mote_, now_, SendDone{Link::kRadio, true}, done_);
    events_ += 3;  // And the step that sent it.
  }
  void to_mote() {
    const Transmit& frame = from_sink_.transmits()[0];
    step(mote_, now_, Heard{frame.frame()}, from_mote_);
    step(sink_, now_, SendDone{Link::kRadio, true}, done_);
    events_ += 2;
  }

  State mote_;
  State sink_;
  Ticks now_ = 0;
  Actions from_mote_, from_sink_, done_;
  std::int64_t events_ = 0;
};

// Measures a join, then ten reliable messages with their acks and ten readings for the PC.
void BM_MixedTraffic(benchmark::State& bench) {
  Pair pair;
  for (auto _ : bench) {
    pair.join();
    if (!pair.joined()) return bench.SkipWithError("no join");
    for (int i = 0; i < 10; ++i) {
      pair.exchange();
      pair.forward();
    }
    pair.reboot();
  }
  bench.SetItemsProcessed(pair.events());
}
BENCHMARK(BM_MixedTraffic);

void BM_Join(benchmark::State& bench) {
  Pair pair;
  for (auto _ : bench) {
    pair.join();
    pair.reboot();
  }
  bench.SetItemsProcessed(pair.events());
}
BENCHMARK(BM_Join);

void BM_ReliableExchange(benchmark::State& bench) {
  Pair pair;
  pair.join();
  for (auto _ : bench) pair.exchange();
  if (!pair.all_acked()) return bench.SkipWithError("acks are missing");
  bench.SetItemsProcessed(pair.events());
}
BENCHMARK(BM_ReliableExchange);

void BM_Hash(benchmark::State& bench) {
  Pair pair;
  pair.join();
  for (auto _ : bench) benchmark::DoNotOptimize(hash_value(pair.node()));
  bench.SetItemsProcessed(bench.iterations());
}
BENCHMARK(BM_Hash);

void BM_Equal(benchmark::State& bench) {
  Pair pair;
  pair.join();
  const State other = pair.node();
  for (auto _ : bench) benchmark::DoNotOptimize(pair.node() == other);
  bench.SetItemsProcessed(bench.iterations());
}
BENCHMARK(BM_Equal);

}  // namespace
}  // namespace rubric::machine
