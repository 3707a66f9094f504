// The lines of a node: a frame leaves now or waits in a circular buffer until the line is free.
// (paper: The Network level)
#pragma once

#include "conformance/machine/node.h"

namespace rubric::machine {

/// A frame to send, without its payload.
struct Header {
  Link link = Link::kRadio;
  std::uint8_t type = 0;
  std::uint16_t dest = 0;
  ReqId requirement = ReqId::kNone;
  bool link_ack = false;
  std::uint16_t awaited = kNoSeq;  ///< Its number, if its ack is awaited once it has left.
};

/// Where to write the payload of an accepted frame, so that it is written once and in place.
struct Place {
  std::uint8_t* payload = nullptr;  ///< Room for kAmPayloadMax bytes; null when refused.
  std::uint8_t* size_bytes = nullptr;
  explicit operator bool() const { return payload != nullptr; }
  MutableBytes room() const { return {payload, kAmPayloadMax}; }
};

/// Returns whether a role has such a line.
bool has_line(Role role, Link link);
/// Returns why the line refuses frames now: kN10Off, kN1Full; kNone if it takes one.
ReqId line_refusal(const State& state, Link link);
/// Takes a frame: it leaves now, or waits. If refused, labels it as ignored, and returns no place.
/// The place is to be filled at once.
Place put(Node& node, const Header& header);
/// Sends the first waiting frame, if the line allows.
void flush(Node& node, Link link);
/// Forgets frames of this AM type that wait for the radio.
void forget_waiting(State& state, std::uint8_t type);
/// Returns whether one waits.
bool is_waiting(const State& state, std::uint8_t type);

/// Handles the end of the last transmission.
void send_done(Node& node, const SendDone& event);
/// Handles that another station takes the line or leaves it.
void line_busy(Node& node, const LinkBusy& event);

/// Send the join messages of motes and sinks.
void send_join_request(Node& node, ReqId requirement);
void send_ack_join(Node& node, ReqId requirement);
void send_join_reply(Node& node, std::uint16_t dest, std::uint16_t seq_num);

}  // namespace rubric::machine
