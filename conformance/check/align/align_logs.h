// Logs of applications beside captures: what they share, and how to move them.
//
// A log has a clock of its own, and no frame that a capture has. But many of its lines cause a
// frame or tell of one: a call of send and the message with the number that it returned, a message
// and its delivery, an offer and joined, an ack_join and mote_joined, an ack and receive_ack. No
// effect comes before its cause, and most come soon after it. Two logs share what one node sent and
// the other was given.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "conformance/check/align/align.h"
#include "conformance/check/align/align_frames.h"
#include "conformance/check/observation.h"

namespace rubric::check {

/// Adds to the sightings of each file those that tie logs to captures: the lines of logs
/// (Common::kLogged), and the frames of captures that may be their causes or effects; and those
/// that tie logs to each other (Common::kPassed).
void add_logged(const Run& run, std::vector<std::vector<Sighting>>& sightings);

/// Returns the first line after a step forth of the clock of a log, which nearly all `pairs` of it
/// and others show, and a gap between its lines; 0 if there is none.
std::uint64_t step_of_log(const Run& run, std::uint32_t log, const std::vector<Pair>& pairs,
                          const AlignOptions& options);

/// Moves the times that logs state of their nodes; those of one log, if a file is named.
template <class Moved>
void move_nodes(Run& run, std::optional<std::uint32_t> file, Moved moved) {
  const auto move = [&](std::int64_t& time_us) {
    if (time_us != INT64_MAX && time_us != INT64_MIN) time_us = moved(time_us);
  };
  for (LoggedNode& node : run.nodes) {
    if (file && node.file != *file) continue;
    move(node.from_us);
    move(node.to_us);
    for (BusyTime& busy : node.busy) {
      move(busy.from_us);
      move(busy.to_us);
    }
    for (std::int64_t& time_us : node.link_acks_us) move(time_us);
    for (std::int64_t& time_us : node.link_failures_us) move(time_us);
  }
  const bool all = !file || std::ranges::any_of(run.nodes, [&](const LoggedNode& node) {
    return node.whole && node.file == *file;
  });
  if (all && run.watched_until_us >= 0) move(run.watched_until_us);
}

/// Moves all times of the log in `file`.
template <class Moved>
void move_log(Run& run, std::uint32_t file, Moved moved) {
  for (Observation& seen : run.seen) {
    if (seen.place.file == file) seen.place.time_us = moved(seen.place.time_us);
  }
  move_nodes(run, file, moved);
}

}  // namespace rubric::check
