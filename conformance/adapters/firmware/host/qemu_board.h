// An LM3S6965 in qemu-system-arm, whose UARTs are sockets.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <string>

#include "conformance/adapters/firmware/host/board.h"

namespace rubric::firmware {

class QemuBoard : public SimulatedBoard {
 public:
  /// kBoard: the processor's own, in real time, so that its load is seen, and that of the machine.
  /// kBench: time passes only as the bench says, so that each run is the same.
  enum class Clock { kBoard, kBench };

  /// `qemu` is the emulator, by name or path.
  QemuBoard(std::string qemu, std::string elf_file, Clock clock);
  ~QemuBoard() override;
  QemuBoard(const QemuBoard&) = delete;
  QemuBoard& operator=(const QemuBoard&) = delete;

  void power_on() override;
  void restart() override;
  Instant now() const override;
  bool has_clock() const override { return clock_ == Clock::kBoard; }
  void run(Instant end, Listener& listener) override;
  void stop() override { stopped_ = true; }
  void wait(Instant end) override;
  void put_link(Bytes bytes) override { put(link_, bytes); }
  void put_serial(Bytes bytes) override;
  bool serial_is_idle() const override { return true; }  // Its UART is not held up by bits.

 private:
  using Steady = std::chrono::steady_clock;

  void put(int descriptor, Bytes bytes);
  template <class Take>
  void read_some(int descriptor, Take take);
  void hear(std::chrono::nanoseconds longest, Listener& listener);
  void end_emulator();

  std::string qemu_;
  std::string elf_file_;
  Clock clock_;
  Instant bench_now_ = 0;
  Steady::time_point begin_ = Steady::now();
  pid_t emulator_ = -1;
  int link_ = -1;
  int serial_ = -1;
  Steady::time_point serial_free_ = begin_;  ///< When a line would have carried its bytes.
  bool stopped_ = false;
};

}  // namespace rubric::firmware
