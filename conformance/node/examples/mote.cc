// A mote on an ATmega128 at 7.3728 MHz that sends a reading of its first analog input to its
// island's sink each second. Its radio is a modem on UART 1, which takes and gives packets with
// their length in front; for another chip write another transmit() and take_radio_byte().
//
//     avr-g++ -mmcu=atmega128 -std=c++14 -Os -ffreestanding -fno-exceptions -fno-rtti
//       $(pkg-config --cflags rubric-node) mote.cc -o mote.elf
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>

#include "conformance/node/node.h"

using namespace rubric::node;
using rubric::Bytes;

constexpr uint32_t kHertz = 7372800;
constexpr uint16_t kTicksPerSecond = 1024;
constexpr uint8_t kPacketMax = kAmHeaderBytes + kAmPayloadMax;
constexpr uint16_t kOwnId = 5;
constexpr uint8_t kMockup = 5;  // An APPID.

volatile Ticks ticks;
uint8_t packet[kPacketMax];
volatile uint8_t packet_size;  // 0: none yet.

class Mote : public Driver, public Application {
 public:
  Mote() : node_(*this, *this) {}

  void start() {
    node_.start({Role::kMote, kOwnId, 0, 4, 0, now(), 1});
    join();
  }
  void run() {
    Ticks due;
    node_.run(now(), due);
    if (sent_) {
      sent_ = false;
      node_.sent(Line::kRadio, true);  // The modem confirms nothing.
    }
    if (packet_size != 0) {
      node_.received(Line::kRadio, Bytes(packet, packet_size));
      packet_size = 0;
    }
    if (node_.is_member() && is_reached(next_reading_, now())) report();
  }

  void transmit(Line, Bytes bytes, bool) override {
    put(static_cast<uint8_t>(bytes.size()));
    for (const uint8_t byte : bytes) put(byte);
    sent_ = true;
  }

  void joined(Address, bool success) override {
    next_reading_ = now();
    failed_ = !success;
  }
  bool take_failure() {
    const bool failed = failed_;
    failed_ = false;
    return failed;
  }
  void join() { node_.join(Descriptor()); }
  void mote_joined(Address, const Descriptor&) override {}
  void received(Address, uint8_t, Bytes data) override {
    if (!data.empty()) PORTA = data[0];  // The LEDs.
  }
  void ack_received(uint8_t, uint16_t, bool) override {}
  void syn_data_received(ChannelId, DataStatus) override {}

 private:
  static Ticks now() {
    const uint8_t status = SREG;
    cli();
    const Ticks value = ticks;
    SREG = status;
    return value;
  }
  static void put(uint8_t byte) {
    while ((UCSR1A & _BV(UDRE1)) == 0) {
    }
    UDR1 = byte;
  }
  void report() {
    next_reading_ = now() + kTicksPerSecond;
    ADCSRA |= _BV(ADSC);
    while ((ADCSRA & _BV(ADSC)) != 0) {
    }
    const uint16_t light = ADC;
    const uint8_t data[] = {static_cast<uint8_t>(light >> 8), static_cast<uint8_t>(light)};
    node_.send({kLocalIsland, kSinkId}, kMockup, false, Bytes(data));
  }

  SizedNode<MoteSizes> node_;
  Ticks next_reading_ = 0;
  bool sent_ = false;
  bool failed_ = false;
};

Mote mote;

ISR(TIMER1_COMPA_vect) { ticks = ticks + 1; }

// Takes a byte from the modem. A packet that comes while one waits is lost.
ISR(USART1_RX_vect) {
  static uint8_t awaited;
  static uint8_t filled;
  const uint8_t byte = UDR1;
  if (packet_size != 0) return;
  if (awaited == 0) {
    awaited = byte <= kPacketMax ? byte : uint8_t{0};
    filled = 0;
    return;
  }
  packet[filled++] = byte;
  if (filled < awaited) return;
  packet_size = awaited;
  awaited = 0;
}

extern "C" void __cxa_pure_virtual() {
  for (;;) {
  }
}

int main() {
  DDRA = 7;
  ADMUX = _BV(REFS0);
  ADCSRA = _BV(ADEN) | _BV(ADPS2) | _BV(ADPS1);
  UBRR1L = kHertz / 16 / 115200 - 1;
  UCSR1B = _BV(RXEN1) | _BV(TXEN1) | _BV(RXCIE1);
  OCR1A = kHertz / kTicksPerSecond - 1;
  TIMSK = _BV(OCIE1A);
  TCCR1B = _BV(WGM12) | _BV(CS10);
  sei();
  mote.start();
  for (;;) {
    mote.run();
    if (mote.take_failure()) mote.join();
    sleep_mode();
  }
}
