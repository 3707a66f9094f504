// The common part of motes and sinks: a radio, a clock, buffers, synaptic channels.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "conformance/selftest/lawful_traffic/air.h"
#include "conformance/selftest/lawful_traffic/endpoint.h"

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

}  // namespace rubric::lawful
