#include "conformance/explorer/property.h"

namespace rubric::explorer {
namespace {

using P = Property;
using G = Goal;
constexpr ReqId kNone = ReqId::kNone;

constexpr std::array<PropertyInfo, kPropertyCount> kProperties{{
    {P::kJoinedAfterReply, "joined_after_reply",
     "joined(A) is signalled only after a reply of A to the present request was heard.",
     {req::kJ5Accept, req::kJ4Seq, kNone}},
    {P::kAckRightSeq, "ack_right_seq",
     "ack_join carries the number of the present request and the island of a reply to it.",
     {req::kJ4Seq, req::kJ4Content, kNone}},
    {P::kRequestsBounded, "requests_bounded",
     "A joinIsland call sends no more join_requests than the profile allows, and none outside a "
     "call.",
     {req::kJ8Limit, req::kJ1Called, req::kJ5Stop}},
    {P::kOneTerminal, "one_terminal",
     "Each joinIsland call ends in exactly one joined event.",
     {req::kJ5Once, req::kJ8Fail, kNone}},
    {P::kOneIsland, "one_island",
     "In its own view a mote is a member of at most one island, and acks one sink a call.",
     {req::kJ7One, req::kJ7Choice, kNone}},
    {P::kListedAcked, "listed_acked",
     "A sink lists no mote that never acked it.",
     {req::kJ6Add, req::kJ6Island, kNone}},
    {P::kListedSilent, "listed_silent",
     "A sink does not answer the request of a mote that it lists, nor without a request.",
     {req::kJ2Listed, req::kJ3Once, kNone}},
    {P::kAdmitted, "admitted",
     "A sink that hears ack_join with the number that it answered last to that mote lists it.",
     {req::kJ6Add, req::kJ9Interleave, kNone}},
    {P::kOneReport, "one_report",
     "Each join is told once: one moteJoined and one serial_joined.",
     {req::kJ6Repeat, req::kJ6Report, kNone}},
    {P::kQueuesBounded, "queues_bounded",
     "Buffers hold no more than their places, lists no mote twice.",
     {req::kN1Full, req::kJ3Overwrite, kNone}},
    {P::kJoinSucceeds, "join_succeeds",
     "Once faults stop, a joinIsland call succeeds and the sink lists the mote.",
     {req::kJ1Request, req::kJ3Reply, req::kJ4Ack}},
    {P::kOwnIslandOnly, "own_island_only",
     "No application gets a message whose destination is another island.",
     {req::kN5Foreign, req::kN6Collision, kNone}},
    {P::kReliableEnds, "reliable_ends",
     "Each reliable message ends in exactly one receive_ack.",
     {req::kT3Once, req::kT3Timeout, kNone}},
    {P::kAckCounts, "ack_counts",
     "The ack of a message that awaits it is signalled as success.",
     {req::kT3Success, req::kT4Several, kNone}},
    {P::kMembersOnly, "members_only",
     "A mote that is not a member sends no net_msg.",
     {req::kJ11Send, kNone, kNone}},
    {P::kNoDeadlock, "no_deadlock",
     "Where something is left to do, something can happen.",
     {req::kN2Queue, kNone, kNone}},
}};

constexpr std::array<GoalInfo, kGoalCount> kGoals{{
    {G::kJoinedFirst, "joined_first", "a mote joined the island of the first sink"},
    {G::kJoinedSecond, "joined_second", "a mote joined the island of the second sink"},
    {G::kFailed, "failed", "a call ended in joined(FAIL) after its last request"},
    {G::kJoinedAgain, "joined_again", "a call of a member failed at once"},
    {G::kRetried, "retried", "a join_request was sent again"},
    {G::kStaleReply, "stale_reply", "a reply to an older call reached a mote that was joining"},
    {G::kSecondOffer, "second_offer", "a second sink's reply reached a mote that had chosen"},
    {G::kListed, "listed", "a sink listed a mote"},
    {G::kRepeatedAck, "repeated_ack", "a sink heard the ack_join of a listed mote again"},
    {G::kInterleaved, "interleaved", "two joins were pending at one sink"},
    {G::kSameIsland, "same_island", "two motes were members of one island"},
    {G::kTwoIslands, "two_islands", "two motes were members of two islands"},
    {G::kOrphan, "orphan", "a member was not listed by its sink, and nothing would change it"},
    {G::kGhost, "ghost", "a sink listed a mote that was no member of its island any more"},
    {G::kDelivered, "delivered", "a message reached an application"},
    {G::kAckedMessage, "acked", "a reliable message ended in success"},
    {G::kTimedOut, "timed_out", "a reliable message ended in failure"},
    {G::kForeignIgnored, "foreign_ignored", "a message for another island was not delivered"},
}};

}  // namespace

std::span<const PropertyInfo, kPropertyCount> properties() { return kProperties; }
const PropertyInfo& info(Property property) {
  return kProperties[static_cast<std::size_t>(property)];
}
std::optional<Property> property_named(std::string_view name) {
  for (const PropertyInfo& p : kProperties) {
    if (name == p.name) return p.property;
  }
  return std::nullopt;
}
std::span<const GoalInfo, kGoalCount> goals() { return kGoals; }

}  // namespace rubric::explorer
