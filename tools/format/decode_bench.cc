// Measures how fast a serial line becomes JSON lines, step by step, compared with memcpy of the
// same bytes in the same run. Run it from the project's folder: it reads spec/captures.
#include <benchmark/benchmark.h>
#include <time.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "codec/containers/reader.h"
#include "codec/generated/rubicon/rubicon.h"
#include "codec/reflect/frame.h"
#include "codec/reflect/registry.h"
#include "tools/cli/specs.h"
#include "tools/format/filter.h"
#include "tools/format/jsonl.h"
#include "tools/format/text.h"

namespace rubric {
namespace {

constexpr std::size_t kStreamBytes = 32 * 1024 * 1024;
constexpr std::size_t kChunkBytes = 256 * 1024;
constexpr std::size_t kOutputBytes = 192 * 1024;

// Returns frames of real sinks, repeated.
const std::string& stream() {
  static const std::string repeated = [] {
    std::string once;
    for (const auto& entry : std::filesystem::directory_iterator("spec/captures/firmware")) {
      if (!entry.path().string().ends_with(".serial.bin")) continue;
      std::ifstream file(entry.path(), std::ios::binary);
      once.append(std::istreambuf_iterator<char>(file), {});
    }
    std::string all;
    while (!once.empty() && all.size() < kStreamBytes) all += once;
    return all;
  }();
  return repeated;
}

Bytes stream_bytes() {
  return Bytes(reinterpret_cast<const std::uint8_t*>(stream().data()), stream().size());
}

// Returns the time of this thread alone: others may be busy here.
double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Returns the time of copying so many bytes from memory to memory.
double seconds_of_memcpy(std::size_t bytes) {
  static std::map<std::size_t, double> known;
  const auto [found, is_new] = known.try_emplace(bytes, 1e9);
  if (!is_new) return found->second;
  const std::vector<char> from(bytes, 'x');
  std::vector<char> copy(bytes);
  for (int i = 0; i < 10; ++i) {
    const double start = cpu_seconds();
    std::memcpy(copy.data(), from.data(), bytes);
    benchmark::ClobberMemory();
    found->second = std::min(found->second, cpu_seconds() - start);
  }
  return found->second;
}

/// Feeds the stream to `take` and measures the cost; returns the seconds of one run.
template <class Take>
double run(benchmark::State& state, Take take) {
  if (stream().empty()) {
    state.SkipWithError("spec/captures/firmware has no captures");
    return 0;
  }
  const double copy_seconds = seconds_of_memcpy(stream().size());
  std::int64_t frames = 0;
  std::int64_t runs = 0;
  double seconds = 0;
  for (auto _ : state) {
    const double start = cpu_seconds();
    const std::unique_ptr<Reader> reader = make_reader(InputFormat::kHdlc);
    auto sink = [&](const Packet& packet) {
      ++frames;
      take(packet);
    };
    const Bytes all = stream_bytes();
    for (std::size_t at = 0; at < all.size(); at += kChunkBytes) {
      reader->feed(all.sub(at, std::min(kChunkBytes, all.size() - at)), sink);
    }
    reader->finish(sink);
    seconds += cpu_seconds() - start;
    ++runs;
  }
  state.SetBytesProcessed(runs * static_cast<std::int64_t>(stream().size()));
  state.counters["frames/s"] =
      benchmark::Counter(static_cast<double>(frames), benchmark::Counter::kIsRate);
  seconds /= static_cast<double>(runs);
  state.counters["x_memcpy"] = seconds / copy_seconds;
  return seconds;
}

void deframe(benchmark::State& state) {
  std::uint64_t sum = 0;
  run(state, [&](const Packet& packet) { sum += packet.bytes.size(); });
  benchmark::DoNotOptimize(sum);
}

// Validates down to the body of the message, by the generated views.
bool valid_to_the_body(Bytes bytes) {
  const auto packet = rubicon::RubiconView::parse(bytes);
  if (!packet) return false;
  if (packet->payload_kind() != rubicon::RubiconView::PayloadKind::kNetMsg) return true;
  const rubicon::NetMsgView message = packet->payload_as_net_msg();
  if (message.payload_kind() != rubicon::NetMsgView::PayloadKind::kAppMsg) return true;
  using Body = rubicon::AppMsgView::BodyKind;
  return message.payload_as_app_msg().body_kind() != Body::kOpaque;
}

void deframe_validate(benchmark::State& state) {
  std::uint64_t valid = 0;
  run(state, [&](const Packet& packet) { valid += valid_to_the_body(packet.bytes); });
  benchmark::DoNotOptimize(valid);
}

const reflect::Protocol& built_in() { return *reflect::find_protocol("rubicon"); }
// The same, as `--spec FILE` has it.
const reflect::Protocol& run_time() { return cli::protocol_of("spec/wire/rubicon.ksy"); }

void decode_by(const reflect::Protocol& protocol, benchmark::State& state) {
  const reflect::FrameDecoder decoder(protocol);
  reflect::Frame frame;
  std::uint64_t nodes = 0;
  run(state, [&](const Packet& packet) {
    decoder.decode(packet, frame);
    nodes += frame.decoded.node_count();
  });
  benchmark::DoNotOptimize(nodes);
}

void deframe_decode(benchmark::State& state) { decode_by(built_in(), state); }
void run_time_decode(benchmark::State& state) { decode_by(run_time(), state); }

template <class MakeFormatter>
void print(const reflect::Protocol& protocol, benchmark::State& state, MakeFormatter make) {
  const reflect::FrameDecoder decoder(protocol);
  auto formatter = make(protocol);
  reflect::Frame frame;
  format::Record record;
  format::Buffer out;
  std::uint64_t written = 0;
  const double seconds = run(state, [&](const Packet& packet) {
    decoder.decode(packet, frame);
    record.frame = &frame;
    ++record.index;
    formatter.print(record, out);
    if (out.size() >= kOutputBytes) {
      written += out.size();
      out.clear();
    }
  });
  written = (written + out.size()) / static_cast<std::uint64_t>(state.iterations());
  if (written > 0) state.counters["x_copy"] = seconds / seconds_of_memcpy(written);
}

void jsonl_by(const reflect::Protocol& protocol, benchmark::State& state) {
  print(protocol, state,
        [](const reflect::Protocol& p) { return format::JsonlFormatter(p, false); });
}
void text_by(const reflect::Protocol& protocol, benchmark::State& state) {
  print(protocol, state,
        [](const reflect::Protocol& p) { return format::TextFormatter(p, format::TextOptions{}); });
}

void jsonl(benchmark::State& state) { jsonl_by(built_in(), state); }
void run_time_jsonl(benchmark::State& state) { jsonl_by(run_time(), state); }
void text(benchmark::State& state) { text_by(built_in(), state); }
void run_time_text(benchmark::State& state) { text_by(run_time(), state); }

void filter(benchmark::State& state) {
  const reflect::Protocol& protocol = built_in();
  const reflect::FrameDecoder decoder(protocol);
  const format::Filter expression("message==updates && src.devid==4", protocol);
  reflect::Frame frame;
  format::Record record;
  std::uint64_t matches = 0;
  run(state, [&](const Packet& packet) {
    decoder.decode(packet, frame);
    record.frame = &frame;
    matches += expression.matches(record);
  });
  benchmark::DoNotOptimize(matches);
}

BENCHMARK(deframe);
BENCHMARK(deframe_validate);
BENCHMARK(deframe_decode);
BENCHMARK(jsonl);
BENCHMARK(text);
BENCHMARK(run_time_decode);
BENCHMARK(run_time_jsonl);
BENCHMARK(run_time_text);
BENCHMARK(filter);

}  // namespace
}  // namespace rubric
