// The Communication Layer of a station: the project's own node, or another implementation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "conformance/machine/event.h"
#include "conformance/node/types.h"

namespace rubric::run {

/// What a layer does by itself.
class LayerUser {
 public:
  /// Puts a packet on a line, from its dispatch byte on. Layer::sent() follows, perhaps before this
  /// returns.
  virtual void transmit(node::Line line, Bytes packet, bool link_ack) = 0;
  virtual void happened(const machine::Notice& notice) = 0;

 protected:
  ~LayerUser() = default;
};

/// Begins at tick 0, when it is made. Everything happens at the time of the last run(). It calls
/// its user from within all functions, who may call it from there.
class Layer {
 public:
  virtual ~Layer() = default;
  /// Does what is due; returns when it wants to run next; nothing: no timer runs.
  virtual std::optional<node::Ticks> run(node::Ticks now) = 0;
  virtual void received(node::Line line, Bytes packet) = 0;
  virtual void sent(node::Line line, bool acked) = 0;
  /// Returns the call's result; nothing for joinIsland. Throws std::invalid_argument if there is no
  /// such call.
  virtual std::optional<machine::Notice> call(const machine::Call& call) = 0;
  /// Returns whether its radio is on.
  virtual bool listens() const = 0;
  virtual std::uint16_t island() const = 0;
  /// Returns how many motes fill a sink's list; 0: it has room, or there is none.
  virtual std::size_t full_list() const { return 0; }
  /// Returns how many messages of the serial line a sink has dropped, as its radio was behind.
  virtual std::size_t dropped() const { return 0; }
  /// Returns why such a message would be refused now, if the layer knows.
  virtual node::Refusal refusal(const machine::Send&) const { return node::Refusal::kNone; }
};

}  // namespace rubric::run
