// A mote: joins, sends, receives.
#pragma once

#include <cstdint>

#include "conformance/selftest/lawful_traffic/node.h"
#include "conformance/selftest/lawful_traffic/plan.h"

namespace rubric::lawful {

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

}  // namespace rubric::lawful
