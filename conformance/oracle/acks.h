// Reliable messages and their acks, as their receivers see them; and what is delivered.
#pragma once

#include <cstdint>
#include <vector>

#include "conformance/oracle/context.h"
#include "conformance/oracle/ring.h"

namespace rubric::oracle {

/// A message on its last hop to a node.
struct Arrived {
  Net net;
  Place place;
  std::uint16_t sender = kNobody;  ///< Of the last hop.
  ReqId forbidden = ReqId::kNone;  ///< Acking or delivering it breaks this rule.
  bool weak = false;
  bool must_ack = false;
  bool ackable = false;            ///< Apart from `free`: reliable, and so on.
  bool sure = false;               ///< It surely arrived.
  std::uint8_t copies = 1;
  std::uint8_t acks = 0;
  std::uint8_t delivered = 0;
};

/// What is known of an arrival.
struct Arrival {
  ReqId forbidden = ReqId::kNone;  ///< Why the message must have no effect at the node.
  bool weak = false;               ///< And that rule is a SHOULD.
  bool sure = false;               ///< The node surely received it.
  bool free = false;               ///< The node may ignore it.
};

class Acks {
 public:
  Acks(Context& context, std::size_t devices);

  void begin_life(std::uint16_t node);
  /// A message comes to `node`.
  void arrived(std::uint16_t node, const Observation& seen, std::uint16_t sender, const Net& net,
               const Arrival& arrival);
  void repeated(std::uint16_t node, const Net& net);
  /// A log says that the node received the message.
  void surely(std::uint16_t node, const Net& net);
  /// `node` sends an ack, which is a message of its own.
  void sent(std::uint16_t node, const Observation& seen, const Net& ack);
  /// Its application got a message, by a log.
  void delivered(std::uint16_t node, const Observation& seen, const machine::Received& received);
  /// It sent something at this time: what it owed since long it will not send any more.
  void showed_life(std::uint16_t node, std::int64_t now_us);
  void finish();

 private:
  static constexpr std::size_t kRoom = 64;

  void close(std::uint16_t node, Arrived& arrived);
  void refuse(std::uint16_t node, const Observation& seen, const Net& ack, std::int32_t acked,
              Arrived* best);

  Context& context_;
  std::vector<Ring<Arrived, kRoom>> arrived_;
  std::vector<std::uint16_t> owed_;  ///< Surely owed acks of each node.
};

}  // namespace rubric::oracle
