// Runs a node on the test bench: the bench's records are its radio chip and its application.
#pragma once

#include "conformance/adapters/firmware/bench/records.h"
#include "conformance/node/node.h"
#include "conformance/node/serial_port.h"
#include "conformance/node/silence.h"

#ifndef RUBRIC_FIRMWARE_SINK
#define RUBRIC_FIRMWARE_SINK 0  // 1: firmware of a sink.
#endif
#ifndef RUBRIC_FIRMWARE_CHANNELS
#define RUBRIC_FIRMWARE_CHANNELS 4  // Synaptic channels of each direction.
#endif

namespace rubric {
namespace firmware {

using namespace node;

constexpr bool kIsSink = RUBRIC_FIRMWARE_SINK != 0;
template <bool kSink>
struct RoleSizes : MoteSizes {};
template <>
struct RoleSizes<true> : SinkSizes {};
struct FirmwareSizes : RoleSizes<kIsSink> {
  static constexpr uint8_t kChannels = RUBRIC_FIRMWARE_CHANNELS;
};
using FirmwareNode = SizedNode<FirmwareSizes>;
// With the paper's number of channels it takes no more memory than the paper's.
static_assert(FirmwareSizes::kChannels > 4 || sizeof(FirmwareNode) <= paper_bytes(12, 8),
              "a node takes more memory than the paper's");

/// The parts that differ from board to board.
class Board {
 public:
  /// Returns the time, 1024 to the second, since start_clock().
  virtual Ticks now() const = 0;
  /// Sends a byte to the bench; waits until there is room for it.
  virtual void put(uint8_t byte) = 0;
  virtual void start_clock() = 0;
  /// Returns how many bytes the serial line has brought since the reset.
  virtual uint16_t serial_bytes() const = 0;
  /// Returns memory that survives a reset, but not a loss of power.
  virtual uint16_t& kept_seq_num() = 0;
  virtual void restart() = 0;

 protected:
  ~Board() = default;
};

class Bench : public Driver, public Application {
 public:
  Bench(Board& board, SerialPort& serial) : board_(board), serial_(serial), node_(*this, *this) {}

  /// Greets the bench after a reset.
  void hello();
  /// Takes a byte of a record; to be called in the link's interrupt.
  void byte_received(uint8_t byte);
  /// Returns whether a record waits for run().
  bool has_record() const { return record_size_ != 0; }
  /// Handles the record that has come, and does the node's own work; to be called after each
  /// interrupt.
  void run();

  void transmit(Line line, Bytes packet, bool link_ack) override;

  void joined(Address address, bool success) override;
  void mote_joined(Address address, const Descriptor& descriptor) override;
  void mote_left(Address address) override;
  void received(Address src, uint8_t app_id, Bytes data) override;
  void ack_received(uint8_t app_id, uint16_t seq_num, bool success) override;
  void syn_data_received(ChannelId channel, DataStatus status) override;

 private:
  void handle(Bytes record);
  void put16(uint16_t value);
  void put32(uint32_t value);
  void put_address(Address address);
  void begin(FromBoard tag, size_t body_bytes);
  void begin(EventCode event, size_t argument_bytes);
  void result(bool success);
  void result(ChannelResult result);
  Ticks now() const { return takes_time_ ? time_ : board_.now(); }
  void setup(const uint8_t* body);
  void hear(Bytes packet);
  void set_busy(uint8_t line, bool busy);
  void call(CallCode code, Bytes arguments);
  void call_on_lines(CallCode code, Bytes arguments);
  void call_on_channel(CallCode code, const uint8_t* arguments);
  void report_idle(bool timer_runs, Ticks due);

  Board& board_;
  SerialPort& serial_;
  FirmwareNode node_;
  Silence<kIsSink ? SinkSizes::kMembers : 1> silence_;
  bool takes_time_ = false;  ///< From the bench.
  Ticks time_ = 0;
  bool started_ = false;
  bool reported_ = true;
  uint8_t record_[kRecordMax];
  volatile uint8_t record_size_ = 0;  ///< 0: none yet.
  uint8_t record_awaited_ = 0;        ///< Bytes of the one that is coming.
  uint8_t record_filled_ = 0;
  uint8_t records_ = 0;
  uint8_t told_flags_ = 0;
  Ticks told_due_ = 0;
};

}  // namespace firmware
}  // namespace rubric
