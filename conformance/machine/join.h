// The join protocol, both sides, as parts that stand alone. (paper: Component Management)
#pragma once

#include "conformance/machine/actions.h"
#include "conformance/machine/state.h"

namespace rubric::machine {

/// What the parts need to know of the node around them.
struct JoinContext {
  const Profile& profile;
  std::uint16_t id;      ///< Own TinyOS id.
  std::uint16_t island;  ///< A sink's.
  std::uint32_t clock_ms;
  Ticks now;
};

/// What a mote wants sent; kNone: nothing.
enum class JoinSend : std::uint8_t { kNone, kRequest, kAck };

/// joinIsland: J1, J8-JOINED. `seq_num` is fresh. While a join is running the call is refused.
JoinSend call_join(JoinMote& join, const JoinContext& context, const Descriptor& descriptor,
                   std::uint16_t seq_num, Actions& actions);
/// A join_reply addressed to this mote: J4, J5, J7. `sink_am` is its AM source.
JoinSend hear_reply(JoinMote& join, const JoinContext& context, Address offered,
                    std::uint16_t seq_num, std::uint16_t sink_am, Actions& actions);
/// The join timer fires: J8.
JoinSend join_timer(JoinMote& join, const JoinContext& context, Actions& actions);
/// The radio finished an ack_join: repeats it while no link ack came (decision 102).
JoinSend ack_join_sent(JoinMote& join, const JoinContext& context, bool acked, Actions& actions);

/// A join_request at a sink: J2, J3, J9. True: answer it with a join_reply.
bool hear_request(JoinSink& sink, const JoinContext& context, std::uint16_t from,
                  std::uint16_t seq_num, const Descriptor& descriptor, Actions& actions);
/// An ack_join at a sink: J6. True: a new member, to be announced and reported.
bool hear_ack_join(JoinSink& sink, const JoinContext& context, Address dest, Address src,
                   std::uint16_t seq_num, const Descriptor& descriptor, Actions& actions);

/// The member, or null.
const Admission* find_member(const JoinSink& sink, std::uint16_t devid);
/// The pending join, or null.
const Admission* find_pending(const JoinSink& sink, std::uint16_t devid);

}  // namespace rubric::machine
