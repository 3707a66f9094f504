// The constants and switches in which the dialects of the protocol differ; data, not code. The
// profiles themselves come from spec/profiles.
#pragma once

#include <cstdint>

#include "conformance/machine/ticks.h"

namespace rubric::machine {

/// One dialect. Defaults are those of the paper's profile.
struct Profile {
  std::uint16_t ticks_per_second = 1024;
  std::uint16_t join_period_ticks = 500;      ///< From one join_request to the next.
  std::uint8_t join_requests_max = 5;         ///< In one joinIsland call.
  bool join_fail_signalled = true;            ///< joined(FAIL) after the last request.
  std::uint8_t ack_join_max = 5;              ///< ack_join sent at most, while no link ack comes.
  bool listed_ignored = true;                 ///< J2: a sink ignores a mote that it lists.
  bool short_acks = true;                     ///< An ack holds the number alone (decision 108).
  std::uint8_t members_max = 20;              ///< In a sink's list; at most kMembersMax.
  std::uint8_t sink_id = 1;                   ///< AM address and devid of every sink.
  std::uint16_t ack_timeout_ticks = 1000;     ///< For a reliable message; 0: none.
  std::uint8_t channels_max = 4;              ///< In each direction; at most kChannelsRoom.
  std::uint16_t synaptic_period_ticks = 500;  ///< Until set_time_step.
  std::uint8_t synaptic_phase_ticks = 30;     ///< (devid - 1) times this before a mote's clock.
  std::uint16_t response_ticks = 300;         ///< Time for a reply, an ack, a forward.
  std::uint8_t early_ticks = 30;              ///< How much a timer may seem early on the air.
  /// A sink or base station calls a mote gone after so much silence; 0: never, as in both dialects.
  std::uint32_t gone_after_ticks = 0;

  friend bool operator==(const Profile&, const Profile&) = default;
};

}  // namespace rubric::machine
