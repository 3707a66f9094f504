// Helpers of the generator's tests: the protocols with their routes, and words for failures.
#pragma once

#include <string>
#include <vector>

#include "codec/containers/test/testing.h"
#include "codec/generate/link_ack.h"
#include "codec/generate/routes.h"
#include "codec/reflect/fault_text.h"
#include "codec/reflect/registry.h"

namespace rubric::generate {

struct Known {
  const reflect::Protocol& protocol;
  const reflect::RouteTable& routes;
  const reflect::Protocol& reader;  ///< Its decoder reads them.
};
inline std::vector<Known> all_known() {
  std::vector<Known> out;
  for (const reflect::Protocol* one : reflect::protocols()) {
    out.push_back({*one, *routes_of(*one), *one});
  }
  out.push_back({tinyos::tables::kProtocol, kLinkAckRoutes, *reflect::protocols().back()});
  return out;
}

inline std::string text(const Error& error) {
  return std::string(reflect::fault_name(error.fault)) + " at " +
         std::to_string(error.offset_bytes) + " by " + reflect::requirement(error.requirement).id;
}

/// Returns names of types: their addresses differ between files.
inline std::vector<std::string> names(const reflect::Type* const* path, std::size_t count) {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < count; ++i) out.emplace_back(path[i]->id);
  return out;
}

/// Describes a Generated or a Framed.
template <class Made>
std::string described(const Made& made) {
  return std::string(made.route->carrier) + "/" + made.route->type->id + ", " + made.what + ", " +
         text(made.error) + ": " +
         rubric::testing::to_hex(Bytes(made.bytes.data(), made.bytes.size()));
}

}  // namespace rubric::generate
