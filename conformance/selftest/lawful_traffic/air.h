// The radio channel and the devices on it.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>

#include "conformance/selftest/lawful_traffic/message.h"

namespace rubric::lawful {

class World;

inline constexpr std::uint16_t kPan = 0x0022;

struct RadioFrame {
  std::uint16_t src = 0;  ///< AM addresses.
  std::uint16_t dst = 0;
  std::uint8_t type = 0;  ///< AM type.
  std::uint8_t dsn = 0;
  bool ack_request = false;
  Octets payload;
};

/// A radio with its queue and its channel access.
class Device {
 public:
  /// `island_index` -1: in range of everybody.
  Device(World& world, int number, std::uint16_t am, int island_index);
  virtual ~Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  int number() const { return number_; }
  std::uint16_t am() const { return am_; }
  int island_index() const { return island_index_; }
  bool powered() const { return powered_; }
  std::size_t queued() const { return queue_.size(); }

  /// Called at the end of a frame that reached this radio.
  virtual void heard(const RadioFrame& frame) = 0;

 protected:
  using Done = std::function<void(bool acked)>;

  /// Queues a frame; calls `done` when it is sent, with whether its link ack came. With `keep_dsn`
  /// it takes the frame's dsn instead of the next one.
  void transmit(RadioFrame frame, Done done = nullptr, bool keep_dsn = false);
  void power(bool on);
  std::uint8_t last_dsn() const { return static_cast<std::uint8_t>(next_dsn_ - 1); }

  World& world_;

 private:
  struct Waiting {
    RadioFrame frame;
    Done done;
    bool keep_dsn;
  };
  void pump();
  void try_send();
  void sent(bool acked);

  int number_;
  std::uint16_t am_;
  int island_index_;
  bool powered_ = false;
  bool sending_ = false;
  int power_cycle_ = 0;
  std::uint8_t next_dsn_ = 0;
  std::deque<Waiting> queue_;
};

/// The one channel. Channel access is perfect: no two frames at one time.
class Air {
 public:
  explicit Air(World& world) : world_(world) {}

  std::int64_t busy_until_us() const { return busy_until_us_; }
  /// Puts `frame` on the air now and calls `done` when it is over.
  void send(Device& from, const RadioFrame& frame, std::function<void(bool acked)> done);

 private:
  bool reaches(const Device& from, const RadioFrame& frame, const Device& to);

  World& world_;
  std::int64_t busy_until_us_ = 0;
};

/// Returns the frame from frame control field to FCS. Sources: TEP 125; IEEE 802.15.4-2006, section
/// 7.2.1.
Octets radio_record(const RadioFrame& frame);
Octets link_ack_record(std::uint8_t dsn);
/// Returns the time on the air, preamble included.
std::int64_t airtime_us(std::size_t record_bytes);

}  // namespace rubric::lawful
