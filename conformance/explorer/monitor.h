// A node's history as seen from outside, as far as the properties of its own steps need it. It
// never reads the machine's state where frames and events of the application are enough.
#pragma once

#include <array>
#include <cstdint>

#include "conformance/explorer/options.h"

namespace rubric::explorer {

/// A message whose receive_ack is awaited by the application.
struct OpenSend {
  std::uint16_t seq_num = 0;
  std::uint8_t app_id = 0;
  friend bool operator==(const OpenSend&, const OpenSend&) = default;
};

/// A sink's answer to one mote.
struct Answered {
  bool ever = false;
  bool armed = false;         ///< Since the last moteJoined.
  std::uint16_t seq_num = 0;  ///< In the last join_reply.
  friend bool operator==(const Answered&, const Answered&) = default;
};

struct Monitor {
  // Budgets spent.
  std::uint8_t calls = 0;
  std::uint8_t reboots = 0;
  std::uint8_t sends = 0;
  // For a mote. Sets of islands are bits, the first sink's the lowest.
  bool open = false;             ///< A call without its terminal event.
  bool asked = false;            ///< It has sent a request: the next three are known.
  std::uint8_t requests = 0;     ///< In the present call.
  std::uint16_t present_seq = 0; ///< In its last request.
  std::uint8_t heard = 0;        ///< Islands that answered that number during the call.
  std::uint8_t chosen = 0;       ///< Islands acked for this call.
  std::uint8_t acked_ever = 0;   ///< Islands ever acked; survives a reboot.
  std::uint8_t view = 0;         ///< The island in the joined(SUCCESS) event.
  std::uint16_t on_air = 0;      ///< The frame whose link ack the radio awaits; 0: none.
  // For a sink.
  std::array<Answered, kMotesMax> answered{};
  std::int8_t owed_reports = 0;  ///< moteJoined without serial_joined yet.
  // For both.
  std::uint8_t open_sends = 0;
  std::array<OpenSend, 4> open_send{};

  friend bool operator==(const Monitor&, const Monitor&) = default;
};

/// One step of a node, as the monitor sees it.
struct Observed {
  const Options& options;
  const machine::State& before;
  const machine::Event& event;
  const machine::Actions& actions;
  const machine::State& after;
};

/// Results of a step.
struct Noted {
  Mask violated = 0;
  Mask goals = 0;
};

/// Updates the monitor for one step.
void observe(Monitor& monitor, const Observed& step, Noted& noted);

/// Returns the bit of an island in the sets above; 0 for one that no sink has.
std::uint8_t island_bit(const Options& options, std::uint16_t pid);
/// Returns the number of a mote, from its TinyOS id; -1 for others.
int mote_number(const Options& options, std::uint16_t devid);

}  // namespace rubric::explorer
