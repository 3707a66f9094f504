// Splits one capture into files with clocks of their own, for tests: the air, and the serial lines
// with another clock or none.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <memory>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "codec/containers/reader.h"
#include "codec/containers/writer.h"
#include "codec/reflect/requirements.h"
#include "conformance/check/input/read.h"
#include "conformance/check/observation.h"
#include "conformance/check/tests/must_read.h"

namespace rubric::check {

/// Reads a capture of the firmware.
inline std::string capture(const std::string& name) {
  std::ifstream file("spec/captures/firmware/" + name + ".pcapng", std::ios::binary);
  EXPECT_TRUE(file) << name;
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// How the serial lines were recorded.
struct SerialClock {
  double ahead_s = 0;
  double drift_ppm = 0;
  bool stamps = true;
  double begin_s = 0;             ///< Into the run; nothing before is in the serial file.
  double lost = 0;                ///< Part of all frames that neither file has.
  std::uint64_t seed = 1;         ///< For the loss.
  double base_s = 1'000'000'000;  ///< Both clocks at the start of the run.
};

/// One file of a run.
struct Part {
  std::string name;
  std::string bytes;
  std::vector<std::uint64_t> frames{0};  ///< Number in the whole by number in this one.
};

/// The air, then the lines: all in one file, or each in its own without stamps. `whole` has the
/// same frames in one file by one clock.
struct Apart {
  std::vector<Part> parts;
  std::string whole;
};

inline Apart take_apart(std::string_view pcapng, const SerialClock& clock) {
  constexpr double kNs = 1e9;
  Apart out;
  PcapngWriter whole;
  whole.begin(out.whole);
  std::vector<std::unique_ptr<Writer>> writers;
  const auto part_of = [&](const std::string& name, InputFormat format) {
    const auto known = std::find_if(out.parts.begin(), out.parts.end(),
                                    [&](const Part& part) { return part.name == name; });
    const auto i = static_cast<std::size_t>(known - out.parts.begin());
    if (known == out.parts.end()) {
      out.parts.push_back({name, {}, {0}});
      writers.push_back(make_writer(format));
      writers.back()->begin(out.parts[i].bytes);
    }
    return i;
  };
  part_of("radio", InputFormat::kPcapng);
  std::mt19937_64 random(clock.seed);
  const std::unique_ptr<Reader> reader = make_reader(InputFormat::kPcapng, {});
  std::uint64_t frames = 0;
  auto take = [&](const Packet& packet) {
    const bool lost = static_cast<double>(random() % 1'000'000) < clock.lost * 1e6;
    const double at_s = static_cast<double>(packet.time_ns) / kNs;
    const bool on_air = packet.framing == Framing::kRadio;
    if (lost || (!on_air && at_s < clock.begin_s)) return;
    const std::string name = reader->interfaces()[packet.interface_id].name;
    Packet now = packet;
    now.time_ns = packet.time_ns + std::llround(clock.base_s * kNs);
    if (!whole.write(now, name, out.whole)) return;
    ++frames;
    std::size_t i = 0;
    if (!on_air) {
      now.time_ns += std::llround(clock.ahead_s * kNs + at_s * clock.drift_ppm * 1000);
      i = clock.stamps ? part_of("serial", InputFormat::kPcapng)
                       : part_of(name, InputFormat::kHdlc);
    }
    writers[i]->write(now, name, out.parts[i].bytes);
    out.parts[i].frames.push_back(frames);
  };
  reader->feed({reinterpret_cast<const std::uint8_t*>(pcapng.data()), pcapng.size()},
               PacketSink(take));
  reader->finish(PacketSink(take));
  whole.finish(out.whole);
  for (std::size_t i = 0; i < writers.size(); ++i) writers[i]->finish(out.parts[i].bytes);
  return out;
}

/// Returns the frames of one interface of a pcapng file as a file of its own.
inline Part only_interface(std::string_view pcapng, const std::string& name) {
  Part out{name, {}, {0}};
  PcapngWriter writer;
  writer.begin(out.bytes);
  const std::unique_ptr<Reader> reader = make_reader(InputFormat::kPcapng, {});
  auto take = [&](const Packet& packet) {
    if (reader->interfaces()[packet.interface_id].name != name) return;
    writer.write(packet, name, out.bytes);
  };
  reader->feed({reinterpret_cast<const std::uint8_t*>(pcapng.data()), pcapng.size()},
               PacketSink(take));
  reader->finish(PacketSink(take));
  writer.finish(out.bytes);
  return out;
}

/// Reads the files as one run.
inline Run put_together(const Apart& apart, const AlignOptions& options = {}) {
  RunReader reader(options);
  std::string error;
  for (const Part& part : apart.parts) reader.add_bytes(part.name, part.bytes, error);
  return reader.finish();
}
inline Run whole_run(const Apart& apart) { return must_read("whole", apart.whole); }

/// Returns findings as "N6-FORWARD fail 17 sink of island 11", with frame numbers of the whole.
inline std::multiset<std::string> findings_of(const Report& report, const Apart* apart,
                                              bool fails_only) {
  constexpr const char* kSeverities[] = {"note", "weak", "stray", "inconclusive", "fail"};
  std::multiset<std::string> out;
  for (const Finding& finding : report.findings) {
    if (fails_only && finding.severity != Severity::kFail) continue;
    std::uint64_t frame = finding.place.frame;
    if (apart != nullptr) frame = apart->parts[finding.place.file].frames.at(frame);
    out.insert(std::string(reflect::requirement(finding.requirement).id) + " " +
               kSeverities[static_cast<std::size_t>(finding.severity)] + " " +
               std::to_string(frame) + " " + finding.node);
  }
  return out;
}

/// Returns the fact about the alignment, or an empty text if there was nothing to do.
inline std::string aligned_fact(const Run& run) {
  for (const std::string& fact : run.facts) {
    if (fact.find("aligned with") != fact.npos || fact.find("in order with") != fact.npos) {
      return fact;
    }
  }
  return {};
}

}  // namespace rubric::check
