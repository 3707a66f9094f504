// Measures how fast frames are found and checked, compared with memcpy of the same bytes in the
// same run.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "codec/containers/crc16_fast.h"
#include "codec/containers/hdlc_reader.h"
#include "codec/containers/writer.h"
#include "codec/runtime/crc16.h"
#include "codec/runtime/hdlc.h"

namespace rubric {
namespace {

// Contents of frames.
enum Traffic : std::int64_t {
  kSink,    // As from sinks: headers, readings, zeros; an escape in one frame of fourteen.
  kRandom,  // Every byte value alike: two frames in three have an escape.
};

// Frames of 125 bytes from kind to CRC, each between two flags of its own.
std::string make_stream(std::size_t size_bytes, Traffic traffic) {
  std::mt19937 random(1);
  std::string out;
  out.reserve(size_bytes + 512);
  HdlcWriter writer;
  std::uint8_t packet[122] = {0x00, 0xFF, 0xFF, 0, 0, 114, 0, 28, 0, 11, 0xFF, 0xFD, 0, 11, 0, 2};
  while (out.size() < size_bytes) {
    // A sink's frame has seven bytes that vary freely: sequence number and five readings.
    const std::size_t content_end = traffic == kRandom ? sizeof(packet) : 23;
    for (std::size_t i = 16; i < content_end; ++i) packet[i] = static_cast<std::uint8_t>(random());
    Packet out_packet{.framing = Framing::kSf, .bytes = packet};
    writer.write(out_packet, out);
  }
  return out;
}

const std::string& stream_of(std::size_t size_bytes, Traffic traffic) {
  static std::string cached;
  static std::size_t cached_size = 0;
  static Traffic cached_traffic = kSink;
  if (cached_size != size_bytes || cached_traffic != traffic) {
    cached = make_stream(size_bytes, traffic);
    cached_size = size_bytes;
    cached_traffic = traffic;
  }
  return cached;
}

void count(benchmark::State& state, const std::string& stream) {
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(stream.size()));
}

void memcpy_alone(benchmark::State& state) {
  const std::string& stream =
      stream_of(static_cast<std::size_t>(state.range(0)), static_cast<Traffic>(state.range(1)));
  std::vector<char> copy(stream.size());
  for (auto _ : state) {
    std::memcpy(copy.data(), stream.data(), stream.size());
    benchmark::ClobberMemory();
  }
  count(state, stream);
}

template <CpuPath kPath>
std::uint16_t crc_of(Bytes bytes) {
  if constexpr (kPath == CpuPath::kWide) return crc16_wide(bytes, 0);
  if constexpr (kPath == CpuPath::kVector) return crc16_vector(bytes, 0);
  return crc16_portable(bytes, 0);
}

// Computes only the check sums of frames whose places are known: the least that deframing costs.
template <CpuPath kPath>
void sums_alone(benchmark::State& state) {
  const std::string& stream =
      stream_of(static_cast<std::size_t>(state.range(0)), static_cast<Traffic>(state.range(1)));
  if (!cpu_has(kPath)) return state.SkipWithError("not on this processor");
  const auto* const data = reinterpret_cast<const std::uint8_t*>(stream.data());
  std::vector<Bytes> frames;
  for (std::size_t at = 0, end = 0; end != stream.npos; at = end + 1) {
    end = stream.find(static_cast<char>(kHdlcFlag), at);
    const std::size_t size = std::min(end, stream.size()) - at;
    if (size > kSerialCrcBytes) frames.emplace_back(data + at, size - kSerialCrcBytes);
  }
  std::uint64_t sum = 0;
  for (auto _ : state) {
    for (const Bytes frame : frames) sum += crc_of<kPath>(frame);
  }
  benchmark::DoNotOptimize(sum);
  count(state, stream);
}

template <CpuPath kPath>
void deframe(benchmark::State& state) {
  const std::string& stream =
      stream_of(static_cast<std::size_t>(state.range(0)), static_cast<Traffic>(state.range(1)));
  if (!cpu_has(kPath)) return state.SkipWithError("not on this processor");
  HdlcReader reader({}, kPath);
  std::uint64_t good = 0;
  std::uint64_t sum = 0;
  auto sink = [&](const Packet& packet) {
    good += packet.error.fault == Fault::kNone;
    sum += packet.bytes[0];
  };
  for (auto _ : state) {
    reader.feed(Bytes(reinterpret_cast<const std::uint8_t*>(stream.data()), stream.size()), sink);
    reader.finish(sink);
  }
  benchmark::DoNotOptimize(sum);
  count(state, stream);
  state.SetItemsProcessed(static_cast<std::int64_t>(good));
}

// Works like the TinyOS host tools: a byte at a time, CRC by shifts.
void deframe_bytewise(benchmark::State& state) {
  const std::string& stream =
      stream_of(static_cast<std::size_t>(state.range(0)), static_cast<Traffic>(state.range(1)));
  std::uint64_t good = 0;
  for (auto _ : state) {
    std::uint8_t buffer[256];
    std::size_t size = 0;
    bool escaping = false;
    for (const char c : stream) {
      auto byte = static_cast<std::uint8_t>(c);
      if (byte == kHdlcFlag) {
        if (size >= kSerialContentMin) {
          std::uint16_t crc = 0;
          for (std::size_t i = 0; i + 2 < size; ++i) crc = crc16_step(crc, buffer[i]);
          good += crc == load_le16(buffer + size - 2);
        }
        size = 0;
        escaping = false;
      } else if (byte == kHdlcEscape) {
        escaping = true;
      } else {
        if (escaping) byte ^= kHdlcXor;
        escaping = false;
        if (size < sizeof(buffer)) buffer[size++] = byte;
      }
    }
  }
  count(state, stream);
  state.SetItemsProcessed(static_cast<std::int64_t>(good));
}

constexpr std::int64_t kCached = 256 * 1024;       // Lies in the L2 cache.
constexpr std::int64_t kLarge = 64 * 1024 * 1024;  // Lies in no cache.

void sizes(benchmark::internal::Benchmark* bench) {
  for (std::int64_t size : {kCached, kLarge}) {
    for (std::int64_t traffic : {kSink, kRandom}) bench->Args({size, traffic});
  }
  bench->ArgNames({"bytes", "random"});
}

BENCHMARK(memcpy_alone)->Apply(sizes);
BENCHMARK(sums_alone<CpuPath::kWide>)->Apply(sizes);
BENCHMARK(sums_alone<CpuPath::kVector>)->Apply(sizes);
BENCHMARK(sums_alone<CpuPath::kPortable>)->Apply(sizes);
BENCHMARK(deframe<CpuPath::kWide>)->Apply(sizes);
BENCHMARK(deframe<CpuPath::kVector>)->Apply(sizes);
BENCHMARK(deframe<CpuPath::kPortable>)->Apply(sizes);
BENCHMARK(deframe_bytewise)->Apply(sizes);

}  // namespace
}  // namespace rubric
