// An ATmega128 in libsimavr. Its time is virtual and passes only within run().
#pragma once

#include <deque>
#include <memory>
#include <string>

#include "conformance/adapters/firmware/host/board.h"

struct avr_t;
struct avr_irq_t;

namespace rubric::firmware {

class AvrBoard : public SimulatedBoard {
 public:
  /// Throws BoardBroken if the file is no ELF file that could be loaded.
  explicit AvrBoard(std::string elf_file);
  ~AvrBoard() override;
  AvrBoard(const AvrBoard&) = delete;
  AvrBoard& operator=(const AvrBoard&) = delete;

  void power_on() override;
  void restart() override;
  Instant now() const override;
  bool has_clock() const override { return true; }
  void run(Instant end, Listener& listener) override;
  void stop() override { stopped_ = true; }
  void wait(Instant end) override;
  void put_link(Bytes bytes) override;
  void put_serial(Bytes bytes) override;
  bool serial_is_idle() const override { return serial_.waiting.empty(); }
  /// Returns the bytes between the data and the deepest point of the stack since power_on.
  std::size_t untouched_ram_bytes() const;

 private:
  // Bytes on their way to one of the processor's UARTs.
  struct Uart {
    AvrBoard* board = nullptr;
    bool is_link = false;
    Instant instants_per_byte = 0;
    avr_irq_t* input = nullptr;
    std::deque<std::uint16_t> waiting;  ///< Bytes, and silence.
    bool feeding = false;
  };
  struct Callbacks;

  void load();
  void connect(Uart& uart, char name);
  void put(Uart& uart, Bytes bytes);

  std::string elf_file_;
  avr_t* avr_ = nullptr;
  Listener* listener_ = nullptr;
  Uart link_;
  Uart serial_;
  bool stopped_ = false;
};

}  // namespace rubric::firmware
