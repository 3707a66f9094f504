// Your node goes here, or the bridge to it. Write whatever is marked TODO.
//
// It has no clock of its own: adapter.cc gives it the time (ticks of 1/1024 s) and its inputs, and
// calls run_due() when due() says so.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

using Ticks = std::uint64_t;
using Packet = std::vector<std::uint8_t>;  // 00, destination, source, length, group, type, payload.
using Arguments = std::map<std::string, std::string>;

/// Outputs of the node to its world.
class World {
 public:
  virtual ~World() = default;
  /// Sends a frame by "radio", "serial" or "peis". `link_ack` asks for the radio's own
  /// acknowledgement: MyNode::confirmed follows.
  virtual void tx(const std::string& line, const Packet& packet, bool link_ack = false) = 0;
  /// Sends news to the application, as "joined(11:5 success)".
  virtual void up(const std::string& news) = 0;
};

class MyNode {
 public:
  /// Makes a node that has just started. `settings` has id, island, channels and profile; role is
  /// "mote", "sink" or "base_station".
  MyNode(World& world, const std::string& role, const Arguments& settings,
         std::uint16_t next_number, Ticks now)
      : world_(world), next_number_(next_number), now_(now), started_at_(now) {
    (void)role;      // TODO: which node you are,
    (void)settings;  // and with which id.
  }

  void set_time(Ticks now) { now_ = now; }
  /// Returns when something happens by itself; nothing: never.
  std::optional<Ticks> due() const { return std::nullopt; }  // TODO: the soonest of your timers.
  /// Does what is due now.
  void run_due() {}  // TODO: what your timers do.

  /// Handles a frame, whoever it is for.
  void heard(const std::string& line, const Packet& packet) {
    (void)line;  // TODO: hand it to your receiver.
    (void)packet;
  }
  /// Notes that another station has the line, or left it. "app": the application takes no messages.
  void set_busy(const std::string& line, bool busy) {
    (void)line;  // TODO: what is to be sent, or handed up, waits meanwhile.
    (void)busy;
  }
  /// Handles the end of the transmission that asked for a link ack.
  void confirmed(bool acked) { (void)acked; }  // TODO: if you ask for any.

  /// Handles a call of the application. Returns false if it is missing; the cases that need it are
  /// skipped.
  bool call(const std::string& name, const Arguments& arguments) {
    (void)arguments;  // TODO: "join" has arguments["type"], ["transducers"], ["actuators"], ...
    if (name == "get_clock") {
      world_.up("clock(" + std::to_string((now_ - started_at_) * 1000 / 1024) + ")");
      return true;
    }
    return false;
  }

  /// Returns the one number that outlives a loss of power.
  std::uint16_t next_number() const { return next_number_; }

 private:
  World& world_;
  std::uint16_t next_number_;
  Ticks now_;
  Ticks started_at_;
};
