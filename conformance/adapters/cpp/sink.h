// A sink: lists the members of its island and joins them to its base station.
#pragma once

#include "conformance/adapters/cpp/node.h"

namespace rubric::cpp_node {

class Sink : public Node {
 public:
  Sink(const Settings& settings, World& world);

 private:
  struct Mote {
    std::uint16_t device = 0;
    std::uint16_t number = 0;  ///< In its last request.
    MoteDesc description;
    bool reported = false;  ///< To the base station.
  };

  std::optional<Address> address() const override { return address_; }
  bool route(const Message& message) override;
  void control(Line line, const Frame& frame) override;
  void message(Line line, const Message& message) override;
  bool is_for_me(Line line, const Frame& frame) const override;
  void may_have_room() override;

  void join_request(const Frame& frame);
  void ack_join(const Frame& frame);
  void configure(const Frame& frame);
  void from_radio(const Message& message);
  void from_serial(const Message& message);
  bool is_member(std::uint16_t device) const;
  bool radiate(const Message& message);
  bool hand_up(const Message& message);

  Address address_;
  std::vector<Mote> members_;
  std::deque<Mote> open_joins_;  ///< Asked, answered, not yet acknowledged; the oldest first.
};

}  // namespace rubric::cpp_node
