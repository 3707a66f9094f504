// What joins surely owe and do not give, and the clock that a join sets. What is sent is judged by
// MoteJoins and SinkJoins; this asks them what can only be waited for.
#pragma once

#include <cstdint>
#include <vector>

#include "conformance/oracle/mote_join.h"
#include "conformance/oracle/sink_join.h"

namespace rubric::oracle {

class JoinWatch {
 public:
  JoinWatch(Context& context, MoteJoins& motes, SinkJoins& sinks, std::size_t devices);

  /// A log says when the node lost its memory.
  void rebooted(std::uint16_t node, std::int64_t now_us);
  /// A capture shows that it did, some time before.
  void begin_life(std::uint16_t node) { debts_[node].clear(); }
  /// Its application switches its radio on or off.
  void radio_set(std::uint16_t node, bool on, std::int64_t now_us);
  /// The node sends a frame on the air: what it owed since long it will not send any more.
  void showed_life(std::uint16_t node, std::int64_t now_us) { settle(node, now_us, false); }

  // Each behind the same call of MoteJoins or SinkJoins.
  void asked(std::uint16_t mote, std::uint32_t index);
  void surely_asked(std::uint16_t sink, std::uint32_t index, std::uint16_t seq_num);
  void answered(std::uint16_t sink, std::uint16_t mote_am, std::int64_t now_us);
  void surely_offered(std::uint16_t mote, std::uint32_t index, const Reply& reply);
  /// The application of `mote` is told its clock.
  void clock_told(std::uint16_t mote, const Observation& seen, std::uint32_t ms);
  void finish(std::int64_t end_us);

 private:
  static constexpr std::size_t kRoom = 64;  // Of a node; more is not waited for.

  enum class Owes : std::uint8_t { kRetry, kAck, kReply };
  struct Debt {
    Owes owes = Owes::kReply;
    bool overtaken = false;       ///< Another mote that asked later was answered before.
    std::uint16_t mote_am = 0;    ///< kReply: to whom.
    std::uint16_t seq_num = 0;
    std::uint32_t index = 0;      ///< The observation that caused it.
    std::int64_t due_us = 0;
  };

  bool waits(std::uint16_t node) const;
  void owe(std::uint16_t node, const Debt& debt);
  bool still_owed(std::uint16_t node, const Debt& debt);
  void settle(std::uint16_t node, std::int64_t now_us, bool end);
  void missing(std::uint16_t node, const Debt& debt, Severity severity);
  bool crowded(std::uint16_t node, const Debt& debt) const;

  Context& context_;
  MoteJoins& motes_;
  SinkJoins& sinks_;
  std::vector<std::vector<Debt>> debts_;  ///< By node.
  std::vector<bool> off_;                 ///< Its radio is switched off.
};

}  // namespace rubric::oracle
