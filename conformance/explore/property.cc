#include "conformance/explore/property.h"

namespace rubric::explore {
namespace {

using P = Property;
using G = Goal;

constexpr std::array<ReqId, 3> rules(ReqId a, ReqId b = ReqId::kNone, ReqId c = ReqId::kNone) {
  return {a, b, c};
}

constexpr std::array<PropertyInfo, kPropertyCount> kProperties{{
    {P::kJoinedAfterReply, "joined_after_reply",
     "joined(A) is signalled only after a reply of A to the present request was heard.",
     rules("J5-ACCEPT"_rule, "J4-SEQ"_rule)},
    {P::kAckRightSeq, "ack_right_seq",
     "ack_join carries the number of the present request and the island of a reply to it.",
     rules("J4-SEQ"_rule, "J4-CONTENT"_rule)},
    {P::kRequestsBounded, "requests_bounded",
     "A joinIsland call sends no more join_requests than the profile allows, and none outside a "
     "call.",
     rules("J8-LIMIT"_rule, "J1-CALLED"_rule, "J5-STOP"_rule)},
    {P::kOneTerminal, "one_terminal", "Each joinIsland call ends in exactly one joined event.",
     rules("J5-ONCE"_rule, "J8-FAIL"_rule)},
    {P::kOneIsland, "one_island",
     "In its own view a mote is a member of at most one island, and acks one sink a call.",
     rules("J7-ONE"_rule, "J7-CHOICE"_rule)},
    {P::kListedAcked, "listed_acked", "A sink lists no mote that never acked it.",
     rules("J6-ADD"_rule, "J6-ISLAND"_rule)},
    {P::kListedSilent, "listed_silent",
     "A sink does not answer the request of a mote that it lists, nor without a request.",
     rules("J2-LISTED"_rule, "J3-ONCE"_rule)},
    {P::kAdmitted, "admitted",
     "A sink that hears ack_join with the number that it answered last to that mote lists it.",
     rules("J6-ADD"_rule, "J9-INTERLEAVE"_rule)},
    {P::kOneReport, "one_report",
     "Each join is reported once: one moteJoined and one serial_joined.",
     rules("J6-REPEAT"_rule, "J6-REPORT"_rule)},
    {P::kQueuesBounded, "queues_bounded",
     "Buffers hold no more than their places, lists no mote twice.",
     rules("N1-FULL"_rule, "J3-OVERWRITE"_rule)},
    {P::kJoinSucceeds, "join_succeeds",
     "Once faults stop, a joinIsland call succeeds and the sink lists the mote.",
     rules("J1-REQUEST"_rule, "J3-REPLY"_rule, "J4-ACK"_rule)},
    {P::kOwnIslandOnly, "own_island_only",
     "No application gets a message whose destination is another island.",
     rules("N5-FOREIGN"_rule, "N6-COLLISION"_rule)},
    {P::kReliableEnds, "reliable_ends", "Each reliable message ends in exactly one receive_ack.",
     rules("T3-ONCE"_rule, "T3-TIMEOUT"_rule)},
    {P::kAckCounts, "ack_counts", "The ack of a message that awaits it is signalled as success.",
     rules("T3-SUCCESS"_rule, "T4-SEVERAL"_rule)},
    {P::kMembersOnly, "members_only", "A mote that is not a member sends no net_msg.",
     rules("J11-SEND"_rule)},
    {P::kNoDeadlock, "no_deadlock", "Where something is left to do, something can happen.",
     rules("N2-QUEUE"_rule)},
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

}  // namespace rubric::explore
