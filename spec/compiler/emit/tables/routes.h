// Routes of frames to messages, derived from switches and conditions. See codec/reflect/schema.h.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "spec/compiler/model.h"

namespace rubricc {

struct RouteNumber {
  std::int64_t offset = 0;
  int width_bytes = 1;
  bool little_endian = false;
  std::int64_t value = 0;  // The required value; for a length, where the counted bytes begin.
};
struct Route {
  std::string carrier;
  const Type* type = nullptr;
  std::int64_t offset = 0;
  std::uint32_t room = 0;
  std::vector<RouteNumber> choices;
  std::vector<RouteNumber> lengths;
};

/// Returns each message of each carrier, once for every key and condition that leads to it. Leaves
/// out messages that are at no constant offset or depend on an expression that cannot be inverted.
std::vector<Route> routes_of(const Spec& spec);

/// Returns numbers for which `expr` equals `value`, or for a condition holds (`value` 1) or not;
/// `start` is where the expression's structure begins. Returns nothing if none is found.
std::optional<std::vector<RouteNumber>> solve(const Expr& expr, std::int64_t value,
                                              std::int64_t start);

}  // namespace rubricc
