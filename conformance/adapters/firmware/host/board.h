// A board on the bench, as its processor's simulator or emulator presents it: two UARTs and a
// clock.
#pragma once

#include <cstdint>
#include <stdexcept>

#include "codec/runtime/bytes.h"

namespace rubric::firmware {

/// Time, 7,372,800 to the second: a cycle of the ATmega128.
using Instant = std::uint64_t;
constexpr Instant kInstantsPerSecond = 7'372'800;
constexpr Instant kInstantsPerTick = kInstantsPerSecond / 1024;
static_assert(kInstantsPerTick * 1024 == kInstantsPerSecond);

/// The processor stopped, or its emulator went away.
class BoardBroken : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Gets the board's bytes, one by one, while it runs.
class Listener {
 public:
  virtual void link_byte(std::uint8_t byte) = 0;
  virtual void serial_byte(std::uint8_t byte) = 0;

 protected:
  ~Listener() = default;
};

class SimulatedBoard {
 public:
  virtual ~SimulatedBoard() = default;
  /// Loads new firmware and clears its memory; does not run it yet.
  virtual void power_on() = 0;
  /// Restarts it; memory is kept. A byte that it was sending may be cut off.
  virtual void restart() = 0;
  virtual Instant now() const = 0;
  /// Returns false if the firmware takes the time from the bench's records, not from a clock of
  /// the board. Then no time passes in run(), which waits until the board says something.
  virtual bool has_clock() const = 0;
  /// Runs until `end`, or until a listener calls stop().
  virtual void run(Instant end, Listener& listener) = 0;
  virtual void stop() = 0;
  /// Lets time pass to `end`, while a board with a clock has no power.
  virtual void wait(Instant end) = 0;
  /// Sends bytes to the board; they take their time on the line.
  virtual void put_link(Bytes bytes) = 0;
  virtual void put_serial(Bytes bytes) = 0;
  /// Returns whether all bytes for the serial line have gone.
  virtual bool serial_is_idle() const = 0;
};

}  // namespace rubric::firmware
