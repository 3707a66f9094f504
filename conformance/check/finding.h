// The checker's findings about a run.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "codec/runtime/rule.h"

namespace rubric::check {

/// From harmless to grave. kStray: a frame of an unknown sender; no known node is blamed for it.
enum class Severity : std::uint8_t { kNote, kWeak, kStray, kInconclusive, kFail };

/// A place in the given files.
struct Place {
  std::uint32_t file = 0;          ///< Index among the files of the run.
  std::uint64_t frame = 0;         ///< Number in its file, from 1; 0: none (an end, a whole run).
  std::uint64_t offset_bytes = 0;  ///< The frame's record in its file; a line number in .rtr.
  std::int64_t time_us = -1;       ///< Since the first stamp of the run; -1: the file has no time.
  /// The file has no time; time_us only puts the frame in order with other files (Run::loose).
  bool loose = false;

  bool timed() const { return time_us >= 0 && !loose; }
  bool in_order() const { return time_us >= 0; }
};

/// One explanation that the checker had considered, and how it ended.
struct Hypothesis {
  std::string text;     ///< The supposition, one sentence.
  std::string allowed;  ///< The frames it would have allowed next.
  std::string miss;     ///< Expected and seen, where it broke.

  bool operator==(const Hypothesis&) const = default;
};

struct Finding {
  ReqId requirement = ReqId::kNone;
  Severity severity = Severity::kFail;
  std::uint16_t device = UINT16_MAX;   ///< Number of the node: nodes of logs come first, in order.
  Place place;                         ///< The frame that shows it; for an absence, its cause.
  std::string node;                    ///< Name of the node that is judged, such as `mote 2`.
  std::string text;                    ///< The event, one or two sentences with the values.
  std::string expected;                ///< The right behaviour.
  std::vector<Hypothesis> hypotheses;  ///< Furthest first; that one is blamed.
  std::uint32_t count = 1;             ///< Repeats within an episode.
  Place last;                          ///< Place of the last repeat.
  bool beyond = false;                 ///< No profile accepts this of its rule.
};

/// Of a run, by its gravest finding: in the order of Severity, as without one a run passes.
enum class Verdict : std::uint8_t { kPass, kWeak, kStray, kInconclusive, kFail };

}  // namespace rubric::check
