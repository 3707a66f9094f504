// Runs a node on the test bench: the bench's records are its radio chip and its application.
#pragma once

#include "conformance/adapters/firmware/bench/records.h"
#include "conformance/adapters/firmware/node/node.h"
#include "conformance/adapters/firmware/node/serial_port.h"

namespace rubric {
namespace firmware {

/// The parts that differ from board to board.
class Board : public Clock {
 public:
  /// Sends a byte to the bench; waits until there is room for it.
  virtual void put(uint8_t byte) = 0;
  virtual void start_clock() = 0;
  /// Returns memory that survives a reset, but not a loss of power.
  virtual uint16_t& kept_seq_num() = 0;
  virtual void restart() = 0;

 protected:
  ~Board() = default;
};

class Bench : public Radio, public Application {
 public:
  Bench(Board& board, SerialPort& serial)
      : board_(board), serial_(serial), node_(*this, serial, board, *this) {}

  /// Greets the bench after a reset.
  void hello();
  /// Handles a record, from its tag on.
  void handle(Bytes record);
  /// Runs the node's own work; to be called after each interrupt.
  void run();

  void send(uint16_t dest, uint8_t am_type, Bytes payload, bool link_ack) override;
  void set_on(bool) override {}  // The bench goes on sending; the node does not listen.

  void joined(Address address, bool success) override;
  void mote_joined(Address address, const Descriptor& descriptor) override;
  void received(Address src, uint8_t app_id, Bytes data) override;
  void ack_received(uint8_t app_id, uint16_t seq_num, bool success) override;
  void syn_data_received(ChannelId channel, DataStatus status) override;

 private:
  void put16(uint16_t value);
  void put32(uint32_t value);
  void put_address(Address address);
  void begin(FromBoard tag, size_t body_bytes);
  void begin(EventCode event, size_t argument_bytes);
  void result(bool success);
  void result(ChannelResult result);
  void setup(const uint8_t* body);
  void hear(Bytes packet);
  void set_busy(uint8_t line, bool busy);
  void call(CallCode code, Bytes arguments);
  void call_on_lines(CallCode code, Bytes arguments);
  void call_on_channel(CallCode code, const uint8_t* arguments);
  void report_idle();

  Board& board_;
  SerialPort& serial_;
  Node node_;
  bool started_ = false;
  bool reported_ = true;
  uint8_t records_ = 0;
  uint8_t packets_ = 0;
  uint8_t told_flags_ = 0;
  Ticks told_due_ = 0;
};

}  // namespace firmware
}  // namespace rubric
