// Single nodes: every state that a node was ever in, each kept once under a number, and the result
// of step() for each event, computed once. A network's state is then a few numbers.
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

#include "conformance/explore/history.h"
#include "conformance/explore/options.h"

namespace rubric::explore {

/// A list that grows without moving its elements, so that others may read while one appends.
/// Appending needs a lock. Reading an element learned of through that lock, or through a barrier
/// after it, needs none.
template <typename T, std::size_t kChunk = 1024, std::size_t kChunks = 16384>
class ChunkedList {
 public:
  std::size_t size() const { return size_; }
  bool full() const { return size_ == kChunk * kChunks; }
  T& operator[](std::size_t i) { return chunks_[i / kChunk][i % kChunk]; }
  const T& operator[](std::size_t i) const { return chunks_[i / kChunk][i % kChunk]; }
  T& push(T value) {
    assert(!full());
    auto& chunk = chunks_[size_ / kChunk];
    if (!chunk) chunk = std::make_unique<T[]>(kChunk);
    return chunk[size_++ % kChunk] = std::move(value);
  }

 private:
  std::array<std::unique_ptr<T[]>, kChunks> chunks_;
  std::size_t size_ = 0;
};

using NodeId = std::uint32_t;   ///< A node's state with its monitor.
using FrameId = std::uint16_t;  ///< A frame on the radio; 0 is a link ack.

/// An event of a node, as a number: one of these, or kFrame + the frame that it hears.
namespace event {
constexpr std::uint32_t kCall = 0;  ///< joinIsland.
constexpr std::uint32_t kJoinTimer = 1;
constexpr std::uint32_t kDoneAcked = 2;    ///< The radio has sent, and a link ack came,
constexpr std::uint32_t kDoneUnacked = 3;  ///< or none.
constexpr std::uint32_t kDoneSerial = 4;
constexpr std::uint32_t kReboot = 5;
constexpr std::uint32_t kAckTimer = 8;  ///< + index of the awaited message.
constexpr std::uint32_t kSend = 16;     ///< + which of the messages that the node may send.
constexpr std::uint32_t kFrame = 32;
}  // namespace event

/// A node's history, and what it has spent of what may happen to it.
struct Monitor {
  std::uint8_t calls = 0;
  std::uint8_t reboots = 0;
  std::uint8_t sends = 0;
  FrameId on_air = 0;  ///< The frame whose link ack the radio awaits; 0: none.
  History history;
  friend bool operator==(const Monitor&, const Monitor&) = default;
};

/// A node's state with its history.
struct NodeState {
  machine::State state;
  Monitor monitor;
  friend bool operator==(const NodeState&, const NodeState&) = default;
};

/// The step that first made a node's state or a frame: an event of a node.
struct Origin {
  static constexpr std::uint32_t kStart = ~std::uint32_t{0};
  NodeId before = 0;            ///< The node before the step,
  std::uint32_t what = kStart;  ///< and its event; kStart: it is how a node begins.
  std::uint8_t frame = 0;       ///< Of the frames that it sent, for a frame.
};

/// The facts about a node's state that the network needs.
struct NodeFacts {
  std::uint8_t node = 0;  ///< Whose state it is.
  bool join_timer = false;
  bool may_call = false;
  bool may_reboot = false;
  bool open = false;        ///< Its call has not ended.
  bool open_sends = false;  ///< A reliable message has not ended.
  bool radio_sending = false;
  bool serial_sending = false;
  bool waiting = false;  ///< Something is in a buffer.
  std::uint8_t ack_timers = 0;
  std::uint8_t sends = 0;       ///< Messages to choose from; 0: it may not send.
  std::uint8_t view = 0;        ///< For a mote: its island, as a bit.
  std::uint8_t acked_ever = 0;  ///< Islands that it ever acked, as bits.
  std::uint8_t listed = 0;      ///< For a sink: the motes that it lists, as bits.
  std::uint8_t reboots = 0;
  FrameId on_air = 0;  ///< The frame whose link ack it awaits.
  friend bool operator==(const NodeFacts&, const NodeFacts&) = default;
};

/// The result of an event at a node.
struct Outcome {
  static constexpr std::size_t kFramesMax = 11;
  NodeId next = 0;
  Mask violated = 0;
  Mask goals = 0;
  bool overflow = false;  ///< More frames than fit: the search is not complete.
  std::uint8_t frames = 0;
  std::array<FrameId, kFramesMax> frame{};  ///< Sent on the radio, in order.
  Origin of;                                ///< The step.
};

/// A message that a node may send in full scope.
struct SendChoice {
  machine::Address dest;
  bool reliable = false;
  friend bool operator==(const SendChoice&, const SendChoice&) = default;
};

class Nodes {
 public:
  explicit Nodes(const Options& options);

  const Options& options() const { return options_; }
  std::size_t count() const { return std::size_t{options_.motes} + options_.sinks; }
  bool is_mote(std::size_t node) const { return node < options_.motes; }
  /// Returns a node's configuration; motes come first.
  machine::Config config_of(std::size_t node) const;
  NodeId initial(std::size_t node) const { return initial_[node]; }

  const NodeState& state(NodeId id) const { return states_[id].node; }
  const NodeFacts& facts(NodeId id) const { return states_[id].facts; }
  const Origin& origin(NodeId id) const { return states_[id].origin; }
  const machine::Transmit& frame(FrameId id) const { return frames_[id].transmit; }
  const Origin& frame_origin(FrameId id) const { return frames_[id].origin; }

  /// Returns the outcome, at a stable address. Thread-safe.
  const Outcome& outcome(NodeId node, std::uint32_t what);

  std::size_t outcomes() const { return outcomes_.size(); }
  /// Returns the i-th outcome that was computed.
  const Outcome& outcome_at(std::size_t i) const { return outcomes_[i]; }
  std::size_t states() const { return states_.size(); }
  std::size_t frames() const { return frames_.size() - 1; }
  std::size_t memory_bytes() const;
  /// Returns whether the given step ever visibly did something that the machine's own would not
  /// have done. False if the two are the same.
  bool step_acted() const { return step_acted_; }
  /// Returns whether a table is full: then outcomes are wrong and the search has to stop.
  bool full() const { return full_; }

  /// Returns the machine's event; `frame` must stay while it is used.
  machine::Event event_of(const machine::State& state, const Monitor& monitor, std::uint32_t what,
                          const machine::Transmit* frame) const;
  std::vector<SendChoice> choices(const machine::State& state, const Monitor& monitor) const;

 private:
  struct Entry {
    NodeState node;
    NodeFacts facts;
    Origin origin;
  };
  struct Frame {
    machine::Transmit transmit;
    Origin origin;
  };
  Outcome compute(NodeId node, std::uint32_t what);
  void step(NodeState& node, const machine::Event& event, Outcome& outcome);
  Noted observe(History& history, const machine::State& before, const machine::Event& event,
                const machine::Actions& actions, const machine::State& after) const;
  bool same_as_machine(const NodeState& before, const machine::Event& event, const NodeState& after,
                       const machine::Actions& actions) const;
  NodeId intern(const NodeState& node, const Origin& origin);
  FrameId intern(const machine::Transmit& frame, const Origin& origin);
  NodeFacts facts_of(const NodeState& node) const;

  Options options_;
  std::mutex mutex_;
  ChunkedList<Entry, 64, 65536> states_;
  ChunkedList<Frame, 256, 256> frames_;
  ChunkedList<Outcome, 1024, 65536> outcomes_;
  std::unordered_multimap<std::uint64_t, NodeId> state_ids_;
  std::unordered_map<std::string, FrameId> frame_ids_;
  std::unordered_map<std::uint64_t, std::size_t> memo_;
  std::array<NodeId, kNodesMax> initial_{};
  bool full_ = false;
  bool step_acted_ = false;
};

/// A thread's own cache of outcomes, without locks for those that it has asked for before.
class OutcomeCache {
 public:
  explicit OutcomeCache(Nodes& nodes) : nodes_(nodes), slots_(1U << 12) {}
  const Outcome& operator()(NodeId node, std::uint32_t what) {
    const std::uint64_t key = (std::uint64_t{node} << 24 | what) + 1;
    std::size_t i = (key * 0x9E3779B97F4A7C15U) >> 32 & (slots_.size() - 1);
    while (slots_[i].key != key) {
      if (slots_[i].key == 0) return insert(key, node, what);
      i = (i + 1) & (slots_.size() - 1);
    }
    return *slots_[i].outcome;
  }

 private:
  struct Slot {
    std::uint64_t key = 0;
    const Outcome* outcome = nullptr;
  };
  const Outcome& insert(std::uint64_t key, NodeId node, std::uint32_t what);
  void put(std::vector<Slot>& slots, Slot slot) const;

  Nodes& nodes_;
  std::vector<Slot> slots_;
  std::size_t used_ = 0;
};

}  // namespace rubric::explore
