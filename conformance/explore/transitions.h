// State diagrams of the parts of a node, found by exploring small networks: they show the machine's
// behaviour, not a drawing of it.
//
// A part (a mote's join, a sink's view of one mote, a reliable message) has a few states, each a
// predicate over a node's whole state. Every step that a node makes anywhere in the network becomes
// a transition: from which of these states to which, on what trigger, with what output, by which
// rules.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "conformance/explore/options.h"

namespace rubric::explore {

/// An event of a node, which owns its frame.
struct Given {
  machine::Event what;  ///< Not for Heard.
  std::optional<machine::Transmit> heard;
  machine::Event event() const { return heard ? machine::Heard{heard->frame()} : what; }
  std::string text() const;  ///< "join_reply(island_addr=11 ...)".
};

/// The inputs of a node from its start on. The ends of transmissions that nobody waits for are left
/// out: they come at once.
struct Witness {
  machine::Config config;
  std::vector<Given> events;
};

/// A step that a part makes: from one of its states to another, or to the same one. Steps that are
/// alike but for their guards are one.
struct Transition {
  std::size_t from = 0;              ///< Index into Diagram::states.
  std::size_t to = 0;                ///< The same.
  std::string trigger;               ///< "join_reply", "join timer".
  std::vector<std::string> guards;   ///< Any of them holds; none: always.
  std::vector<std::string> outputs;  ///< "ack_join", "joined(success)", in their order.
  std::vector<std::string> rules;    ///< Named by the machine, each once.
  bool ignored = false;              ///< Nothing came of it, and a rule says so.
  Witness witness;                   ///< A shortest path through the network to it.
};

/// All transitions of one part of a node in the networks that were explored.
struct Diagram {
  std::string name;  ///< "join"
  std::string title;
  std::vector<std::string> states;      ///< The first is where a node starts.
  std::vector<Transition> transitions;  ///< In an order that depends on nothing but them.
  std::uint64_t worlds = 0;             ///< States of networks that were tried.
  bool complete = true;                 ///< All of them.
};

/// The names of a part: on the command line, and above its diagram.
struct PartName {
  const char* name;
  const char* title;
};
/// Returns the names of parts() (parts.h), in order; they live as long as the program.
std::span<const PartName> part_names();

/// Explores the networks that show this part. `part` is one of part_names(), `step` the machine's
/// or a flaw's.
Diagram transitions_of(std::string_view part, const machine::Profile& profile,
                       StepFunction step = machine::step);

/// Gives a fresh node the witness's inputs. Returns its last step as a transition of the part, with
/// one guard at most; nothing if that step does not concern the part.
std::optional<Transition> replay(std::string_view part, const Witness& witness,
                                 StepFunction step = machine::step);

}  // namespace rubric::explore
