// Properties that every state and step of a network must have, and goals that some must reach.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "codec/runtime/rule.h"

namespace rubric::explore {

/// A set of properties, or of goals, one bit each.
using Mask = std::uint32_t;

/// The properties. If one state breaks several, the first of this order is reported.
enum class Property : std::uint8_t {
  kJoinedAfterReply,
  kAckRightSeq,
  kRequestsBounded,
  kOneTerminal,
  kOneIsland,
  kListedAcked,
  kListedSilent,
  kAdmitted,
  kOneReport,
  kQueuesBounded,
  kJoinSucceeds,
  kOwnIslandOnly,
  kReliableEnds,
  kAckCounts,
  kMembersOnly,
  kNoDeadlock,
};
constexpr std::size_t kPropertyCount = 16;
constexpr Mask bit(Property property) { return Mask{1} << static_cast<unsigned>(property); }
constexpr Mask kAllProperties = (Mask{1} << kPropertyCount) - 1;

struct PropertyInfo {
  Property property;
  const char* name;
  const char* sentence;
  std::array<ReqId, 3> requirements;  ///< The rules that it covers; kNone fills up.
};
/// Returns all, in the order of the enumeration.
std::span<const PropertyInfo, kPropertyCount> properties();
const PropertyInfo& info(Property property);
std::optional<Property> property_named(std::string_view name);

/// Events that some state or step must show, or the properties are true of nothing.
enum class Goal : std::uint8_t {
  kJoinedFirst,     ///< A mote joined the first sink's island,
  kJoinedSecond,    ///< and the second's.
  kFailed,          ///< joined(FAIL) after the last request.
  kJoinedAgain,     ///< joinIsland of a member failed at once.
  kRetried,         ///< A request was repeated.
  kStaleReply,      ///< A reply with an old number reached a mote that was joining.
  kSecondOffer,     ///< A reply of another sink reached a mote that had chosen.
  kListed,          ///< A sink listed a mote.
  kRepeatedAck,     ///< A sink heard the ack_join of a listed mote again.
  kInterleaved,     ///< Two joins were pending at one sink.
  kSameIsland,      ///< Two motes were members of one island,
  kTwoIslands,      ///< and of two.
  kOrphan,          ///< A member that its sink does not list, and nothing on its way to change it.
  kGhost,           ///< A sink listed a mote that was not a member of its island.
  kDelivered,       ///< A message reached an application.
  kAckedMessage,    ///< A reliable message ended in success,
  kTimedOut,        ///< and in failure.
  kForeignIgnored,  ///< A message for another island was heard and not delivered.
};
constexpr std::size_t kGoalCount = 18;
constexpr Mask bit(Goal goal) { return Mask{1} << static_cast<unsigned>(goal); }

struct GoalInfo {
  Goal goal;
  const char* name;
  const char* sentence;
};
std::span<const GoalInfo, kGoalCount> goals();

}  // namespace rubric::explore
