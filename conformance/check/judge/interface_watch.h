// Judges interfaces that applications switch, where a log has their calls.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "conformance/check/judge/context.h"

namespace rubric::check {

class InterfaceWatch {
 public:
  InterfaceWatch(Context& context, std::size_t devices) : context_(context), nodes_(devices) {}

  void begin_life(std::uint16_t node);
  void called(std::uint16_t node, const Observation& seen);
  void told(std::uint16_t node, const Observation& seen);
  /// Judges a frame that `node` sends: was its interface on, and its line free?
  void sent(std::uint16_t node, const Observation& seen);
  /// Notes a message of the node's own.
  void own_message(std::uint16_t node, const Observation& seen, std::uint16_t seq_num);
  /// Returns whether the interface was off for so long that no frame from before can still come.
  bool off(std::uint16_t node, machine::Link link, std::int64_t now_us) const;
  /// Returns whether it is switched off; frames that were just on their way may still have come.
  bool switched_off(std::uint16_t node, machine::Link link) const;
  /// Returns since when it is on, 0 if it always was; -1 while it is off.
  std::int64_t on_since(std::uint16_t node, machine::Link link) const;
  /// Returns the number of the message that shows whether the radio sends again; none otherwise.
  std::optional<std::uint16_t> awaits(std::uint16_t node) const { return nodes_[node].awaited; }
  void finish();

 private:
  struct Interface {
    std::optional<bool> on;  ///< Nothing: a node that runs since before the log.
    std::int64_t changed_us = 0;
    bool again = false;          ///< Switched on again, and not yet seen to send.
    std::optional<Place> asked;  ///< For its state, without an answer yet.
  };
  struct Node {
    std::array<Interface, 2> interfaces;  ///< Radio and serial.
    bool begun = false;
    bool sends = false;                    ///< send was called since, and its result is awaited.
    std::optional<std::uint16_t> left;     ///< The number of a message that left since the call.
    std::optional<std::uint16_t> awaited;  ///< The number of a message accepted since then.
    Place accepted;
    bool sends_off = false;                 ///< The last call of send came while the radio was off,
    std::optional<std::uint16_t> off_next;  ///< and accepted the message with this number.
  };

  Node& look(std::uint16_t node);
  static Interface* find(Node& node, machine::Link link);
  void judge_untold(std::uint16_t node, const Interface& interface, std::int64_t now_us);
  void judge_off(std::uint16_t node, const Observation& seen, Node& watch, std::uint16_t seq_num);

  Context& context_;
  std::vector<Node> nodes_;
};

}  // namespace rubric::check
