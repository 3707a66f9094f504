// The records on the second UART of a board on the test bench, where the radio chip and the
// application would be: length (of tag and body), tag, body. Numbers are big-endian. The board
// answers each record with kIdle when it has handled it; until then the bench sends no other.
#pragma once

#include <stddef.h>
#include <stdint.h>

namespace rubric {
namespace firmware {

/// Tags of records from the bench to the board.
enum class ToBoard : uint8_t {
  /// id u16, island u16, channels u8, last sequence number u16, keep it u8, members u8,
  /// gone_after u32 (ticks), the time comes from kTime u8.
  kSetup = 1,
  kRadio,      ///< A packet (dispatch byte, AM header, payload) that the radio hears.
  kRadioSent,  ///< link ack u8: the last transmission has ended.
  kBusy,       ///< line u8 (0 radio, 1 serial, 2 application), busy u8.
  kCall,       ///< CallCode, arguments.
  kRestart,    ///< Reset the processor; unanswered but by kHello.
  kTime,       ///< The time u32 (ticks), if it does not come from the board's clock.
};

/// Tags of records from the board to the bench.
enum class FromBoard : uint8_t {
  kHello = 1,  ///< After a reset: sink u8, channels u8, bytes of a node u16.
  kReady,      ///< The clock has started.
  kRadio,      ///< link ack asked for u8, a packet for the radio.
  kEvent,      ///< EventCode, arguments.
  /// Records u8 handled so far, bytes u16 from the serial line, Idle flags u8, next timer u32
  /// (ticks).
  kIdle,
};

/// Flags of kIdle.
enum : uint8_t { kIdleTimerRuns = 1, kIdleSerialSends = 2, kIdleSerialHasNews = 4 };

constexpr size_t kRecordMax = 125;  ///< Tag and body: the longest holds a whole packet.

/// Arguments as in PORTING.md: addresses and channels are two u16, reals u32, data the rest.
enum class CallCode : uint8_t {
  kJoin = 1,
  kSend,
  kInterface,
  kGetInterface,
  kCreateOut,
  kCreateIn,
  kDispose,
  kStart,
  kStop,
  kStartAll,
  kStopAll,
  kWriteOutput,
  kReadInput,
  kSetTimeStep,
  kSetIslandId,
  kGetClock,
};

enum class EventCode : uint8_t {
  kJoined = 1,
  kMoteJoined,
  kReceived,
  kAckReceived,
  kSynData,
  kSendResult,
  kChannelResult,
  kOpResult,
  kInputValue,
  kInterfaceState,
  kClock,
  kMoteLeft,
};

}  // namespace firmware
}  // namespace rubric
