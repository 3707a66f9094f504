// A board on the bench as its processor's simulator or emulator shows it: two UARTs and a clock.
#pragma once

#include <cstdint>
#include <stdexcept>

#include "codec/runtime/bytes.h"

namespace rubric::firmware {

/// Time since the program began, 7,372,800 to the second: a cycle of the ATmega128.
using Instant = std::uint64_t;
constexpr Instant kInstantsPerSecond = 7'372'800;
constexpr Instant kInstantsPerTick = kInstantsPerSecond / 1024;
static_assert(kInstantsPerTick * 1024 == kInstantsPerSecond);

/// The processor stopped, or its emulator went away.
class BoardBroken : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What the board sends, byte by byte, while it runs.
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
  /// New firmware, its memory cleared; it has not run yet.
  virtual void power_on() = 0;
  /// Runs it from its start again at `now`; memory is kept. What it was sending may be cut off.
  virtual void restart(Instant now) = 0;
  virtual Instant now() const = 0;
  /// Until `end`, or until a listener calls stop().
  virtual void run(Instant end, Listener& listener) = 0;
  virtual void stop() = 0;
  /// Bytes for the board; they take their time on the line.
  virtual void put_link(Bytes bytes) = 0;
  virtual void put_serial(Bytes bytes) = 0;
  /// Whether all bytes for the serial line have gone.
  virtual bool serial_is_idle() const = 0;
};

}  // namespace rubric::firmware
