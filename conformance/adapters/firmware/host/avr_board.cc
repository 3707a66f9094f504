#include "conformance/adapters/firmware/host/avr_board.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>

extern "C" {
#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_cycle_timers.h>
#include <simavr/sim_elf.h>
}

#if defined(__SANITIZE_ADDRESS__)
// Suppresses leaks of simavr.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:avr_init_irq\nleak:avr_alloc_irq\nleak:avr_irq_register_notify\n"
         "leak:elf_read_firmware\n";
}
#endif

namespace rubric::firmware {
namespace {

constexpr Instant kLinkBaud = 921'600;
// The bench pauses after each byte as long as the byte took: the interrupt needs more time.
constexpr Instant kLinkSlowness = 2;
constexpr Instant kSerialBaud = 115'200;
constexpr Instant kBitsPerByte = 10;
// The line's value for the time of a byte if there is none.
constexpr std::uint16_t kSilence = 0x100;
// So many bytes' time lets simavr's UART catch up with the line: it passes a byte on no sooner than
// a byte's time after the last was taken.
constexpr std::size_t kSilenceBehindFrame = 48;
constexpr std::uint8_t kUntouched = 0xA5;  // Memory content at power-on.

void log_to_stderr(avr_t*, const int level, const char* format, std::va_list arguments) {
  if (level > LOG_ERROR) return;
  std::vfprintf(stderr, format, arguments);
}

}  // namespace

// Callbacks of simavr.
struct AvrBoard::Callbacks {
  static void output(avr_irq_t*, std::uint32_t value, void* parameter) {
    auto& uart = *static_cast<Uart*>(parameter);
    Listener* const listener = uart.board->listener_;
    if (listener == nullptr) return;
    const auto byte = static_cast<std::uint8_t>(value);
    if (uart.is_link) {
      listener->link_byte(byte);
    } else {
      listener->serial_byte(byte);
    }
  }
  // Feeds a byte at a time, as the line carries them.
  static avr_cycle_count_t feed(avr_t*, avr_cycle_count_t when, void* parameter) {
    auto& uart = *static_cast<Uart*>(parameter);
    uart.feeding = !uart.waiting.empty();
    if (!uart.feeding) return 0;
    const std::uint16_t byte = uart.waiting.front();
    uart.waiting.pop_front();
    if (byte != kSilence) avr_raise_irq(uart.input, byte);
    return when + uart.instants_per_byte;
  }
  static avr_cycle_count_t end(avr_t*, avr_cycle_count_t, void* parameter) {
    static_cast<AvrBoard*>(parameter)->stopped_ = true;
    return 0;
  }
  // Overrides simavr's sleep in real time.
  static void sleep(avr_t*, avr_cycle_count_t) {}
};

AvrBoard::AvrBoard(std::string elf_file) : elf_file_(std::move(elf_file)) {
  avr_global_logger_set(log_to_stderr);
  link_.board = serial_.board = this;
  link_.is_link = true;
  link_.instants_per_byte = kLinkSlowness * kInstantsPerSecond * kBitsPerByte / kLinkBaud;
  serial_.instants_per_byte = kInstantsPerSecond * kBitsPerByte / kSerialBaud;
}

AvrBoard::~AvrBoard() {
  if (avr_ == nullptr) return;
  avr_terminate(avr_);
  std::free(avr_);
}

void AvrBoard::connect(Uart& uart, char name) {
  const auto set_flags = static_cast<std::uint32_t>(AVR_IOCTL_UART_SET_FLAGS(name));
  const auto get_irq = static_cast<std::uint32_t>(AVR_IOCTL_UART_GETIRQ(name));
  std::uint32_t flags = 0;  // It would print what is sent, and sleep where firmware waits.
  avr_ioctl(avr_, set_flags, &flags);
  uart.input = avr_io_getirq(avr_, get_irq, UART_IRQ_INPUT);
  avr_irq_t* const output = avr_io_getirq(avr_, get_irq, UART_IRQ_OUTPUT);
  avr_irq_register_notify(output, Callbacks::output, &uart);
  uart.waiting.clear();
  uart.feeding = false;
}

void AvrBoard::load() {
  if (std::ifstream(elf_file_).get() != 0x7F) {  // simavr loads what is not there without a word.
    throw BoardBroken(fmt::format("{} cannot be read, or is not an ELF file", elf_file_));
  }
  elf_firmware_t firmware;
  std::memset(&firmware, 0, sizeof(firmware));
  if (elf_read_firmware(elf_file_.c_str(), &firmware) != 0) {
    throw BoardBroken(fmt::format("cannot load {}", elf_file_));
  }
  std::strncpy(firmware.mmcu, "atmega128", sizeof(firmware.mmcu) - 1);
  firmware.frequency = static_cast<std::uint32_t>(kInstantsPerSecond);
  avr_ = avr_make_mcu_by_name(firmware.mmcu);
  if (avr_ == nullptr) throw BoardBroken("simavr has no atmega128");
  avr_init(avr_);
  avr_load_firmware(avr_, &firmware);
  avr_->sleep = Callbacks::sleep;
  avr_->log = LOG_ERROR;
  std::free(firmware.flash);
}

// Uses one processor for all: simavr leaks memory with each.
void AvrBoard::power_on() {
  if (avr_ == nullptr) {
    load();
  } else {
    avr_reset(avr_);
  }
  std::fill(avr_->data + avr_->ioend + 1, avr_->data + avr_->ramend + 1, kUntouched);
  connect(link_, '1');
  connect(serial_, '0');
}

void AvrBoard::restart() {
  avr_reset(avr_);
  connect(link_, '1');
  connect(serial_, '0');
}

std::size_t AvrBoard::untouched_ram_bytes() const {
  std::size_t longest = 0;
  std::size_t run = 0;
  for (std::size_t i = avr_->ioend + std::size_t{1}; i <= avr_->ramend; ++i) {
    run = avr_->data[i] == kUntouched ? run + 1 : 0;
    longest = std::max(longest, run);
  }
  return longest;
}

Instant AvrBoard::now() const { return avr_->cycle; }

void AvrBoard::wait(Instant end) { avr_->cycle = std::max<Instant>(avr_->cycle, end); }

void AvrBoard::put(Uart& uart, Bytes bytes) {
  uart.waiting.insert(uart.waiting.end(), bytes.begin(), bytes.end());
  if (uart.feeding) return;
  uart.feeding = true;
  avr_cycle_timer_register(avr_, 1, Callbacks::feed, &uart);
}

void AvrBoard::put_link(Bytes bytes) { put(link_, bytes); }
void AvrBoard::put_serial(Bytes bytes) {
  put(serial_, bytes);
  serial_.waiting.insert(serial_.waiting.end(), kSilenceBehindFrame, kSilence);
}

void AvrBoard::run(Instant end, Listener& listener) {
  if (end <= avr_->cycle) return;
  listener_ = &listener;
  stopped_ = false;
  avr_cycle_timer_register(avr_, end - avr_->cycle, Callbacks::end, this);
  while (!stopped_) {
    const int state = avr_run(avr_);
    if (state == cpu_Done || state == cpu_Crashed) throw BoardBroken("the processor has stopped");
  }
  avr_cycle_timer_cancel(avr_, Callbacks::end, this);
  listener_ = nullptr;
}

}  // namespace rubric::firmware
