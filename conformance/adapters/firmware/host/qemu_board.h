// An LM3S6965 in qemu-system-arm, whose UARTs are TCP connections. Its time is real.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

#include "conformance/adapters/firmware/host/board.h"

namespace rubric::firmware {

/// A port of 127.0.0.1 at which connections are awaited.
class LoopbackPort {
 public:
  /// Throws BoardBroken if there is none.
  LoopbackPort();
  ~LoopbackPort();
  LoopbackPort(const LoopbackPort&) = delete;
  LoopbackPort& operator=(const LoopbackPort&) = delete;

  std::uint16_t port() const { return port_; }
  /// Returns the next connection, which the caller closes; -1 if none came within `wait`.
  int accept(std::chrono::milliseconds wait) const;
  /// Does the same, but calls `is_hopeless` often and ends at once when it returns true.
  int accept(std::chrono::milliseconds wait, const std::function<bool()>& is_hopeless) const;

 private:
  int listener_ = -1;
  std::uint16_t port_ = 0;
};

class QemuBoard : public SimulatedBoard {
 public:
  /// `qemu` is the emulator, by name or path.
  QemuBoard(std::string qemu, std::string elf_file);
  ~QemuBoard() override;
  QemuBoard(const QemuBoard&) = delete;
  QemuBoard& operator=(const QemuBoard&) = delete;

  void power_on() override;
  void restart(Instant now) override;
  Instant now() const override;
  void run(Instant end, Listener& listener) override;
  void stop() override { stopped_ = true; }
  void put_link(Bytes bytes) override { put(link_, bytes); }
  void put_serial(Bytes bytes) override;
  bool serial_is_idle() const override { return true; }  // Its UART is not held up by bits.

 private:
  using Steady = std::chrono::steady_clock;

  void put(int descriptor, Bytes bytes);
  template <class Take>
  void read_some(int descriptor, Take take);
  int connected(const LoopbackPort& port);
  void end_emulator();

  std::string qemu_;
  std::string elf_file_;
  Steady::time_point begin_ = Steady::now();
  pid_t emulator_ = -1;
  int link_ = -1;
  int serial_ = -1;
  Steady::time_point serial_free_ = begin_;  ///< When a line would have carried its bytes.
  bool stopped_ = false;
};

}  // namespace rubric::firmware
