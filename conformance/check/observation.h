// A run: the frames of its files in one order of time, and what the user knows about it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "conformance/check/finding.h"
#include "conformance/machine/address.h"
#include "conformance/machine/event.h"
#include "conformance/trace/parameters.h"

namespace rubric::check {

/// One thing that was seen.
struct Observation {
  enum class Kind : std::uint8_t {
    kRadio,    ///< An active message on the air; time_us is the start of the frame.
    kLinkAck,  ///< An 802.15.4 acknowledgement, or that of a serial line; dsn says of what.
    kSerial,   ///< An active message on a serial line; time_us is the end of the frame.
    kForeign,  ///< A frame of another network, by its PAN; no node of this one hears it.
    kDamaged,  ///< Bytes that are no frame (bad CRC and the like); no node hears them.
    kCall,     ///< An application's call, from a .rtr log.
    kPeis,     ///< A message given to PEIS, or by it to a base station, from a .rtr log.
    kNotice,   ///< A notice to an application, from a .rtr log.
    kReboot,   ///< The node lost its memory or its power, by a .rtr log.
  };
  Kind kind = Kind::kRadio;
  bool to_mote = false;      ///< Serial: towards the sink. Without direction flags see Tap.
  bool ack_request = false;  ///< Asks for an acknowledgement of the link.
  bool has_dsn = false;      ///< A .rtr log has no DSN; of a serial line the packets with number.
  std::uint8_t dsn = 0;      ///< Radio and link ack; the sequence number of a serial packet.
  /// From a .rtr log: `node` was given this frame, so it did receive it. Else `node` sent it.
  bool received = false;
  std::uint16_t pan = 0;
  std::uint32_t tap = 0;  ///< Index into Run::taps.
  Place place;
  machine::Frame frame;                 ///< Bytes live as long as the Run.
  std::string_view node;                ///< From a .rtr log: who sent it, who called; else empty.
  const machine::Call* call = nullptr;  ///< kCall.
  const machine::Notice* notice = nullptr;  ///< kNotice.
  ReqId broken = ReqId::kNone;              ///< kDamaged: the rule that the bytes break.
};

/// A place where somebody listened: the air, a serial line.
struct Tap {
  std::string name;
  machine::Link link = machine::Link::kRadio;
  bool has_direction = false;  ///< The capture says which way a frame went.
  bool numbered = false;       ///< Some packets ask for confirmation, as hosts' do (directions.h).
  std::int32_t contradicted = 0;  ///< Frames that contradict its directions, less those that agree.

  /// Returns whether the way of each frame is plain.
  bool shows_direction() const { return has_direction || numbered; }
};

/// In place of an island that is not known: no island has this number (decision 132).
constexpr std::uint16_t kNoIsland = machine::kNullDevid;

/// A node as the user describes it (`--node 2=mote`, `--sink 1=11`).
struct KnownNode {
  std::uint16_t id = 0;
  machine::Role role = machine::Role::kMote;
  std::uint16_t island = kNoIsland;  ///< For a sink.
};

struct Options {
  bool deployed = false;          ///< The profile.
  bool sniffer_complete = false;  ///< Every frame on the air was captured.
  bool start_cold = false;        ///< Nothing had happened before the first frame.
  /// Stated of every node; what the log of a node states of it comes after it, then the profile.
  trace::Statement stated = {};
  /// Stated response time (decision 125); unstated, the profile's.
  std::optional<std::int64_t> response_us;
  /// Stated ack timeout (decision 110); unstated, the profile's; where it has none, the paper's.
  std::optional<std::int64_t> ack_timeout_us;
  std::int64_t skew_us = 50'000;  ///< Bound of the skew between the stamps of two taps.
  std::vector<KnownNode> nodes;
  std::vector<std::uint16_t> testers;  ///< AM addresses of senders that are no node under test.
};

/// From when to when a line of a node was taken by somebody else, or its application took nothing.
struct BusyTime {
  std::int64_t from_us = 0;
  std::int64_t to_us = INT64_MAX;     ///< INT64_MAX: it does not end within the log.
  std::optional<machine::Link> line;  ///< Nothing: the application.
};

/// The join_requests that a sink was given between the first and the last line of its log.
struct GivenRequests {
  struct Request {
    std::int64_t time_us;
    std::uint16_t mote_am;
    std::uint16_t seq_num;
  };
  std::int64_t from_us = INT64_MAX;
  std::int64_t to_us = INT64_MIN;
  std::vector<Request> all;
};

/// A node as a .rtr log describes it.
struct LoggedNode {
  std::string name;
  std::uint32_t file = 0;  ///< Of the log.
  machine::Role role = machine::Role::kMote;
  std::uint16_t id = 0;
  std::uint16_t island = kNoIsland;
  /// Of the node alone; of one that the trace plays, what those under test state.
  trace::Statement stated = {};
  bool under_test = true;    ///< If a log marks some nodes as under test, the others are not.
  bool application = false;  ///< The log has its application's calls and events.
  bool hearing = false;      ///< The log has what its radio was given; a base station's lines.
  bool logged = false;       ///< The log has lines of it; else only a header names it.
  bool whole = false;        ///< The log has all that it got and did (decision 13).
  bool peis = false;         ///< The log has its lines of PEIS.
  std::int64_t from_us = INT64_MIN;  ///< Of several logs without captures: between which times its
  std::int64_t to_us = INT64_MAX;    ///< log shows it.
  std::vector<BusyTime> busy;        ///< In order of their beginning.
  std::vector<std::int64_t> link_acks_us;      ///< When its link told it of an acknowledgement.
  std::vector<std::int64_t> link_failures_us;  ///< When it told that none came.
  /// Of a sink whose frames were left out, as a capture has them.
  std::optional<GivenRequests> requests;

  /// Returns whether the run shows then what the node does.
  bool shown(std::int64_t time_us) const { return from_us <= time_us && time_us <= to_us; }
};

/// How well the clock of a log is known that lies beside captures.
struct LogClock {
  std::uint32_t file = 0;
  bool known = true;             ///< False: nothing ties it to that of the captures.
  std::int64_t earlier_us = 0;   ///< Its lines may have come earlier than they say by so much,
  std::int64_t later_us = 0;     ///< or later.
  std::uint64_t step_frame = 0;  ///< The first line after a step of it; 0: there is none.
};

/// The times between which a frame of a file without stamps must lie, by frames that other files
/// have.
struct LoosePlace {
  std::uint32_t file = 0;
  std::uint64_t frame = 0;
  std::int64_t early_us = 0;
  std::int64_t late_us = 0;
  /// Two of those frames surround it, and its direction is plain; else it blames no node.
  bool between = false;
};

/// The first frame after a step of its recorder's clock, or a frame whose stamp alone is wrong.
struct ClockStep {
  static constexpr std::int64_t kUnknown = -1;
  std::uint32_t file = 0;
  std::uint64_t frame = 0;
  std::int64_t time_us = 0;          ///< Where the frame was put: as early as it can be.
  std::int64_t later_us = kUnknown;  ///< It may be later by this; a step back leaves that open.
  bool with_rest = true;             ///< All that follow are later with it.

  bool alone() const { return !with_rest; }
  /// Returns whether it changes what passed between two times.
  bool is_between(std::int64_t from_us, std::int64_t to_us) const {
    return time_us <= to_us && (time_us > from_us || (alone() && time_us == from_us));
  }
};

/// Returns whether a clock stepped between two times, or the frame at one of them has a wrong
/// stamp. `steps` are in order of time.
inline bool stepped(const std::vector<ClockStep>& steps, std::int64_t from_us, std::int64_t to_us) {
  const auto first = std::lower_bound(
      steps.begin(), steps.end(), from_us,
      [](const ClockStep& step, std::int64_t time_us) { return step.time_us < time_us; });
  return std::any_of(first, steps.end(),
                     [&](const ClockStep& step) { return step.is_between(from_us, to_us); });
}

/// Returns by how much the time that passed between two frames may differ from what their times
/// say, as a clock stepped between them; kUnknown if nothing tells.
inline std::int64_t doubt_us(const std::vector<ClockStep>& steps, std::int64_t from_us,
                             std::int64_t to_us) {
  std::int64_t sum_us = 0;
  for (const ClockStep& step : steps) {
    if (!step.is_between(from_us, to_us)) continue;
    if (step.later_us == ClockStep::kUnknown) return ClockStep::kUnknown;
    sum_us += step.later_us;
  }
  return sum_us;
}

/// What a run that is followed for long no longer holds (judge/follow.h). Its frames up to
/// `until_us` were judged and are gone, but for some that begin the run: those that show who the
/// nodes are and what they joined.
struct Past {
  std::int64_t until_us = -1;            ///< -1: the run is whole.
  std::uint64_t frames = 0;              ///< That are gone.
  std::vector<std::uint16_t> senders;    ///< By observation kept from then: a number of its sender.
  std::vector<std::uint64_t> frames_of;  ///< By that number: the frames that are gone.
  std::vector<bool> lossy_taps;          ///< Serial lines that were seen to miss frames.
  std::vector<std::int64_t> settled_us;  ///< No episode goes on across these times.

  /// Returns whether an observation was kept from then.
  bool holds(std::size_t index) const { return index < senders.size(); }
};

/// Holds the objects that observations point to.
struct RunStorage;

struct Run {
  std::vector<std::string> files;
  std::vector<LoggedNode> nodes;
  std::int64_t watched_until_us = -1;  ///< By a log that is whole: its end.
  /// A log marks nodes as under test: the trace plays everybody else.
  bool marked = false;
  bool cut = false;  ///< A log ends within a line, which is left out.
  std::shared_ptr<RunStorage> storage;
  std::vector<Tap> taps;
  std::vector<std::string> facts;  ///< Results of the reading, a sentence each.
  std::vector<Observation> seen;   ///< In order of cause: see merge() in read.h.
  std::int64_t begin_us = -1;      ///< The stamp from which times count; -1: there is none.
  std::int64_t start_us = 0;       ///< The first stamp.
  std::int64_t end_us = 0;
  /// Everything has a stamp. Raw bytes carry none: no rule about their times is judged, and beside
  /// other files nothing fails that depends on the order between the two.
  bool has_time = true;
  /// By tap: its clock is not known to be that of the air, so nothing fails that depends on the
  /// order between the two. Empty if there is no such tap.
  std::vector<bool> unordered_taps;
  /// How far apart stamps are at least, where a tap shows such a grid: what passed between two
  /// frames of it may be so much more or less than their times say.
  std::int64_t grid_us = 0;
  /// By file and frame: how much earlier the stamps of frames are than where their files have them.
  /// A failure must be found in the order of the stamps, too.
  std::map<std::pair<std::uint32_t, std::uint64_t>, std::int64_t> turned;
  /// Lines on clocks of their own were put on that of the air, as early as they can be; they may be
  /// later by this. A failure must be found wherever in that time they are.
  std::int64_t slack_us = 0;
  std::vector<bool> slack_taps;  ///< By tap: those lines; empty: none.
  /// Frames of files without stamps that are in order with others, by file and frame. A failure
  /// must be found in each order that these bounds allow.
  std::vector<LoosePlace> loose;
  /// Logs beside captures. A failure must be found wherever in its bounds a log lies; where its
  /// clock is not known, also without it.
  std::vector<LogClock> logs;
  /// In order of time. What compares times before and after one is inconclusive.
  std::vector<ClockStep> steps;
  Past past;

  /// Returns whether it is one log that has all of its nodes under test, from their start on
  /// (decision 24).
  bool tells_all() const {
    return files.size() == 1 &&
           std::ranges::all_of(
               nodes, [](const LoggedNode& node) { return node.whole || !node.under_test; }) &&
           std::ranges::any_of(nodes, &LoggedNode::whole);
  }
};

/// The whole answer.
struct Report {
  Verdict verdict = Verdict::kPass;
  std::vector<Finding> findings;  ///< In order of place.
  std::uint64_t frames = 0;       ///< Judged.
  /// Facts about the run, one sentence each (nodes, roles, islands, holes).
  std::vector<std::string> facts;
  /// Rules that were exercised at least once, with their counts.
  std::vector<std::pair<ReqId, std::uint64_t>> exercised;
};

/// Judges a run. Never fails on any input; uses bounded memory.
Report judge(const Run& run, const Options& options);

}  // namespace rubric::check
