// A sink: lists motes, delivers, forwards between radio and serial line.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <utility>

#include "conformance/selftest/lawful_traffic/node.h"

namespace rubric::lawful {

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
