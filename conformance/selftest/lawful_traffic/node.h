// Motes, sinks and base stations, and what they have in common: a radio, a clock, buffers, synaptic
// channels.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "conformance/selftest/lawful_traffic/air.h"
#include "conformance/selftest/lawful_traffic/endpoint.h"
#include "conformance/selftest/lawful_traffic/plan.h"

namespace rubric::lawful {

struct OutChannel {
  Address dest;
  std::size_t size = 1;
  bool power_save = false;
  bool started = false;
  bool first = true;  ///< No tick yet since it was started.
  std::vector<float> values;
  std::vector<float> sent;
};

class Node : public Device, public Endpoint {
 public:
  Node(World& world, int number, std::uint16_t id, int island_index, const std::string& role);

  /// The operations of Synaptic Channels. A channel is named by its index; one that does not
  /// exist is refused.
  std::size_t create_out(Address dest, std::size_t size, bool power_save);
  void start(std::size_t channel);
  void stop(std::size_t channel);
  void write_value(std::size_t channel, std::size_t pos, float value);

 protected:
  using Endpoint::event;
  World& world() const { return Device::world_; }
  /// Calls after `local_us` of this node's clock, unless it was rebooted.
  void timer(std::int64_t local_us, std::function<void()> call);
  /// Handles an arrival: after this node's delay, in order of arrival; dropped if the buffer of
  /// incoming messages is full and the message is `buffered`.
  void work(bool buffered, std::function<void()> call);
  bool radio_full() const;
  void transmit_net(const NetMessage& message, std::uint16_t am);
  void reboot_clock();
  int clock_ppm() const { return clock_ppm_; }
  virtual bool is_member() const = 0;
  virtual std::int64_t phase_us() const = 0;

 private:
  void start_clock(std::int64_t first_us);
  void tick(int clock);
  void send_channel(OutChannel& channel);

  int clock_ppm_;
  int boots_ = 0;
  std::int64_t last_work_us_ = 0;
  std::size_t in_use_ = 0;
  std::vector<OutChannel> channels_;
  int clock_ = 0;  ///< Changes when the synaptic clock begins anew.
  bool clock_runs_ = false;
};

class SerialLine;

/// The PC of an island; its applications have the address <island, NULL>.
class BaseStation final : public Endpoint {
 public:
  BaseStation(World& world, int number, std::uint16_t island);

  void connect(SerialLine* line) { line_ = line; }
  void serial_heard(std::uint8_t am_type, const Octets& payload);
  void peis_heard(const NetMessage& message);
  void set_island(std::uint16_t island);
  /// Sends its sink bytes as they are, as a tester would.
  void raw(std::uint8_t am_type, const Octets& payload);
  /// Sends a message to its own sink whatever its destination.
  void send_to_sink(const NetMessage& message);

 protected:
  bool route(const NetMessage& message) override;

 private:
  SerialLine* line_ = nullptr;
  std::int64_t last_work_us_ = 0;  ///< Arrivals are handled in order.
};

class Mote final : public Node {
 public:
  Mote(World& world, int number, const MotePlan& plan, std::uint16_t preferred_island);

  void boot();
  void switch_off();
  void heard(const RadioFrame& frame) override;
  bool joined() const { return joined_; }
  bool is_member() const override { return joined_; }

 protected:
  bool route(const NetMessage& message) override;
  void on_app(const NetMessage& message) override;
  std::int64_t phase_us() const override { return (am() - 1) * std::int64_t{30'000}; }

 private:
  void join_island();
  void send_request();
  void start_join_timer();
  void expired();
  void failed();
  void on_reply(const RadioFrame& frame);
  void send_ack_join();
  void ack_join_sent(bool acked);
  void become_joined();
  void send_updates();

  MotePlan plan_;
  std::uint16_t preferred_island_;
  bool joined_ = false;
  bool waiting_ = false;    ///< For a reply.
  bool accepted_ = false;   ///< A reply of this call.
  bool confirmed_ = false;  ///< ack_join, by the link layer.
  int calls_ = 0;
  int requests_ = 0;  ///< Or expiries after acceptance.
  int timer_ = 0;     ///< Changes when the join timer is started or stopped.
  std::uint16_t seq_ = 0;
  int ack_joins_ = 0;
  std::int64_t accepted_us_ = 0;
  std::uint8_t ack_join_dsn_ = 0;
  std::uint16_t reading_ = 0;
};

class SerialLine;

class Sink final : public Node {
 public:
  Sink(World& world, int number, int island_index, std::uint16_t island);

  void connect(SerialLine* line) { line_ = line; }
  void boot();
  void heard(const RadioFrame& frame) override;
  void serial_heard(std::uint8_t am_type, const Octets& payload);
  bool is_member() const override { return true; }
  std::size_t members() const { return members_.size(); }

 protected:
  bool route(const NetMessage& message) override;
  std::int64_t phase_us() const override { return 0; }

 private:
  struct Joining {
    std::uint16_t seq;
    Descriptor descriptor;
  };
  void on_request(const RadioFrame& frame);
  void on_ack_join(const RadioFrame& frame);
  void on_net(const NetMessage& message);
  void on_serial_net(const NetMessage& message);
  void to_host(const NetMessage& message, bool own);
  void by_radio(const NetMessage& message);
  bool first_time(const NetMessage& message);
  std::uint32_t clock_ms() const;

  SerialLine* line_ = nullptr;
  std::map<std::uint16_t, Joining> joining_;
  std::set<std::uint16_t> members_;
  Octets serial_memory_;  ///< Left by the last message.
  std::set<std::pair<std::uint32_t, std::uint16_t>> seen_;
};

}  // namespace rubric::lawful
