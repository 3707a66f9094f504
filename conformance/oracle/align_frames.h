// Frames that two files of one run both have: what puts their clocks, or their order, together.
#pragma once

#include <cstdint>
#include <vector>

#include "conformance/oracle/observation.h"

namespace rubric::oracle {

/// What a frame of one file is to one of another.
enum class Common : std::uint8_t {
  kSame,    ///< The very frame: the same air, or the same serial line, recorded twice.
  kUp,      ///< A net_msg on the air, and on the line of the sink that forwards it (N6-CONTENT).
  kDown,    ///< A net_msg on a line, and on the air, where the sink sends it on (N7-CONTENT).
  kJoined,  ///< An ack_join, and the serial_joined that reports it.
};

/// Frame `a` of the first file and frame `b` of the second, indices into Run::seen. Neither could
/// be a pair with any other frame.
struct Pair {
  std::uint32_t a = 0;
  std::uint32_t b = 0;
  Common how = Common::kSame;
  int lag_sign = 0;              ///< 1: `a` is the cause, -1: `b` is; 0: they are one.
  std::int64_t lag_min_us = 0;   ///< From stamp to stamp, at least: the cause's time on the air.
};

struct CommonFrames {
  std::vector<Pair> pairs;            ///< In the order of the first file.
  std::vector<std::uint32_t> only_a;  ///< Of a kind that passes between the files, yet in one only.
  std::vector<std::uint32_t> only_b;
  /// Frames that repeat, so that pairs are a guess: each with each that it could be.
  std::vector<Pair> guesses;
};

/// One frame, as something that may be in another file as well.
struct Sighting {
  std::uint64_t key = 0;    ///< Of what both forms have.
  std::uint32_t index = 0;  ///< Into Run::seen.
  Common how = Common::kSame;
  bool cause = false;
};

/// What the frames of captures are, by file. Lines of .rtr logs are none.
std::vector<std::vector<Sighting>> sightings_of(const Run& run);

/// Pairs among the sightings of two files; each is sorted by it.
CommonFrames common_frames(const Run& run, std::vector<Sighting>& a, std::vector<Sighting>& b);

/// What may pass between the air and a line of several files on one clock, by file: a frame that
/// two of them have within `skew_us` is of the one that has more frames, or the first.
std::vector<Sighting> each_once(const Run& run,
                                const std::vector<const std::vector<Sighting>*>& files,
                                std::int64_t skew_us);

}  // namespace rubric::oracle
