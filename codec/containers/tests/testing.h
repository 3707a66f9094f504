// Helpers of the tests of readers and writers.
#pragma once

#include <algorithm>
#include <fstream>
#include <iterator>
#include <ostream>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "codec/containers/crc16_fast.h"
#include "codec/containers/reader.h"
#include "codec/containers/writer.h"

namespace rubric::testing {

inline constexpr Error kSound{Fault::kNone, 0, ReqId::kNone};
inline constexpr CpuPath kPaths[] = {CpuPath::kPortable, CpuPath::kVector, CpuPath::kWide};

inline Bytes view(const std::string& text) {
  return Bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
}

/// Returns the bytes of hex digits; skips blanks.
inline std::string from_hex(std::string_view text) {
  std::string out;
  std::string digits;
  for (char c : text) {
    if (c == ' ' || c == '\n') continue;
    digits += c;
    if (digits.size() < 2) continue;
    out += static_cast<char>(std::stoi(digits, nullptr, 16));
    digits.clear();
  }
  return out;
}

inline std::string to_hex(Bytes bytes) {
  std::string out;
  for (std::uint8_t byte : bytes) {
    out += "0123456789abcdef"[byte >> 4];
    out += "0123456789abcdef"[byte & 15];
  }
  return out;
}

inline std::string read_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Returns the facts that a writer keeps.
inline RadioFacts kept_facts(RadioFacts facts) {
  facts.more = false;
  return facts;
}

/// A packet that outlives its callback, comparable in every field.
struct Kept {
  Packet packet;  // Its bytes and comment point into the strings below.
  std::string bytes;
  std::string comment;

  explicit Kept(const Packet& from)
      : packet(from), bytes(from.bytes.begin(), from.bytes.end()), comment(from.comment) {}
  Packet get() const {
    Packet out = packet;
    out.bytes = view(bytes);
    out.comment = comment;
    return out;
  }
  friend bool operator==(const Kept& a, const Kept& b) {
    const Packet& p = a.packet;
    const Packet& q = b.packet;
    return a.bytes == b.bytes && a.comment == b.comment && p.framing == q.framing &&
           p.direction == q.direction && p.offset_bytes == q.offset_bytes &&
           p.time_ns == q.time_ns && p.interface_id == q.interface_id &&
           p.link_type == q.link_type && p.kind == q.kind && p.serial_seq == q.serial_seq &&
           p.crc == q.crc && p.fcs == q.fcs && p.error == q.error &&
           p.dropped_bytes == q.dropped_bytes && kept_facts(p.radio) == kept_facts(q.radio);
  }
  friend std::ostream& operator<<(std::ostream& out, const Kept& k) {
    const Packet& p = k.packet;
    return out << "framing " << static_cast<int>(p.framing) << " direction "
               << static_cast<int>(p.direction) << " offset " << p.offset_bytes << " time "
               << p.time_ns << " interface " << p.interface_id << " link " << p.link_type
               << " kind " << p.kind << " seq " << p.serial_seq << " crc " << p.crc << " fcs "
               << p.fcs << " fault " << static_cast<int>(p.error.fault) << "@"
               << p.error.offset_bytes << " rule " << static_cast<int>(p.error.requirement)
               << " dropped " << p.dropped_bytes << " bytes " << to_hex(view(k.bytes)) << "\n";
  }
};

/// Returns everything that `reader` makes of `input`, fed whole.
inline std::vector<Kept> read_all(Reader& reader, Bytes input) {
  std::vector<Kept> kept;
  auto sink = [&](const Packet& packet) { kept.emplace_back(packet); };
  reader.feed(input, sink);
  reader.finish(sink);
  return kept;
}

/// Returns the same, fed in random pieces; each is its own heap block, gone after the call.
template <class Random>
std::vector<Kept> read_split(Reader& reader, Bytes input, Random& random, std::size_t piece_max) {
  std::vector<Kept> kept;
  auto sink = [&](const Packet& packet) { kept.emplace_back(packet); };
  while (!input.empty()) {
    const std::size_t size = std::min<std::size_t>(input.size(), random() % (piece_max + 1));
    const std::vector<std::uint8_t> piece(input.begin(), input.begin() + size);
    reader.feed(Bytes(piece.data(), piece.size()), sink);
    input = input.from(size);
  }
  reader.finish(sink);
  return kept;
}

}  // namespace rubric::testing
