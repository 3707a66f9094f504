#include "codec/frame_generator/routes.h"

#include <string_view>

#include "codec/generated/route_tables.h"
#include "codec/reflect/decode.h"

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

using reflect::Interpretation;
using reflect::Type;

const Type* reading(const Interpretation& one, Bytes structure) {
  const reflect::Field& f = one.field;
  if (f.condition.count && !reflect::evaluate(f.condition, structure)) return nullptr;
  if (!f.choice) return f.type;
  return reflect::choose(*f.choice, reflect::evaluate(f.choice->key, structure));
}

bool may_fit_another(const Type& type, std::uint16_t index, Bytes structure, std::size_t size,
                     const Type* wanted, bool before_only) {
  for (int i = 0; i < type.interpretation_count; ++i) {
    const Interpretation& one = type.interpretations[i];
    if (one.overlays != index) continue;
    if (one.field.choice && size == 0) continue;  // The key is the first byte.
    const Type* read = reading(one, structure);
    if (read && read == wanted) {
      if (before_only) return false;
      continue;
    }
    if (read && read->min_size <= size) return true;
  }
  return false;
}

}  // namespace rubric::generate
