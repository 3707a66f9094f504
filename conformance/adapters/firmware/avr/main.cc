// A node on an ATmega128 at 7.3728 MHz, as micaz motes have it: UART 0 is the serial line at 115200
// baud, UART 1 the test bench's link at 921600 baud, timer 1 the clock.
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>
#include <avr/wdt.h>

#include "conformance/adapters/firmware/bench/bench.h"

namespace {

using namespace rubric::firmware;

constexpr uint32_t kHertz = 7372800;
constexpr uint16_t kTicksPerSecond = 1024;
static_assert(kHertz % kTicksPerSecond == 0, "a tick is a whole number of cycles");
constexpr uint8_t kSerialDivisor = kHertz / 16 / 115200 - 1;
constexpr uint8_t kLinkDivisor = kHertz / 8 / 921600 - 1;  // At double speed.

// Not cleared when the processor starts.
uint16_t kept_seq_num __attribute__((section(".noinit")));

volatile Ticks ticks;
volatile bool ticked;
volatile uint16_t serial_bytes;

class Avr : public Board {
 public:
  Ticks now() const override { return whole(ticks); }
  uint16_t serial_bytes() const override { return whole(::serial_bytes); }
  void put(uint8_t byte) override {
    while ((UCSR1A & _BV(UDRE1)) == 0) {
    }
    UDR1 = byte;
  }
  void start_clock() override {
    TCCR1A = 0;
    OCR1A = kHertz / kTicksPerSecond - 1;
    TCNT1 = 0;
    TIMSK = _BV(OCIE1A);
    TCCR1B = _BV(WGM12) | _BV(CS10);
  }
  uint16_t& kept_seq_num() override { return ::kept_seq_num; }
  void restart() override {
    wdt_enable(WDTO_15MS);
    for (;;) {
    }
  }
  void start_uarts() {
    UCSR0C = _BV(UCSZ01) | _BV(UCSZ00);
    UBRR0H = 0;
    UBRR0L = kSerialDivisor;
    UCSR0B = _BV(RXEN0) | _BV(TXEN0) | _BV(RXCIE0);
    UCSR1A = _BV(U2X1);
    UCSR1C = _BV(UCSZ11) | _BV(UCSZ10);
    UBRR1H = 0;
    UBRR1L = kLinkDivisor;
    UCSR1B = _BV(RXEN1) | _BV(TXEN1) | _BV(RXCIE1);
  }

 private:
  // Reads what an interrupt may change between the reads of its bytes.
  template <class Value>
  static Value whole(const volatile Value& shared) {
    const uint8_t status = SREG;
    cli();
    const Value value = shared;
    SREG = status;
    return value;
  }
};

class AvrSerialPort : public SerialPort {
 protected:
  void start_sending() override { UCSR0B |= _BV(UDRIE0); }
};

Avr board;
AvrSerialPort serial;
Bench bench(board, serial);

}  // namespace

ISR(TIMER1_COMPA_vect) {
  ticks = ticks + 1;
  ticked = true;
}

ISR(USART0_RX_vect) {
  serial.byte_received(UDR0);
  serial_bytes = serial_bytes + 1;
}

ISR(USART0_UDRE_vect) {
  uint8_t byte;
  if (serial.next_byte(byte)) {
    UDR0 = byte;
  } else {
    UCSR0B &= static_cast<uint8_t>(~_BV(UDRIE0));
  }
}

ISR(USART1_RX_vect) { bench.byte_received(UDR1); }

extern "C" void __cxa_pure_virtual() {
  for (;;) {
  }
}

int main() {
  wdt_disable();
  board.start_uarts();
  set_sleep_mode(SLEEP_MODE_IDLE);
  sei();
  bench.hello();
  for (;;) {
    ticked = false;
    bench.run();
    cli();  // Later interrupts wake the processor.
    if (!bench.has_record() && !serial.has_news() && !ticked) {
      sleep_enable();
      sei();
      sleep_cpu();
      sleep_disable();
    }
    sei();
  }
}
