// A base station: between its island's sink, other islands, and the applications of a PC.
#pragma once

#include "conformance/adapters/cpp/node.h"

namespace rubric::cpp_node {

class BaseStation : public Node {
 public:
  BaseStation(const Settings& settings, World& world);

  bool set_island(std::uint16_t island) override;

 private:
  std::optional<Address> address() const override { return Address{island_, kNull}; }
  bool route(const Message& message) override;
  void control(Line, const Frame&) override {}
  void message(Line line, const Message& message) override;
  bool is_for_me(Line line, const Frame& frame) const override;

  std::uint16_t island_;
};

}  // namespace rubric::cpp_node
