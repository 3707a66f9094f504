// Helpers of the generator's tests: the protocols with their routes, and words for failures.
#pragma once

#include <string>
#include <vector>

#include "codec/containers/tests/testing.h"
#include "codec/frame_generator/routes.h"
#include "codec/generated/tinyos/enums.h"
#include "codec/generated/tinyos/tables.h"
#include "codec/reflect/fault_text.h"
#include "codec/reflect/registry.h"
#include "codec/reflect/schema.h"

namespace rubric::generate {

// The link layer's acknowledgement, which exists below every protocol: its route, for a
// FrameGenerator of tinyos::tables::kProtocol.

// IEEE 802.15.4-2006, section 7.2.2.3: the frame type, and nothing else, is set.
constexpr reflect::RouteChoice kLinkAckChoices[] = {
    {0, 2, true, static_cast<uint32_t>(tinyos::FrameControl::kAck)}};
constexpr reflect::Route kLinkAckRoute[] = {
    {"radio_ack", &tinyos::tables::types::kMacAck, 0, UINT32_MAX, kLinkAckChoices, 1, nullptr, 0}};
constexpr reflect::RouteTable kLinkAckRoutes{kLinkAckRoute, 1};

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
