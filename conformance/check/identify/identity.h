// The first pass: who is who in a run, and where something may have been missed.
//
// No frame names its sender for certain. Every sink has the same AM address, two islands may use
// the same mote id, a tester may borrow an address, and a node that rebooted is the same node with
// an empty memory. Everything that is judged later rests on the answers given here.
//
// Decides, for each observation: which device sent it, or kNobody; whether it is a repetition by
// the link, or a log's second line of one frame; whether a new life of the device begins with it.
// And for each device: its role, its island, and the times between which a frame of it may have
// escaped.
//
// Evidence:
// - A log names its nodes and has all that they sent. A line that gives a frame to a node is
//   matched with one of the last kRecentFrames sent ones of the same content, at most kSameFrameUs
//   back. If none matches, the frame is of the one node of the log that it can be from, or of
//   nobody.
// - On the air a sender counts its frames in the DSN. Frames of one AM address whose DSNs are 1 to
//   kGapMax apart form a Stream (streams.h); a step of more than 1 leaves a hole. The same DSN and
//   content within kLinkRepeatUs is the link's repetition.
// - What a frame shows of an island (IslandHint) ranks above its DSN. A join_reply shows it
//   plainly, and so does the source of a sink's message to its own island. Where a passed message
//   goes, or down which serial line it came, suggests it. A frame that fits two streams equally
//   well belongs to nobody, and so does one that shows no island while several streams could go on
//   with it.
// - A serial line belongs to the sink that a log names, else to the one whose island its traffic
//   shows: by serial_joined, by the sources of what passes, by SET_ISLAND_ID. Its other end is a
//   base station.
// - What the user says (given.h) settles what the frames leave open. Where the frames show
//   something else they are believed, and the contradiction is reported as inconclusive.
//
// From streams to devices: a stream goes on with an earlier device of its address, role and (for a
// sink) island if that one has fallen silent and the stream begins with a join_request or has
// kResumeFrames frames. What lies between is a hole, and a sink, or a mote that begins with a
// join_request, has rebooted; so has any mote where no frame escapes. A mote's stream of as many
// frames beside one that is still heard is a second mote with that id. Any other stream of an
// address that has a device already is an unknown sender, and so is a sink of which only one reply
// was heard, to a request that nobody sent. A stream of an address and island that the user named
// is never an unknown sender.
//
// Tolerance: kGapMax, kLinkRepeatUs, and kSerialRepeatUs for the host's repetitions on a line.
// Memory is bounded by kHolesMax (the last hole then grows), kStreamsMax and kLookMax.
//
// Cannot know:
// - that a multiple of 256 frames was lost in a row: the DSN has eight bits, and no hole shows;
// - that a node rebooted whose DSNs go on as if it had not, unless a log says so;
// - that somebody else sends with a node's address and its next DSN.
//
// Why a doubt here blames nobody: a frame of kNobody is judged as nobody's, yet every node may have
// heard it, so it explains what they do. An unknown sender is reported as stray at most
// (Context::report()). Where a cause may lie in a hole, before the first frame of a device, after
// its last, or among damaged bytes, maybe_unseen() says so, and Context::without() makes the
// missing cause inconclusive. `sniffer_complete`, which only the user can state, closes the holes;
// it does not mend damaged bytes.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "conformance/check/identify/given.h"
#include "conformance/check/observation.h"

namespace rubric::check {

constexpr std::uint16_t kNobody = 0xFFFF;
constexpr std::uint8_t kGapMax = 8;  ///< Beyond it a DSN does not follow the one before.

/// A node, found from its traffic: one AM address and one stream of DSNs; a sink also from its
/// serial line; a base station from the frames down that line.
struct Device {
  std::uint16_t am = 0;
  machine::Role role = machine::Role::kMote;
  std::uint16_t island = kNoIsland;  ///< A sink's or base station's first.
  bool set_later = false;            ///< A sink whose island was set then, and another before.
  bool known = true;                 ///< False: an unknown sender; what it does is a stimulus.
  bool judged = true;        ///< False: the user or a log says that it is no node under test.
  bool application = false;  ///< A log has its application's calls and events.
  bool hearing = false;      ///< A log has all that its radio was given.
  bool radio = false;        ///< It was heard on the air.
  bool whole = false;        ///< A log has all that it got and did.
  std::string name;
  std::uint16_t partner = kNobody;  ///< The base station of a sink and the other way round.
  std::vector<std::uint32_t> taps;  ///< A sink's serial lines.
  std::uint64_t frames = 0;
  std::int64_t first_us = 0;  ///< On the air.
  std::int64_t last_us = 0;
  /// Times between two frames whose DSNs do not follow each other: something was missed.
  std::vector<std::pair<std::int64_t, std::int64_t>> holes;

  /// Returns whether what a sink sends on its serial line is seen.
  bool shows_line() const { return whole || !taps.empty(); }
};

/// The first pass's result for one observation.
struct Mark {
  std::uint16_t device = kNobody;    ///< The node that sent it, called, or was notified.
  std::uint16_t receiver = kNobody;  ///< The node that a log's line gives something.
  bool repeat = false;               ///< The link's own repetition, or a log's second line of it.
  bool late = false;                 ///< A repetition after the link's time, with the same DSN.
  bool again = false;                ///< By a log the receiver was given this frame before.
  bool new_life = false;             ///< The first frame after a reboot.
};

struct Identity {
  std::vector<Device> devices;
  std::vector<Mark> marks;                 ///< One for each observation.
  std::vector<std::uint16_t> sink_of_tap;  ///< kNobody: a tap on the air, or of an unknown sink.
  std::vector<std::string> facts;
  std::vector<Contradiction> contradictions;  ///< Between the run and the user.
  std::vector<std::int64_t> damaged_us;       ///< Times of damaged bytes that were a frame once.

  bool sees_air = false;      ///< A capture, or logs of all nodes, have frames of the air.
  bool hears_radio = false;   ///< So it was, or a whole log has all of them.
  std::int64_t gone_us = -1;  ///< Frames before this are gone: Past::until_us.

  /// Returns whether such bytes came between these times.
  bool damaged(std::int64_t from_us, std::int64_t to_us) const;
  /// Returns whether a frame of `device` between these times could have escaped the sniffer.
  bool maybe_unseen(std::uint16_t device, std::int64_t from_us, std::int64_t to_us,
                    const Options& options) const;
};

/// Gives each device its name and describes it in `facts`.
void name_devices(const Run& run, Identity& out);

Identity identify(const Run& run, const Options& options);

}  // namespace rubric::check
