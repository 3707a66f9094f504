// Several protocols over the same frames as one, for a capture of motes that speak more than one.
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "codec/reflect/schema.h"

namespace rubric::reflect {

/// A protocol and the routes to its messages.
struct ProtocolPart {
  const Protocol* protocol;
  const RouteTable* routes;
};

/// Takes each key of a frame to the message of the first part that has one for it. A name means
/// that of the first part, too.
class CombinedProtocol {
 public:
  /// What the parts point to is kept. Throws std::invalid_argument where two of them have the key
  /// or the messages of a kind of frame in different places.
  explicit CombinedProtocol(const std::vector<ProtocolPart>& parts);
  CombinedProtocol(const CombinedProtocol&) = delete;
  CombinedProtocol& operator=(const CombinedProtocol&) = delete;

  const Protocol& protocol() const { return protocol_; }
  const RouteTable& routes() const { return route_table_; }

 private:
  void add_carriers(const Protocol& part);
  void add_cases(Carrier& carrier, const Carrier& other, const Protocol& part);
  bool leads_to_its_message(const Route& route, const Protocol& part) const;

  std::string id_;  // Those of the parts, with commas.
  std::string title_;
  std::vector<Carrier> carriers_;
  std::deque<std::vector<SwitchCase>> cases_;  // Of carriers that several parts have.
  std::deque<Switch> choices_;
  std::deque<std::vector<Field>> fields_;
  std::deque<Type> carrier_types_;
  std::vector<const Type*> types_;
  std::vector<const EnumTable*> enums_;
  std::vector<const MaskTable*> masks_;
  std::vector<Route> routes_;
  Protocol protocol_{};
  RouteTable route_table_{};
};

}  // namespace rubric::reflect
