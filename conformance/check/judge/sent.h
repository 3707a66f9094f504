// Judges messages that nodes send of their own: addressing, numbers, repetitions, synaptic data.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "conformance/check/judge/context.h"
#include "conformance/check/judge/interface_watch.h"
#include "conformance/check/judge/sizes.h"
#include "conformance/check/ring.h"

namespace rubric::check {

/// Whether a node still waits for an ack: one on the air to it may be lost.
enum class Wait : std::uint8_t { kRuns, kPerhaps, kOver };

/// A message that a node has sent.
struct Sent {
  Net net;
  Place place;
  bool acked = false;          ///< Its ack was seen, on its way or at its end.
  Wait wait = Wait::kRuns;     ///< For its ack.
  bool ack_came = false;       ///< By a log the node was given an ack with its number.
  std::int64_t given_us = -1;  ///< When its ack surely reached the node, by a log.
  std::uint8_t told = 0;       ///< receive_ack events, by a log.
  bool reused = false;         ///< Its number was used again, so that events do not tell which.
  std::uint32_t order = 0;     ///< Among the frames of the node.
  std::int64_t called_us = 0;  ///< When its application asked for it; else when it left.
};

class Originals {
 public:
  Originals(Context& context, std::size_t devices);

  void begin_life(std::uint16_t node);
  /// Notes a call of send, by a log. Nothing need leave of one that has no address, or an interface
  /// off: then the island of `own` is 0.
  void called(std::uint16_t node, const Observation& seen, const machine::Send& call,
              machine::Address own);
  /// Returns whether messages of its application may fill the buffer of a line.
  bool full(std::uint16_t node, machine::Link line) const;
  /// Notes that the island of the node is now another one.
  void moved(std::uint16_t node) { moved_[node] = true; }
  bool has_moved(std::uint16_t node) const { return moved_[node]; }
  /// Notes that a frame of the node has that number, whoever's message it is.
  void used(std::uint16_t node, std::uint16_t number);
  /// Notes that an interface is switched: while it is off what waits stays, or may be lost.
  void switched(std::uint16_t node, const machine::SetInterface& set, std::int64_t now_us);
  void told(std::uint16_t node, const Observation& seen, const machine::SendResult& result);
  /// Notes that the node asks to join: in a capture it may have rebooted, and then awaits nothing.
  void asks_to_join(std::uint16_t node);
  /// Returns whether a call of its application, by a log, asked for such a message that did not
  /// leave yet.
  bool asked(std::uint16_t node, const Net& net) const;
  /// Returns whether by its log `node` accepted a message of this number that did not leave yet.
  bool accepted(std::uint16_t node, std::uint16_t number) const;
  /// Judges a message of its own that `node`, whose address is `own`, sends over `link`.
  void sent(std::uint16_t node, const Observation& seen, const Net& net, machine::Link link,
            machine::Address own);
  /// Counts any other frame of the node on the air.
  void counted(std::uint16_t node) { ++orders_[node]; }
  /// Notes that an ack of `number` is on its way to `node`, for which that leaves `wait`.
  void ack_heard(std::uint16_t node, const Net& ack, std::uint16_t number, Wait wait);
  /// Notes that by a log the node was given this ack.
  void ack_given(std::uint16_t node, const Net& ack, std::int64_t now_us);
  /// Judges receive_ack, by a log.
  void told(std::uint16_t node, const Observation& seen, const machine::AckReceived& ack);
  /// Judges what the node accepted and did not send, at the end of its life or of the run.
  void ends(std::uint16_t node, std::int64_t end_us, const InterfaceWatch& interfaces);
  void finish(const InterfaceWatch& interfaces);
  /// Judges what a message of the node holds, whoever wrote it.
  void judge_content(std::uint16_t node, const Observation& seen, const Net& net);

 private:
  static constexpr std::size_t kRoom = 128;
  static constexpr std::int64_t kTimeouts = 2;  ///< After so many assumed ones an event is missed.
  static constexpr std::int64_t kForever = 5;   ///< And after so many there is none.

  struct Call {
    const machine::Send* send = nullptr;
    std::optional<std::uint16_t> result;  ///< The number that it returned.
    std::optional<std::uint16_t> left;    ///< That of the message.
    Place place;
    bool free = false;                           ///< It need not leave, or that is not seen.
    machine::Link line = machine::Link::kRadio;  ///< By which it leaves.
    bool held = false;                           ///< Its interface is off, or it need not leave.
    std::int64_t since_us = 0;                   ///< It may leave: the call, or its interface on.
    bool self = false;                           ///< It is for the node itself.
    bool full = false;                           ///< send refused it, as the buffer was full.
    std::int64_t left_us = -1;                   ///< When it left.
    bool failed = false;                         ///< Its timeout was told before it left.
    std::int64_t told_us = 0;                    ///< When it returned `result`.
    std::optional<std::uint16_t> returns = {};   ///< `result`, known ahead where the log is plain.
  };

  /// Judges the end of a message that is forgotten now: was its application notified?
  void close(std::uint16_t node, std::size_t newest, std::int64_t now_us);
  void judge_address(std::uint16_t node, const Observation& seen, const Net& net,
                     machine::Link link, machine::Address own);
  void judge_result(std::uint16_t node, const Observation& seen, const Call& call);
  std::int64_t patience_us(std::uint16_t node) const;
  bool awaits(std::uint16_t node, const Sent& sent, std::int64_t now_us) const;
  void judge_late(std::uint16_t node, const Observation& seen, const Call& call,
                  machine::Link link);
  bool waits(std::uint16_t node, std::int64_t since_us, std::int64_t now_us);
  void judge_unsent(std::uint16_t node, std::int64_t end_us, const InterfaceWatch& interfaces);
  void judge_missing(std::uint16_t node, Call& call, std::int64_t now_us);
  std::size_t waiting(std::uint16_t node, machine::Link line) const;
  void judge_refused(std::uint16_t node, const Observation& seen, const Call& call);
  void judge_order(std::uint16_t node, const Observation& seen, const Call& later);
  /// Whether a call of its application asked for a message.
  enum class Asked : std::uint8_t { kUnknown, kYes, kNo };
  Asked judge_wrap(std::uint16_t node, const Observation& seen, const Net& net, machine::Link link);
  Sent* latest(std::uint16_t node, std::uint16_t number);
  std::uint8_t take_events(std::uint16_t node, std::uint16_t number);
  template <typename Fits>
  bool heard_ack(std::uint16_t node, std::uint16_t number, Fits fits) const;
  bool rightly_acked(std::uint16_t node, const Net& message) const;
  bool ill_acked(std::uint16_t node, const Net& message) const;
  void judge_number(std::uint16_t node, const Observation& seen, const Net& net, Asked asked,
                    Sent& before);

  Context& context_;
  std::vector<Ring<Sent, kRoom>> sent_;
  std::vector<std::uint32_t> orders_;
  std::vector<Stale> stale_;  ///< On the air.
  struct Ack {
    Net net;
    std::uint16_t number = 0;
  };
  std::vector<Ring<Ack, kRoom>> acks_;
  std::vector<Ring<Call, kRoom>> calls_;
  std::vector<bool> forgot_;             ///< Calls that may still leave were too many.
  std::vector<std::int64_t> strays_us_;  ///< When a node was last given an ack of nothing it sent.
  std::vector<bool> begun_;  ///< Its start is in the log, so that it has no older calls.
  std::vector<bool> moved_;  ///< Its application set the island of a base station.
};

}  // namespace rubric::check
