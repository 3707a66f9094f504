// The join protocol, both sides, as independent parts. (paper: Component Management)
#pragma once

#include "conformance/machine/actions.h"
#include "conformance/machine/state.h"

namespace rubric::machine {

/// The facts about the node around them that the parts need.
struct JoinContext {
  const Profile& profile;
  std::uint16_t id;      ///< Own TinyOS id.
  std::uint16_t island;  ///< A sink's.
  std::uint32_t clock_ms;
  Ticks now;
};

/// The frame that a mote should send; kNone: nothing.
enum class JoinSend : std::uint8_t { kNone, kRequest, kAck };

/// Handles joinIsland: J1, J8-JOINED. `seq_num` is fresh. Refuses the call while a join is running.
JoinSend call_join(JoinMote& join, const JoinContext& context, const Descriptor& descriptor,
                   std::uint16_t seq_num, Actions& actions);
/// Handles a join_reply addressed to this mote: J4, J5, J7. `sink_am` is its AM source.
JoinSend hear_reply(JoinMote& join, const JoinContext& context, Address offered,
                    std::uint16_t seq_num, std::uint16_t sink_am, Actions& actions);
/// Handles the join timer: J8.
JoinSend join_timer(JoinMote& join, const JoinContext& context, Actions& actions);
/// Handles the end of an ack_join on the radio: repeats it while no link ack came (decision 102).
JoinSend ack_join_sent(JoinMote& join, const JoinContext& context, bool acked, Actions& actions);

/// Handles a join_request at a sink: J2, J3, J9. Returns true if it is to be answered with a
/// join_reply.
bool hear_request(JoinSink& sink, const JoinContext& context, std::uint16_t from,
                  std::uint16_t seq_num, const Descriptor& descriptor, Actions& actions);
/// Handles an ack_join at a sink: J6. Returns true for a new member, to be announced and reported.
bool hear_ack_join(JoinSink& sink, const JoinContext& context, Address dest, Address src,
                   std::uint16_t seq_num, const Descriptor& descriptor, Actions& actions);

/// Returns the member, or null.
const Admission* find_member(const JoinSink& sink, std::uint16_t devid);
/// Returns the pending join, or null.
const Admission* find_pending(const JoinSink& sink, std::uint16_t devid);

}  // namespace rubric::machine
