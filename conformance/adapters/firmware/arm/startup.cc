// Runs before main on a Cortex-M3.
#include <stdint.h>
#include <string.h>

extern "C" {
extern uint32_t stack_end, data_begin, data_end, data_source, bss_begin, bss_end;
using Initializer = void (*)();
extern Initializer init_array_begin[], init_array_end[];

int main();
void timer0_handler();
void uart0_handler();
void uart1_handler();

void reset_handler() {
  const auto bytes = [](const uint32_t* begin, const uint32_t* end) {
    return static_cast<size_t>(reinterpret_cast<uintptr_t>(end) -
                               reinterpret_cast<uintptr_t>(begin));
  };
  memcpy(&data_begin, &data_source, bytes(&data_begin, &data_end));
  memset(&bss_begin, 0, bytes(&bss_begin, &bss_end));
  for (Initializer* one = init_array_begin; one != init_array_end; ++one) (*one)();
  main();
}

// Halts on a fault: the bench notices the silence.
void halt() {
  for (;;) {
  }
}

void __cxa_pure_virtual() { halt(); }
}

namespace {

using Handler = void (*)();
struct Vectors {
  const void* stack;
  Handler exceptions[15];
  Handler interrupts[20];
};

__attribute__((section(".vectors"), used)) const Vectors vectors = {
    &stack_end,
    {reset_handler, halt, halt, halt, halt, halt, nullptr, nullptr, nullptr, nullptr, halt, halt,
     nullptr, halt, halt},
    {halt, halt, halt, halt, halt, uart0_handler, uart1_handler, halt, halt, halt,
     halt, halt, halt, halt, halt, halt,          halt,          halt, halt, timer0_handler}};

}  // namespace
