// Applications, which run on a node: they call the layer and are notified by it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "conformance/machine/event.h"
#include "conformance/simulate/random.h"
#include "conformance/simulate/time.h"

namespace rubric::simulate {

/// A node as its application sees it.
class Host {
 public:
  virtual ~Host() = default;
  virtual Micros now() const = 0;
  /// Makes the call as soon as the node has finished its present step; copies bytes.
  virtual void call(const machine::Call& call) = 0;
  /// Calls woken(token) after a delay, unless the node's power fails before.
  virtual void wake_after(Micros delay_us, std::uint32_t token) = 0;
  /// Switches the power off, and on again, after which booted() is called. A negative delay means
  /// never.
  virtual void power_off(Micros on_after_us) = 0;
  virtual Random& random() = 0;
};

class Application {
 public:
  virtual ~Application() = default;
  /// Called when the node has power: at the start of the run, and after each power_off().
  virtual void booted(Host&) {}
  virtual void woken(Host&, std::uint32_t /*token*/) {}
  /// Called with a notice; its bytes live until this returns.
  virtual void told(Host&, const machine::Notice&) {}
};

}  // namespace rubric::simulate
