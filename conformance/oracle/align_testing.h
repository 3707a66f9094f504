// One capture as two files, recorded apart, for tests: the air, and the serial lines with another
// clock or none.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "codec/containers/reader.h"
#include "codec/containers/writer.h"
#include "codec/generated/requirements_table.h"
#include "conformance/oracle/judge.h"
#include "conformance/oracle/read.h"

namespace rubric::oracle {

/// How the serial lines were recorded.
struct SerialClock {
  double ahead_s = 0;
  double drift_ppm = 0;
  bool stamps = true;
  double begin_s = 0;       ///< Into the run; nothing before is in the serial file.
  double lost = 0;          ///< Part of all frames that neither file has.
  std::uint64_t seed = 1;   ///< Of the loss.
  double base_s = 1'000'000'000;  ///< What both clocks show at the start of the run.
};

/// The files, and the same frames in one file by one clock.
struct Apart {
  std::string radio;
  std::string serial;
  std::string whole;
  std::vector<std::uint64_t> radio_frame{0};   ///< Number in `whole` by number in the part.
  std::vector<std::uint64_t> serial_frame{0};
};

inline Apart take_apart(std::string_view pcapng, const SerialClock& clock) {
  constexpr double kNs = 1e9;
  Apart out;
  PcapngWriter radio;
  PcapngWriter whole;
  PcapngWriter timed;
  HdlcWriter raw;
  Writer& serial = clock.stamps ? static_cast<Writer&>(timed) : static_cast<Writer&>(raw);
  radio.begin(out.radio);
  whole.begin(out.whole);
  serial.begin(out.serial);
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
    if (on_air) {
      radio.write(now, name, out.radio);
      out.radio_frame.push_back(frames);
      return;
    }
    now.time_ns += std::llround(clock.ahead_s * kNs + at_s * clock.drift_ppm * 1000);
    serial.write(now, name, out.serial);
    out.serial_frame.push_back(frames);
  };
  reader->feed({reinterpret_cast<const std::uint8_t*>(pcapng.data()), pcapng.size()},
               PacketSink(take));
  reader->finish(PacketSink(take));
  radio.finish(out.radio);
  whole.finish(out.whole);
  serial.finish(out.serial);
  return out;
}

/// Both files as one run.
inline Run put_together(const Apart& parts, const AlignOptions& options = {},
                        bool serial_first = false) {
  ReadAs as;
  as.align = options;
  RunReader reader(as);
  std::string error;
  if (serial_first) reader.add_bytes("serial", parts.serial, error);
  reader.add_bytes("radio", parts.radio, error);
  if (!serial_first) reader.add_bytes("serial", parts.serial, error);
  return reader.finish();
}
inline Run whole_run(const Apart& parts) {
  RunReader reader;
  std::string error;
  reader.add_bytes("whole", parts.whole, error);
  return reader.finish();
}

/// Findings as "N6-FORWARD fail 17 sink of island 11", the frame numbered as in the whole.
inline std::multiset<std::string> findings_of(const Report& report, const Apart* parts,
                                              bool fails_only) {
  constexpr const char* kSeverities[] = {"note", "weak", "stray", "inconclusive", "fail"};
  std::multiset<std::string> out;
  for (const Finding& finding : report.findings) {
    if (fails_only && finding.severity != Severity::kFail) continue;
    std::uint64_t frame = finding.place.frame;
    if (parts != nullptr) {
      frame = (finding.place.file == 0 ? parts->radio_frame : parts->serial_frame).at(frame);
    }
    out.insert(std::string(kRequirements[static_cast<std::size_t>(finding.requirement)].id) + " " +
               kSeverities[static_cast<std::size_t>(finding.severity)] + " " +
               std::to_string(frame) + " " + finding.node);
  }
  return out;
}

/// The sentence of Run::facts on how `file` was aligned; empty where there is none.
inline std::string aligned_fact(const Run& run, const std::string& file = "serial") {
  for (const std::string& fact : run.facts) {
    if (fact.starts_with(file + " is ") && fact.find("aligned with") != fact.npos) return fact;
  }
  return {};
}

}  // namespace rubric::oracle
