// Judges what joins surely owe and do not deliver, and the clock that a join sets. MoteJoins and
// SinkJoins judge what is sent; this asks them for what is still due.
#pragma once

#include <cstdint>
#include <vector>

#include "conformance/check/judge/mote_join.h"
#include "conformance/check/judge/sink_join.h"

namespace rubric::check {

class JoinWatch {
 public:
  JoinWatch(Context& context, MoteJoins& motes, SinkJoins& sinks, std::size_t devices);

  /// Notes that by a log the node lost its memory.
  void rebooted(std::uint16_t node, std::int64_t now_us);
  /// Notes that by a capture it did, some time before.
  void begin_life(std::uint16_t node) { debts_[node].clear(); }
  /// Notes that its application switches its radio on or off.
  void radio_set(std::uint16_t node, bool on, std::int64_t now_us);
  /// Notes that the node sends a frame on the air, so whatever it still owes is overdue.
  void showed_life(std::uint16_t node, std::int64_t now_us) { settle(node, now_us, false); }

  /// Called before the same function of MoteJoins: a request that the mote sends now, or the end of
  /// its call, is too late for a repetition that was due, where the join period is stated.
  void repeats(std::uint16_t mote, std::int64_t now_us);

  /// Called before MoteJoins takes a request: one with the number of an offer that it surely had
  /// shows that it did not take that.
  void asks_again(std::uint16_t mote, std::uint16_t seq_num, std::int64_t now_us);
  /// Notes that the sink passes on what its radio heard, while a mote that it surely heard waits.
  void hears_on(std::uint16_t sink, std::int64_t now_us);

  // Called after the same function of MoteJoins or SinkJoins.
  void asked(std::uint16_t mote, std::uint32_t index);
  void surely_asked(std::uint16_t sink, std::uint32_t index, std::uint16_t seq_num);
  void answered(std::uint16_t sink, std::uint16_t mote_am, const Place& at);
  void surely_offered(std::uint16_t mote, std::uint32_t index, const Reply& reply);
  /// Judges the clock that the application of `mote` is given.
  void clock_told(std::uint16_t mote, const Observation& seen, std::uint32_t ms);
  void finish();

 private:
  static constexpr std::size_t kRoom = 64;  // For each node; no more are awaited.

  enum class Owes : std::uint8_t { kRetry, kAck, kReply };
  struct Debt {
    Owes owes = Owes::kReply;
    bool overtaken = false;     ///< Another mote that asked later was answered before.
    std::uint16_t mote_am = 0;  ///< kReply: to whom.
    std::uint16_t seq_num = 0;
    std::uint32_t index = 0;  ///< The observation that caused it.
    std::int64_t due_us = 0;
  };

  bool waits(std::uint16_t node) const;
  std::int64_t waits_us(const Debt& debt) const;
  void owe(std::uint16_t node, const Debt& debt);
  bool still_owed(std::uint16_t node, const Debt& debt);
  bool forgets(std::uint16_t node, const Debt& debt);
  void settle(std::uint16_t node, std::int64_t now_us, bool end);
  void missing(std::uint16_t node, const Debt& debt, Severity severity);
  bool crowded(std::uint16_t node, const Debt& debt) const;

  Context& context_;
  MoteJoins& motes_;
  SinkJoins& sinks_;
  std::vector<std::vector<Debt>> debts_;  ///< By node.
  std::vector<bool> off_;                 ///< Its radio is switched off.
};

}  // namespace rubric::check
