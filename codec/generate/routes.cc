#include "codec/generate/routes.h"

#include <string_view>

#include "codec/generated/route_tables.h"

namespace rubric::generate {

const reflect::RouteTable* routes_of(const reflect::Protocol& protocol) {
  const std::string_view id = protocol.id;
  for (const reflect::ProtocolRoutes& known : reflect::kProtocolRoutes) {
    if (known.protocol->id == id) return known.routes;
  }
  return nullptr;
}

bool same_message(const reflect::Type* a, const reflect::Type* b) {
  return a == b || (a && b && std::string_view(a->id) == b->id);
}

}  // namespace rubric::generate
