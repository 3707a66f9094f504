// What runs on top of a node: it calls the layer and is told what happens.
#pragma once

#include <cstddef>
#include <cstdint>

#include "conformance/machine/event.h"
#include "conformance/simulator/random.h"
#include "conformance/simulator/time.h"

namespace rubric::simulator {

/// A node as its application sees it.
class Host {
 public:
  virtual ~Host() = default;
  virtual Micros now() const = 0;
  /// Makes the call as soon as what the node is doing now is done; bytes are copied.
  virtual void call(const machine::Call& call) = 0;
  /// woken(token) after a delay, unless the node's power fails before.
  virtual void wake_after(Micros delay_us, std::uint32_t token) = 0;
  /// Power off, and on again; booted() follows. A negative delay: never on again.
  virtual void power_off(Micros on_after_us) = 0;
  virtual Random& random() = 0;
};

class Application {
 public:
  virtual ~Application() = default;
  /// The node has power: at the start of the run, and after each power_off().
  virtual void booted(Host&) {}
  virtual void woken(Host&, std::uint32_t /*token*/) {}
  /// Bytes of the notice live until this returns.
  virtual void told(Host&, const machine::Notice&) {}
};

}  // namespace rubric::simulator
