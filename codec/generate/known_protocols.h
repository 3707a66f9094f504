// Helpers of the generator's tests: the protocols with their routes, and words for failures.
#pragma once

#include <string>
#include <vector>

#include "codec/containers/testing.h"
#include "codec/generate/link_ack.h"
#include "codec/generated/oscilloscope/messages.h"
#include "codec/generated/rubicon/messages.h"
#include "codec/reflect/fault_text.h"

namespace rubric::generate {

struct Known {
  const reflect::Protocol& protocol;
  const reflect::RouteTable& routes;
  const reflect::Protocol& reader;  ///< Its decoder reads them.
};
const Known kKnown[] = {
    {rubicon::tables::kProtocol, rubicon::messages::kRoutes, rubicon::tables::kProtocol},
    {oscilloscope::tables::kProtocol, oscilloscope::messages::kRoutes,
     oscilloscope::tables::kProtocol},
    {tinyos::tables::kProtocol, kLinkAckRoutes, rubicon::tables::kProtocol},
};
constexpr int kKnownCount = 3;

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
