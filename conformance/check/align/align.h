// Captures of one run that were recorded apart: one clock, or at least one order, for all.
//
// Two recorders have two clocks. With a wrong shift between them an honest sink seems to forward
// what nobody sent. So a shift comes from frames that both recorders saw, or there is none
// (decision 9). The verdict is never used to choose it.
//
// Decides: for each file with stamps, how far its clock is ahead of the first one's and how fast
// that changes, or that nothing tells. For each frame of a file without stamps, between which times
// it lies (Run::loose). And later, which findings stand in every order that is left
// (judge/align_judge.cc).
//
// Evidence: frames that pass between two files (align_frames.h): the same frame of the same air or
// line, a net_msg on the air and on the line of a sink that passes it, an ack_join and its
// serial_joined. Only content that fits exactly one frame of the other file counts; repetitions by
// the link are one frame. Content that repeats fits every shift by its period, so it can only
// confirm that two clocks agree. Sniffers on one clock count as one before they are compared with a
// line.
//
// Order of work: the first file with stamps keeps its clock. Then the file that has most in common
// with a settled one joins it, those first that have the very same frames, until none can. The next
// file that is left begins a clock of its own, and Run::facts says why. Clocks that differ by no
// more than `skew_us` are left as they are, but for files with the same frames: these put them on
// the clock of the file with more.
//
// A shift (align_clock.cc) is accepted only if all of these hold:
// - At least kFramesMin pairs agree, they are more than half of all pairs, and no other shift has
//   more than half as many. Pairs agree within the response time and kSlackUs on either side, since
//   a forward waits; drift is followed up to kDriftMax.
// - In the time that both files cover, at least as many frames agree as are missing from the file
//   from which fewer are missing.
// - Nine tenths of them lie within the response time of the middle one, and no effect comes more
//   than `skew_us` before its cause.
// The shift is the median of the frames that are the same in both. Without any, the line is put as
// early as causes allow: its fastest forward is taken to have waited for nothing, or, if messages
// only went down it, half of kUnwaitedUs. How much later the line may be is its slack: up to where
// causes would come after effects, or kUnwaitedUs where frames went one way only. A drift is taken
// out only if kDriftFrames pairs over kDriftSpanUs show it well beyond their scatter.
//
// A log of applications (align_logs.h) shares events with captures, no frames. It lies where the
// fewest effects come before their causes: at its own times where no others are better, else where
// at least kFramesMin events say. Run::logs says how much earlier or later it may be. Logs without
// captures are put on the clock of the first one in the same way, by what one node sent and another
// was given; lines that pass such a frame are one line.
//
// An order (align_order.cc) for a file without stamps needs kOrderFramesMin pairs too, three
// quarters of them in one order in both files, and the same majority over missing frames. Each pair
// then bounds its neighbours: an effect comes after its cause, within the response time.
//
// Cannot know: how long each frame waited; that a sink holds back every message by the same time,
// which looks like a clock; that two recordings with the same frames are of different runs; which
// way a message between islands went on a line that has no directions, unless the rest of the line
// shows its island.
//
// Why a doubt here blames nobody: a file that could not be placed is marked (Run::unordered_taps,
// or it has no stamps), and Context::rests_on_order() makes inconclusive what could change with its
// place. What breaks the format of a single frame is blamed at any time. Where a line was placed, a
// failure must be found with the line as early and as late as it can be and between the two
// (judge_each_order()), and response times grow by the slack. A frame in order but without a stamp
// is subject to no rule about time (Place::timed()).
#pragma once

#include <cstdint>
#include <limits>

#include "conformance/check/observation.h"

namespace rubric::check {

/// The stamp of a frame without one, while a run is put together.
constexpr std::int64_t kNoStamp = std::numeric_limits<std::int64_t>::min();

struct AlignOptions {
  bool enabled = true;
  std::int64_t skew_us = 50'000;       ///< Clocks that differ by no more are left as they are.
  std::int64_t response_us = 292'969;  ///< In which a sink forwards: 300 ticks (decision 125).
};

/// Puts the captures of `run` on the clock of the first one that has stamps, where the frames that
/// two of them share show that their clocks differ; Run::facts says what was done, or why not.
/// Stamps are those of the files, kNoStamp where there are none; `seen` is in the order of files.
/// A log beside captures, or beside other logs, is put on their clock where both show the same
/// events; its own clock is taken for theirs, within `skew_us`, where nothing contradicts that,
/// unless its zero is its `own_zero` (decision 9).
void align(Run& run, const AlignOptions& options, bool own_zero = false);

}  // namespace rubric::check
