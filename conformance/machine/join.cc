#include "conformance/machine/join.h"

namespace rubric::machine {
namespace {

constexpr std::size_t kAbsent = ~std::size_t{0};

template <std::size_t kRoom>
std::size_t index_of(const BoundedList<Admission, kRoom>& list, std::uint16_t devid) {
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (list[i].devid == devid) return i;
  }
  return kAbsent;
}

template <std::size_t kRoom>
const Admission* find(const BoundedList<Admission, kRoom>& list, std::uint16_t devid) {
  const std::size_t i = index_of(list, devid);
  return i == kAbsent ? nullptr : &list[i];
}

bool list_is_full(const JoinSink& sink, const Profile& profile) {
  return sink.members.full() || sink.members.size() >= profile.members_max;
}

// Admits a mote whose request was answered, on its ack_join.
bool admit(JoinSink& sink, const JoinContext& context, std::size_t pending, Actions& actions) {
  const Admission admission = sink.pending[pending];
  const std::size_t listed = index_of(sink.members, admission.devid);
  if (listed != kAbsent) {
    sink.members[listed] = admission;  // It joined again; only a profile with J2 off gets here.
  } else if (list_is_full(sink, context.profile)) {
    //= J3-OVERWRITE: A new mote never takes the place of a listed member.
    // Possible when more joins are pending than places are left.
    actions.ignored("J3-OVERWRITE"_rule);
    return false;
  } else {
    sink.members.push(admission);
  }
  sink.pending.erase(pending);
  //= J6-ONLY: A sink adds a mote to its list, announces and reports it only on an ack_join.
  const Address address{context.island, admission.devid};
  actions.notify(MoteJoined{address, admission.descriptor}, "J6-ADD"_rule);
  return true;
}

}  // namespace

JoinSend call_join(JoinMote& join, const JoinContext& context, const Descriptor& descriptor,
                   std::uint16_t seq_num, Actions& actions) {
  //= J8-JOINED: joinIsland of a mote that is joined fails at once and sends nothing.
  if (join.phase == JoinMote::Phase::kMember) {
    actions.notify(Joined{join.address, false}, "J8-JOINED"_rule);
    return JoinSend::kNone;
  }
  //= J5-ONCE: Each joinIsland call ends in exactly one joined event, SUCCESS or FAIL.
  // So this call ends here; the one that runs is not disturbed and ends in its own.
  if (join.phase == JoinMote::Phase::kJoining) {
    actions.notify(Joined{{0, context.id}, false}, "J5-ONCE"_rule);
    return JoinSend::kNone;
  }
  //= J1-CALLED: A mote sends no join_request unless joinIsland was called.
  join = JoinMote{};
  join.phase = JoinMote::Phase::kJoining;
  join.requests = 1;
  join.seq_num = seq_num;
  join.descriptor = descriptor;
  join.due = context.now + context.profile.join_period_ticks;
  return JoinSend::kRequest;
}

JoinSend hear_reply(JoinMote& join, const JoinContext& context, Address offered,
                    std::uint16_t seq_num, std::uint16_t sink_am, Actions& actions) {
  if (join.phase == JoinMote::Phase::kMember) {
    const bool second_offer = seq_num == join.seq_num && offered.pid != join.address.pid;
    //= J7-CHOICE: With several sinks in range a mote sends ack_join only for the island that it
    //= chose for its present request.
    //= J4-JOINED: A mote that is joined, or has no request outstanding, ignores a join_reply.
    actions.ignored(second_offer ? "J7-CHOICE"_rule : "J4-JOINED"_rule);
    return JoinSend::kNone;
  }
  if (join.phase == JoinMote::Phase::kOutside) {
    actions.ignored("J4-JOINED"_rule);
    return JoinSend::kNone;
  }
  //= J4-SEQ: A mote ignores a join_reply whose sequence number is not that of its outstanding
  //= request.
  if (seq_num != join.seq_num) {
    actions.ignored("J4-SEQ"_rule);
    return JoinSend::kNone;
  }
  join.phase = JoinMote::Phase::kMember;
  //= J7-ONE: In its own view a mote is a member of at most one island.
  join.address = offered;
  join.sink_devid = sink_am;
  join.acks = 1;
  join.acked = false;
  join.accepted = context.now;
  //= J5-STOP: A mote that is joined sends no further join_request.
  join.due = 0;
  //= J5-ACCEPT: joined(SUCCESS) is never signalled before a reply was accepted.
  actions.notify(Joined{offered, true}, "J5-SUCCESS"_rule);
  return JoinSend::kAck;
}

JoinSend join_timer(JoinMote& join, const JoinContext& context, Actions& actions) {
  if (join.phase != JoinMote::Phase::kJoining) {
    actions.ignored("J5-STOP"_rule);
    return JoinSend::kNone;
  }
  //= J8-LIMIT: A joinIsland call sends at most five join_requests.
  if (join.requests < context.profile.join_requests_max) {
    ++join.requests;
    join.due = context.now + context.profile.join_period_ticks;
    return JoinSend::kRequest;
  }
  join.phase = JoinMote::Phase::kOutside;
  join.due = 0;
  if (context.profile.join_fail_signalled) {
    actions.notify(Joined{{0, context.id}, false}, "J8-FAIL"_rule);
  } else {
    actions.followed("J8-LIMIT"_rule);
  }
  return JoinSend::kNone;
}

JoinSend ack_join_sent(JoinMote& join, const JoinContext& context, bool acked, Actions& actions) {
  if (join.phase != JoinMote::Phase::kMember || join.acked) return JoinSend::kNone;
  if (acked) {
    join.acked = true;
    actions.followed("J4-ACK"_rule);
    return JoinSend::kNone;
  }
  //= J4-FEW: An ack_join is repeated at most five times.
  if (join.acks >= context.profile.ack_join_max) {
    actions.followed("J4-FEW"_rule);
    return JoinSend::kNone;
  }
  //= J4-REPEAT: The ack_join of an accepted reply is repeated only unchanged, within one join
  //= period of the last request or of the acceptance, and at most 20 times.
  if (context.now - join.accepted > context.profile.join_period_ticks) {
    actions.followed("J4-REPEAT"_rule);
    return JoinSend::kNone;
  }
  ++join.acks;
  return JoinSend::kAck;
}

bool hear_request(JoinSink& sink, const JoinContext& context, std::uint16_t from,
                  std::uint16_t seq_num, const Descriptor& descriptor, Actions& actions) {
  const bool listed = find_member(sink, from) != nullptr;
  //= J2-LISTED: A sink ignores a join_request of a mote that is already in its list.
  if (listed && context.profile.listed_ignored) {
    actions.ignored("J2-LISTED"_rule);
    return false;
  }
  //= J3-FULL: A sink whose list is full does not answer a mote that it does not list.
  if (!listed && list_is_full(sink, context.profile)) {
    actions.ignored("J3-FULL"_rule);
    return false;
  }
  //= J9-INTERLEAVE: Joins of several motes may interleave at a sink; each keeps its own sequence
  //= number and descriptor.
  const std::size_t before = index_of(sink.pending, from);
  if (before != kAbsent) {
    sink.pending.erase(before);  // Its older request is forgotten; now it is the newest.
  } else if (sink.pending.full()) {
    sink.pending.erase(0);
  }
  sink.pending.push({from, seq_num, descriptor});
  return true;
}

bool hear_ack_join(JoinSink& sink, const JoinContext& context, Address dest, Address src,
                   std::uint16_t seq_num, const Descriptor&, Actions& actions) {
  //= J6-ISLAND: A sink ignores an ack_join whose dest.pid is not its island.
  if (dest.pid != context.island) {
    actions.ignored("J6-ISLAND"_rule);
    return false;
  }
  const std::size_t pending = index_of(sink.pending, src.devid);
  if (pending != kAbsent && sink.pending[pending].seq_num == seq_num) {
    return admit(sink, context, pending, actions);
  }
  const Admission* const member = find_member(sink, src.devid);
  //= J6-REPEAT: A repeated ack_join changes nothing: one moteJoined and one serial_joined for each
  //= join.
  //= J6-SEQ: A sink ignores an ack_join whose sequence number is not the one it stored for that
  //= mote.
  const bool repeated = member != nullptr && member->seq_num == seq_num;
  actions.ignored(repeated ? "J6-REPEAT"_rule : "J6-SEQ"_rule);
  return false;
}

const Admission* find_member(const JoinSink& sink, std::uint16_t devid) {
  return find(sink.members, devid);
}

const Admission* find_pending(const JoinSink& sink, std::uint16_t devid) {
  return find(sink.pending, devid);
}

}  // namespace rubric::machine
