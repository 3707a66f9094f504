// Frames that two files of one run both have. They relate the files' clocks, or their order.
#pragma once

#include <cstdint>
#include <vector>

#include "conformance/check/observation.h"

namespace rubric::check {

/// How a frame of one file relates to one of another.
enum class Common : std::uint8_t {
  kSame,    ///< The very frame: the same air, or the same serial line, recorded twice.
  kUp,      ///< A net_msg on the air, and on the line of the sink that forwards it (N6-CONTENT).
  kDown,    ///< A net_msg on a line, and on the air, where the sink sends it on (N7-CONTENT).
  kJoined,  ///< An ack_join, and the serial_joined that reports it.
  kLogged,  ///< A line of a log, and a frame that is its cause or effect (align_logs.h).
  kPassed,  ///< What a node of one log sent, and a node of another was given.
};

/// Frame `a` of the first file and frame `b` of the second, indices into Run::seen. Neither could
/// be a pair with any other frame.
struct Pair {
  std::uint32_t a = 0;
  std::uint32_t b = 0;
  Common how = Common::kSame;
  int lag_sign = 0;             ///< 1: `a` is the cause, -1: `b` is; 0: they are one.
  std::int64_t lag_min_us = 0;  ///< From stamp to stamp, at least: the cause's time on the air.
};

struct CommonFrames {
  std::vector<Pair> pairs;            ///< In the order of the first file.
  std::vector<std::uint32_t> only_a;  ///< Could pass between the files, but is in one only.
  std::vector<std::uint32_t> only_b;
  /// Frames that repeat: each with each frame that it could be, so these pairs are guesses.
  std::vector<Pair> guesses;
};

/// A hash: FNV-1a.
class Hash {
 public:
  Hash& add(std::uint64_t value, int bytes) {
    for (int i = 0; i < bytes; ++i) step(static_cast<std::uint8_t>(value >> (8 * i)));
    return *this;
  }
  Hash& add(Bytes bytes) {
    for (const std::uint8_t byte : bytes) step(byte);
    return *this;
  }
  Hash& add(machine::Address address) { return add(address.pid, 2).add(address.devid, 2); }
  Hash& add(const machine::Descriptor& what) {
    return add(what.mote_type, 1).add(what.transducers, 2).add(what.actuators, 1);
  }
  std::uint64_t value() const { return value_; }

 private:
  void step(std::uint8_t byte) { value_ = (value_ ^ byte) * 0x100000001B3U; }
  std::uint64_t value_ = 0xCBF29CE484222325U;
};

/// A frame that may be in another file as well.
struct Sighting {
  std::uint64_t key = 0;    ///< Hash of the content that both forms share.
  std::uint32_t index = 0;  ///< Into Run::seen.
  Common how = Common::kSame;
  bool cause = false;
};

/// Returns the sightings of frames, by file. Those of logs may pass to a capture's line or air.
std::vector<std::vector<Sighting>> sightings_of(const Run& run);

/// Returns the pairs among the sightings of two files, and sorts both.
CommonFrames common_frames(const Run& run, std::vector<Sighting>& a, std::vector<Sighting>& b);

/// Returns the frames of several files on one clock that may pass between the air and a line. If
/// two files have a frame within `skew_us`, that of the file with more frames counts, or of the
/// first.
std::vector<Sighting> each_once(const Run& run,
                                const std::vector<const std::vector<Sighting>*>& files,
                                std::int64_t skew_us);

}  // namespace rubric::check
