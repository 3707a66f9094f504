// Reliable messages and their acks, as their receivers see them; and what is delivered.
//
// Decides: whether a node may send each of its acks (T2-ONCE, T2-CONTENT, T2-LOOP, and the rules by
// which a message must have no effect), whether each reliable message that it surely received got
// its ack (T2-ACK), and, where a log has its application, whether that got what came and no more
// (T1-DELIVER, N2-IN-ORDER). Who sends a message, and what ends its waiting, is up to sent.h.
//
// Evidence: for each node the last messages whose last hop led to it (Arrived), kRoom of them and
// as many more as may still be delivered or acked, up to Ring::kMost. The caller says of each
// (Arrival) whether the machine's routing forbids it any effect, whether the node is free to ignore
// it (decisions 114, 116, 126), and whether it surely arrived: a log gave it to the node, the
// serial line confirmed it, or the link acknowledged a frame to the only known sink. An ack belongs
// to the message whose source is its destination and whose number is in its body; of several, to
// one that still waits for an ack. A message that reached the application has arrived, whatever was
// open before.
//
// Tolerance: an ack is due within the response time (decision 125) after the message's end; one
// after the sender's timeout is weak. A repetition by the link is one reception or two, so one ack
// or two are right (decision 111), and the first may come before it, where the frame that it
// repeats escaped. A node may ack a message that it is free to ignore, and must if it delivers it.
// Of what came by one line the acks that go by one line keep the order (decision 125), unless the
// application was busy or the buffers were full.
//
// Cannot know: whether a message arrived that nothing proves to have arrived; whether an ack
// escaped the sniffer; which of two messages with one source and number an ack means; whether a
// full buffer swallowed the ack.
//
// Why an inconclusive finding is never a failure here: a missing ack fails only if the message
// surely arrived, the response time is over, the node sent something afterwards, no bytes were
// damaged in between, not too many messages came at once (Context::crowded()), and the ack cannot
// have escaped: Context::without() says that of a node that acks by radio; on a serial line nothing
// escapes. What is still open when the run ends, or when its message is forgotten, is
// inconclusive, or no finding where a log shows that it never arrived. An ack of nothing that came
// fails only in a run that starts cold, with a complete sniffer, and at a sink of whose line both
// directions were recorded. A second ack fails only if no second copy of the message can have
// escaped. What the body of an ack or the rules about the message itself forbid fails at once (or
// is weak, where the rule is a SHOULD): nothing that escaped would put it right.
#pragma once

#include <array>
#include <cstdint>
#include <set>
#include <vector>

#include "conformance/check/judge/context.h"
#include "conformance/check/ring.h"

namespace rubric::check {

/// A message on its last hop to a node.
struct Arrived {
  Net net;
  Place place;
  std::int64_t whole_us = -1;                  ///< When the receiver has it whole,
  std::int64_t again_us = -1;                  ///< and when again.
  std::uint16_t sender = kNobody;              ///< The node that sent it on its last hop.
  machine::Link link = machine::Link::kRadio;  ///< By which it came.
  ReqId forbidden = ReqId::kNone;              ///< Acking or delivering it breaks this rule.
  bool weak = false;
  bool must_ack = false;
  bool to_self = false;   ///< Its dest is the node itself.
  bool ackable = false;   ///< Apart from `free`: reliable, to the node itself, and so on.
  bool no_room = false;   ///< Its ack may have found no room (decision 122).
  bool doubtful = false;  ///< The node may not be a member.
  ReqId delivers =
      ReqId::kNone;         ///< Why the application gets it, if it arrived; kNone: it need not.
  bool sure = false;        ///< It surely arrived.
  bool came = false;        ///< By a log the node was given it, switched off or not.
  std::uint32_t order = 0;  ///< Counts what came to the node.
  std::int64_t overtaken_us = -1;  ///< When its application got what came later by the same line.
  std::uint8_t copies = 1;
  std::uint8_t acks = 0;
  std::uint8_t delivered = 0;

  /// Returns whether the node has only to pass it on, so that another one acks it.
  bool passes_on() const {
    return forbidden == "N6-DELIVER"_rule || forbidden == "N7-DELIVER"_rule ||
           forbidden == "N8-DELIVER"_rule;
  }
};

/// The facts about an arrival.
struct Arrival {
  ReqId forbidden = ReqId::kNone;  ///< Why the message must have no effect at the node.
  bool weak = false;               ///< And that rule is a SHOULD.
  bool sure = false;               ///< The node surely received it.
  bool free = false;               ///< The node may ignore it.
  bool doubtful = false;           ///< The node may not be a member, and then must ignore it.
  ReqId delivers = ReqId::kNone;   ///< Why the application gets it; kNone: it need not.
  bool no_room = false;            ///< Messages of its application fill the ack's buffer.
  bool to_self = true;             ///< Its dest is the node itself.
  bool came = false;               ///< By a log the node was given it, switched off or not.
};

class Acks {
 public:
  Acks(Context& context, std::size_t devices);

  void begin_life(std::uint16_t node, std::int64_t since_us);
  /// Notes that a message comes to `node`.
  void arrived(std::uint16_t node, const Observation& seen, std::uint16_t sender, const Net& net,
               const Arrival& arrival);
  void repeated(std::uint16_t node, const Net& net, std::int64_t now_us);
  /// Notes that by a log the node was given the message, switched off or not; returns whether it is
  /// one that somebody sent.
  bool came(std::uint16_t node, const Net& net);
  /// Notes that by a log the node received the message.
  /// `may`: it is on then, and may be a member, whatever it was when the message was sent.
  void surely(std::uint16_t node, const Net& net, std::int64_t now_us, bool may, bool no_room);
  /// Judges an ack that `node` sends as a message of its own; who gets it waits `timeout_us` for
  /// it.
  void sent(std::uint16_t node, const Observation& seen, const Net& ack, std::int64_t timeout_us);
  /// Judges a message that by a log the application of `node` got.
  void delivered(std::uint16_t node, const Observation& seen, const machine::Received& received);
  /// Judges by a log whether the application of `node` is told of this ack in the order of arrival.
  void told(std::uint16_t node, const Observation& seen, std::uint16_t number);
  /// Notes that the node sent something at this time, so whatever it still owes is overdue.
  void showed_life(std::uint16_t node, std::int64_t now_us);
  /// Judges what the node owes, by a log that has all that it does until then.
  void overdue(std::uint16_t node, std::int64_t now_us);
  /// Notes that an interface was switched off or the island changed: what is not yet overdue may
  /// never be acked, and, unless its application `still_gets` it, never delivered.
  void interrupted(std::uint16_t node, std::int64_t now_us, bool still_gets = false);
  /// Returns whether the node has acked a message for that application, so that it has one.
  bool acks_for(std::uint16_t node, std::uint8_t app_id) const {
    return apps_[node].acked.contains(app_id);
  }
  void finish();

 private:
  static constexpr std::size_t kRoom = 64;

  Arrived* find(std::uint16_t node, const Net& net);
  bool waits(std::uint16_t node, const Arrived& arrived, std::int64_t now_us);
  void close(std::uint16_t node, Arrived& arrived);
  void missing_ack(std::uint16_t node, Arrived& arrived, std::int64_t now_us, bool lives);
  void missing_delivery(std::uint16_t node, Arrived& arrived, std::int64_t now_us);
  bool never_came(std::uint16_t node, const Arrived& arrived) const;
  bool overtaken(std::uint16_t node, const Arrived& arrived);
  bool lacks_delivery(std::uint16_t node, const Arrived& arrived);
  void meant_ack(std::uint16_t node, const Net& ack);
  std::int64_t queued_us(std::uint16_t node, const Arrived& arrived);
  bool delivered_before(std::uint16_t node, const Arrived& arrived);
  void judge_order(std::uint16_t node, const Observation& seen, const Arrived& arrived);
  void judge_ack_order(std::uint16_t node, const Observation& seen, const Arrived& acked);
  void refuse(std::uint16_t node, const Observation& seen, const Net& ack, std::int32_t acked,
              Arrived* best);

  Context& context_;
  std::vector<Ring<Arrived, kRoom>> arrived_;
  std::vector<std::uint16_t> owed_;  ///< Surely owed acks of each node.
  struct Order {
    std::uint32_t came = 0;  ///< How many messages.
    /// The latest of each line that its application got: lines have no order (decision 125).
    std::array<std::uint32_t, 3> delivered{};
  };
  std::vector<Order> orders_;
  struct Apps {                        // APPIDs of messages,
    std::set<std::uint8_t> acked;      // that the node acked,
    std::set<std::uint8_t> delivered;  // that by its log its application got.
  };
  std::vector<Apps> apps_;
  struct Early {
    machine::Address to;
    std::uint16_t acked = 0;
    std::int64_t time_us = INT64_MIN / 2;
  };
  std::vector<Early> early_;  ///< By node: its last ack of a message that was not captured before.
};

}  // namespace rubric::check
