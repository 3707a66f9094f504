// The first pass: who is who in a run, and where something may have been missed.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "conformance/oracle/given.h"
#include "conformance/oracle/observation.h"

namespace rubric::oracle {

constexpr std::uint16_t kNobody = 0xFFFF;

/// A node, found from its traffic: one AM address and one stream of DSNs; a sink also from its
/// serial line; a base station from what comes down that line.
struct Device {
  std::uint16_t am = 0;
  machine::Role role = machine::Role::kMote;
  std::uint16_t island = 0;      ///< A sink's or base station's first; 0: unknown.
  bool known = true;             ///< False: an unknown sender; what it does is a stimulus.
  bool judged = true;            ///< False: the user or a log says that it is no node under test.
  bool application = false;      ///< A log has its application's calls and events.
  bool hearing = false;          ///< A log has all that its radio was given.
  bool radio = false;            ///< It was heard on the air.
  std::string name;
  std::uint16_t partner = kNobody;   ///< The base station of a sink and the other way round.
  std::vector<std::uint32_t> taps;   ///< Of a sink: its serial line.
  std::uint64_t frames = 0;
  std::int64_t first_us = 0;     ///< On the air.
  std::int64_t last_us = 0;
  /// Times between two frames of it that do not follow each other: something was missed.
  std::vector<std::pair<std::int64_t, std::int64_t>> holes;
};

/// What the first pass says of one observation.
struct Mark {
  std::uint16_t device = kNobody;    ///< Who sent it (called, was told).
  std::uint16_t receiver = kNobody;  ///< Of a line of a log that gives a node something.
  bool repeat = false;               ///< The link's own repetition, or a log's second line of it.
  bool again = false;                ///< By a log the receiver was given the same frame before.
  bool new_life = false;             ///< The first frame behind a reboot.
};

struct Identity {
  std::vector<Device> devices;
  std::vector<Mark> marks;                ///< One for each observation.
  std::vector<std::uint16_t> sink_of_tap; ///< kNobody: a tap on the air, or of an unknown sink.
  std::vector<std::string> facts;
  std::vector<Contradiction> contradictions;  ///< Of what the user says.
  std::vector<std::int64_t> damaged_us;   ///< When bytes came that are no frame; they were one.

  bool hears_radio = false;               ///< Some radio frame was seen at all.

  /// Whether such bytes came between these times.
  bool damaged(std::int64_t from_us, std::int64_t to_us) const;
  /// Whether a frame of `device` between these times could have escaped the sniffer.
  bool maybe_unseen(std::uint16_t device, std::int64_t from_us, std::int64_t to_us,
                    const Options& options) const;
};

/// Gives each device its name and says in `facts` what is known of it.
void name_devices(const Run& run, Identity& out);

Identity identify(const Run& run, const Options& options);

}  // namespace rubric::oracle
