// A node on a Cortex-M3, an LM3S6965 at its 12.5 MHz after reset: UART 0 is the serial line at
// 115200 baud, UART 1 the test bench's link at 460800 baud, SysTick the clock. Timer 0 wakes the
// processor once a tick; should a wake come late, as in emulators, no time is lost.
#include "conformance/adapters/firmware/arm/registers.h"
#include "conformance/adapters/firmware/bench/bench.h"

namespace {

using namespace rubric::firmware;
using namespace lm3s;

constexpr uint32_t kHertz = 12500000;
constexpr uint32_t kTicksPerSecond = 1024;
// A tick is no whole number of cycles, but of 32nds of them.
constexpr uint32_t kParts = 32;
constexpr uint32_t kTickParts = kHertz / kTicksPerSecond * kParts + 1;
static_assert(uint64_t{kTickParts} * kTicksPerSecond == uint64_t{kHertz} * kParts, "exact");

uint16_t kept_seq_num __attribute__((section(".noinit")));

volatile bool ticked;
volatile uint16_t serial_bytes;

class Arm : public Board {
 public:
  /// Returns the time; to be called more often than SysTick wraps, every 1.3 s.
  Ticks now() const override {
    const uint32_t value = at(kSysTickValue);
    parts_ += ((value_ - value) & kSysTickMax) * kParts;  // It counts down.
    value_ = value;
    ticks_ += parts_ / kTickParts;
    parts_ %= kTickParts;
    return ticks_;
  }
  void put(uint8_t byte) override {
    while ((at(kUart1 + kUartFlags) & kTransmitFull) != 0) {
    }
    at(kUart1 + kUartData) = byte;
  }
  void start_clock() override {
    at(kSysTickReload) = kSysTickMax;
    at(kSysTickValue) = 0;
    at(kSysTickControl) = kSysTickOn;
    value_ = at(kSysTickValue);
    at(kTimer0 + kTimerMode) = kTimerPeriodic;
    at(kTimer0 + kTimerReload) = kHertz / kTicksPerSecond;
    at(kTimer0 + kTimerMask) = 1;
    at(kTimer0 + kTimerControl) = 1;
    at(kInterruptEnable) = kTimer0Interrupt;
  }
  uint16_t serial_bytes() const override { return ::serial_bytes; }
  uint16_t& kept_seq_num() override { return ::kept_seq_num; }
  void restart() override {
    at(kResetControl) = kResetRequest;
    for (;;) {
    }
  }
  void start_uarts() {
    at(kGateUartsAndTimers) = at(kGateUartsAndTimers) | 3 | kTimer0Gate;
    at(kGatePorts) = at(kGatePorts) | 1U << 0 | 1U << 3;
    at(kPortA + kPortAlternate) = 3;
    at(kPortA + kPortDigital) = 3;
    at(kPortD + kPortAlternate) = 3U << 2;
    at(kPortD + kPortDigital) = 3U << 2;
    start_uart(kUart0, 115200);
    start_uart(kUart1, 460800);
    at(kInterruptEnable) = kUart0Interrupt | kUart1Interrupt;
  }

 private:
  mutable uint32_t value_ = 0;
  mutable uint32_t parts_ = 0;  // Of the present tick, passed at the last read of the clock.
  mutable Ticks ticks_ = 0;

  void start_uart(uint32_t uart, uint32_t baud) {
    const uint32_t divisor64 = (kHertz * 4 + baud / 2) / baud;
    at(uart + kUartControl) = 0;
    at(uart + kUartBaudWhole) = divisor64 >> 6;
    at(uart + kUartBaud64ths) = divisor64 & 63;
    at(uart + kUartLine) = kLine8Bits | kLineFifos;
    at(uart + kUartMask) = kReceiveInterrupts;
    at(uart + kUartControl) = kControlOn;
  }
};

class ArmSerialPort : public SerialPort {
 protected:
  void start_sending() override {
    at(kUart0 + kUartMask) = kReceiveInterrupts | kTransmitInterrupt;
    at(kInterruptPend) = kUart0Interrupt;  // The UART's own comes when bytes have left.
  }
};

Arm board;
ArmSerialPort serial;
Bench bench(board, serial);

}  // namespace

extern "C" void timer0_handler() {
  at(kTimer0 + kTimerClear) = 1;
  ticked = true;
}

extern "C" void uart0_handler() {
  at(kUart0 + kUartClear) = kReceiveInterrupts | kTransmitInterrupt;
  while ((at(kUart0 + kUartFlags) & kReceiveEmpty) == 0) {
    serial.byte_received(static_cast<uint8_t>(at(kUart0 + kUartData)));
    serial_bytes = serial_bytes + 1;
  }
  while ((at(kUart0 + kUartFlags) & kTransmitFull) == 0) {
    uint8_t byte;
    if (!serial.next_byte(byte)) {
      at(kUart0 + kUartMask) = kReceiveInterrupts;
      return;
    }
    at(kUart0 + kUartData) = byte;
  }
}

extern "C" void uart1_handler() {
  at(kUart1 + kUartClear) = kReceiveInterrupts;
  while ((at(kUart1 + kUartFlags) & kReceiveEmpty) == 0) {
    bench.byte_received(static_cast<uint8_t>(at(kUart1 + kUartData)));
  }
}

int main() {
  board.start_uarts();
  bench.hello();
  for (;;) {
    ticked = false;
    bench.run();
    asm volatile("cpsid i" ::: "memory");  // Later interrupts wake the processor.
    if (!bench.has_record() && !serial.has_news() && !ticked) asm volatile("wfi");
    asm volatile("cpsie i" ::: "memory");
  }
}
