#include "codec/generate/routes.h"

#include <string_view>

#include "codec/generated/oscilloscope/messages.h"
#include "codec/generated/rubicon/messages.h"

namespace rubric::generate {

const reflect::RouteTable* routes_of(const reflect::Protocol& protocol) {
  const std::string_view id = protocol.id;
  if (id == oscilloscope::tables::kProtocol.id) return &oscilloscope::messages::kRoutes;
  if (id == rubicon::tables::kProtocol.id) return &rubicon::messages::kRoutes;
  return nullptr;
}

bool same_message(const reflect::Type* a, const reflect::Type* b) {
  return a == b || (a && b && std::string_view(a->id) == b->id);
}

}  // namespace rubric::generate
