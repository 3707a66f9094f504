// The test bench around a board: plays its radio chip, the other end of its serial line and its
// application, and reports outputs in the words of rct/1.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "codec/runtime/hdlc.h"
#include "conformance/adapters/firmware/bench/records.h"
#include "conformance/adapters/firmware/host/board.h"
#include "conformance/adapters/firmware/host/words.h"

namespace rubric::firmware {

using Tick = std::uint64_t;

/// The firmware's description of itself.
struct Firmware {
  bool is_sink = false;
  unsigned channels = 0;  ///< For each direction.
  unsigned node_bytes = 0;
};

struct NodeSetup {
  std::uint16_t id = 0;
  std::uint16_t island = 0;
  std::uint8_t channels = 4;
  std::uint16_t last_seq_num = 0;
  std::uint8_t members = 0xFF;   ///< Of a sink, if there is room.
  std::uint32_t gone_after = 0;  ///< Ticks of silence after which a mote has left; 0: never.
};

class Bridge final : private Listener {
 public:
  explicit Bridge(SimulatedBoard& board) : board_(board) {}

  /// Switches the board on and waits for its greeting. Throws BoardBroken if there is none.
  Firmware greet();
  /// Starts the node; this is tick 0.
  void start(const NodeSetup& setup);

  /// Runs up to the beginning of tick `now`; lines that this brings have that time.
  void advance(Tick now);

  // Inputs at the present tick.
  void hear_radio(Bytes packet);
  void hear_serial(Bytes packet);
  void call(Bytes call_record);
  void link_ack(bool acked);
  void busy(std::uint8_t line, bool busy);
  void power_off();
  void reboot();

  /// Runs up to and including tick `end`, or to the first that brings a line. Returns the tick.
  Tick run(Tick end);
  /// Returns the time before which no line comes unless something happens; nothing: never.
  std::optional<Tick> next() const;
  /// Returns the lines `tx ...` and `up ...` since the last call.
  std::vector<std::string> take_lines();
  Tick tick() const;
  /// Also passes on the bytes of the serial line.
  void set_serial_tap(std::function<void(std::uint8_t)> tap) { serial_tap_ = std::move(tap); }

 private:
  struct Chip {  // The radio.
    bool channel_busy = false;
    bool has_frame = false;  ///< From kRadio until kRadioSent.
    bool on_air = false;     ///< Else it waits for the channel.
    bool wants_ack = false;
    ByteVector packet;
    Instant end = 0;  ///< End of the transmission, unless linkack ends it.
  };
  struct Reported {  // From the last kIdle.
    std::uint8_t records = 0;
    std::uint16_t serial_bytes = 0;
    std::uint8_t flags = 0;
    std::uint32_t due = 0;
  };

  void link_byte(std::uint8_t byte) override;
  void serial_byte(std::uint8_t byte) override;
  void handle(Bytes record);
  bool is_greeting() const;
  void setup(bool keep_seq_num);
  void record(ToBoard tag, Bytes body);
  void send_next();
  void run_until(Instant end);
  void turn_clock(Instant end);
  void settle();
  void tell_time();
  void emit(std::string line);
  void transmit();
  void end_transmission(bool acked);
  bool has_all_bytes() const { return reported_.serial_bytes == sent_serial_bytes_; }
  bool serial_is_quiet() const;
  Tick tick_of(Instant instant) const;
  Instant last_instant_of(Tick tick) const;

  SimulatedBoard& board_;
  NodeSetup setup_;
  Firmware firmware_;
  bool greeted_ = false;
  bool ready_ = false;
  bool off_ = false;
  Instant zero_ = 0;        ///< Time of tick 0.
  Instant clock_zero_ = 0;  ///< Start of the node's own clock.
  Tick last_tick_ = 0;      ///< Lines are not earlier.
  ByteVector incoming_;     ///< A record that is not complete.
  std::deque<ByteVector> queue_;
  bool in_flight_ = false;  ///< A record that is not answered yet.
  std::uint8_t sent_records_ = 0;
  std::uint16_t sent_serial_bytes_ = 0;
  std::uint8_t serial_seq_ = 14;  ///< TinyOS's host begins so.
  Instant fed_serial_ = 0;        ///< Time of the last packet for the line.
  Reported reported_;
  Chip chip_;
  bool serial_busy_ = false;
  std::deque<ByteVector> held_;  ///< Serial packets that ended after the line was taken.
  std::uint8_t content_[300] = {};
  HdlcDeframer deframer_{content_};
  std::function<void(std::uint8_t)> serial_tap_;
  std::vector<std::string> lines_;
};

}  // namespace rubric::firmware
