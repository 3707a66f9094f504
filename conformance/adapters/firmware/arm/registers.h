// The registers of an LM3S6965 that the port uses. (Stellaris LM3S6965 data sheet)
#pragma once

#include <stdint.h>

namespace lm3s {

inline volatile uint32_t& at(uint32_t address) {
  return *reinterpret_cast<volatile uint32_t*>(address);
}

// PL011 UARTs.
constexpr uint32_t kUart0 = 0x4000C000;
constexpr uint32_t kUart1 = 0x4000D000;
constexpr uint32_t kUartData = 0x00;
constexpr uint32_t kUartFlags = 0x18;
constexpr uint32_t kUartBaudWhole = 0x24;
constexpr uint32_t kUartBaud64ths = 0x28;
constexpr uint32_t kUartLine = 0x2C;
constexpr uint32_t kUartControl = 0x30;
constexpr uint32_t kUartMask = 0x38;
constexpr uint32_t kUartClear = 0x44;
constexpr uint32_t kReceiveEmpty = 1U << 4;  // Flag.
constexpr uint32_t kTransmitFull = 1U << 5;
constexpr uint32_t kLine8Bits = 3U << 5;
constexpr uint32_t kLineFifos = 1U << 4;
constexpr uint32_t kControlOn = 1U << 9 | 1U << 8 | 1U;     // Receiver, transmitter, UART.
constexpr uint32_t kReceiveInterrupts = 1U << 6 | 1U << 4;  // Timeout, FIFO level.
constexpr uint32_t kTransmitInterrupt = 1U << 5;

// Clock gates of peripherals.
constexpr uint32_t kGateUartsAndTimers = 0x400FE104;
constexpr uint32_t kGatePorts = 0x400FE108;
constexpr uint32_t kPortA = 0x40004000;  // Its pins 0 and 1 are UART 0,
constexpr uint32_t kPortD = 0x40007000;  // pins 2 and 3 of this are UART 1.
constexpr uint32_t kPortAlternate = 0x420;
constexpr uint32_t kPortDigital = 0x51C;

// General-purpose timer 0, whose two halves count as one.
constexpr uint32_t kTimer0 = 0x40030000;
constexpr uint32_t kTimerMode = 0x04;
constexpr uint32_t kTimerControl = 0x0C;
constexpr uint32_t kTimerMask = 0x18;
constexpr uint32_t kTimerClear = 0x24;
constexpr uint32_t kTimerReload = 0x28;
constexpr uint32_t kTimerPeriodic = 2;
constexpr uint32_t kTimer0Gate = 1U << 16;
constexpr uint32_t kTimer0Interrupt = 1U << 19;

// The processor's own.
constexpr uint32_t kSysTickControl = 0xE000E010;
constexpr uint32_t kSysTickReload = 0xE000E014;
constexpr uint32_t kSysTickValue = 0xE000E018;
constexpr uint32_t kSysTickOn = 5;  // Processor clock, no interrupt, enabled.
constexpr uint32_t kSysTickMax = 0xFFFFFF;
constexpr uint32_t kInterruptEnable = 0xE000E100;
constexpr uint32_t kInterruptPend = 0xE000E200;
constexpr uint32_t kResetControl = 0xE000ED0C;
constexpr uint32_t kResetRequest = 0x05FA0004;
constexpr uint32_t kUart0Interrupt = 1U << 5;
constexpr uint32_t kUart1Interrupt = 1U << 6;

}  // namespace lm3s
