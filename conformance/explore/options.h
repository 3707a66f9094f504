// The options of a search: how many nodes, which faults, how much of each.
#pragma once

#include <cstdint>

#include "conformance/explore/property.h"
#include "conformance/machine/step.h"

namespace rubric::explore {

constexpr std::size_t kMotesMax = 4;
constexpr std::size_t kSinksMax = 4;
constexpr std::size_t kNodesMax = 6;  ///< Motes and sinks together.

/// The machine's step, or a flaw around it.
using StepFunction = void (*)(machine::State&, machine::Ticks, const machine::Event&,
                              machine::Actions&);

enum class Scope : std::uint8_t {
  kJoin,  ///< The join protocol alone.
  kFull,  ///< And messages, reliable and not, of nodes that have joined.
};

struct Options {
  machine::Profile profile;
  StepFunction step = machine::step;
  Scope scope = Scope::kJoin;
  std::uint8_t motes = 1;
  std::uint8_t sinks = 1;
  bool loss = false;           ///< Frames in flight and link acks may be lost.
  bool dup = false;            ///< A frame may be heard again.
  bool reorder = false;        ///< Frames from one node to another may overtake each other.
  bool collide = false;        ///< Two frames on their way to one node may destroy each other.
  bool prompt = false;         ///< No frame outlives a timer: timers fire when the air is empty.
  bool busy = false;           ///< The end of each transmission is a step of its own.
  bool exact = false;          ///< Keeps apart states that differ in nothing that matters any more.
  std::uint8_t reboots = 0;    ///< For each mote.
  std::uint8_t calls = 1;      ///< joinIsland calls of each mote.
  std::uint8_t sends = 1;      ///< Messages of each node, in full scope.
  std::uint8_t dups = 0;       ///< Frames heard again, in all; 0: any number.
  std::uint8_t in_flight = 1;  ///< Copies of one frame on their way to one node.
  bool symmetry = true;        ///< Takes one for all states that differ in who is who (symmetry.h).
  bool partial_order = true;   ///< Mote by mote, where their steps are independent.
  bool liveness = false;       ///< Looks for fair runs that never end, too (liveness.h).
  Mask properties = kAllProperties;
  unsigned threads = 1;
  std::uint64_t states_max = 0;        ///< 0: no limit.
  std::uint64_t memory_max_bytes = 0;  ///< Of the whole process; 0: no limit.
};

constexpr std::uint16_t kFirstIsland = 11;  ///< Sink k's island is this + k.
constexpr std::uint16_t kFirstMoteId = 2;   ///< Mote k's TinyOS id is this + k.

}  // namespace rubric::explore
