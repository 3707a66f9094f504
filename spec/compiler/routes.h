// How frames reach messages, worked out from switches and conditions. See codec/reflect/schema.h.
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
  std::int64_t value = 0;  // What it must be; of a length, where the counted bytes begin.
};
struct Route {
  std::string carrier;
  const Type* type = nullptr;
  std::int64_t offset = 0;
  std::uint32_t room = 0;
  std::vector<RouteNumber> choices;
  std::vector<RouteNumber> lengths;
};

/// Each message of each carrier, once for every key and condition that leads to it. Leaves out what
/// stands at no constant offset or hangs on an expression that cannot be turned around.
std::vector<Route> routes_of(const Spec& spec);

/// Numbers at which `expr` equals `value`, or for a condition holds (`value` 1) or not; `start` is
/// where the structure begins that the expression stands in. Nothing if that is not found.
std::optional<std::vector<RouteNumber>> solve(const Expr& expr, std::int64_t value,
                                              std::int64_t start);

}  // namespace rubricc
