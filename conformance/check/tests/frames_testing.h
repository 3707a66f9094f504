// The frames of some runs, for tests that print how many different ones they judged.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <set>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include "conformance/check/observation.h"

namespace rubric::check {

/// Frames by time, place and bytes.
using FrameSet = std::set<std::tuple<std::int64_t, std::string, std::vector<std::uint8_t>>>;

inline void add_frames(const Run& run, FrameSet& frames) {
  for (const Observation& seen : run.seen) {
    if (seen.kind != Observation::Kind::kRadio && seen.kind != Observation::Kind::kSerial) continue;
    const machine::Frame& frame = seen.frame;
    std::vector<std::uint8_t> bytes(frame.payload.begin(), frame.payload.end());
    for (const int address : {int{frame.src}, int{frame.dest}}) {
      bytes.push_back(static_cast<std::uint8_t>(address >> 8));
      bytes.push_back(static_cast<std::uint8_t>(address));
    }
    bytes.push_back(frame.type);
    frames.emplace(seen.place.time_us, run.taps[seen.tap].name, std::move(bytes));
  }
}

/// Returns what `join_period=300 response=450` states.
inline trace::Statement stated_by(const std::string& text) {
  std::istringstream words(text);
  trace::Statement out;
  for (std::string word; words >> word;) EXPECT_EQ(trace::add_stated(word, out), "");
  return out;
}

}  // namespace rubric::check
