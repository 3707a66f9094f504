// A mote: joins an island and is a member of it.
#pragma once

#include "conformance/adapters/cpp/node.h"

namespace rubric::cpp_node {

class Mote : public Node {
 public:
  Mote(const Settings& settings, World& world);

  std::optional<Ticks> due() const override;
  void run_due() override;
  void confirmed(bool acked) override;
  void join(const MoteDesc& description) override;
  std::uint32_t clock_ms() const override;

 private:
  std::optional<Address> address() const override { return address_; }
  bool route(const Message& message) override;
  void control(Line line, const Frame& frame) override;
  void message(Line line, const Message& message) override;
  bool is_for_me(Line line, const Frame& frame) const override;
  void left(Line line, const Frame& frame) override;

  void request();
  void send_ack_join();

  std::uint16_t device_;
  std::optional<Address> address_;  ///< As a member.

  // The joinIsland call under way.
  int requests_left_ = 0;
  std::optional<Ticks> timer_;  ///< While there is one.
  bool asked_ = false;          ///< A request has left.
  std::uint16_t number_ = 0;
  MoteDesc description_;

  // The membership.
  std::uint16_t sink_ = kSinkDevice;
  int ack_joins_left_ = 0;
  Ticks accepted_at_ = 0;
  std::uint32_t clock_at_acceptance_ms_ = 0;
};

}  // namespace rubric::cpp_node
