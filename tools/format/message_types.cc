#include "tools/format/message_types.h"

#include <set>

namespace rubric::format {
namespace {

using reflect::Field;
using reflect::Type;

/// Collects types in the order in which they are met.
class Collector {
 public:
  std::set<const Type*> without;
  std::vector<const Type*> types;

  void add(const Type* type) {
    if (!type || without.contains(type) || !known_.insert(type).second) return;
    types.push_back(type);
    for (int i = 0; i < type->field_count; ++i) add(type->fields[i]);
    for (int i = 0; i < type->interpretation_count; ++i) add(type->interpretations[i].field);
  }

 private:
  void add(const Field& field) {
    add(field.type);
    if (!field.choice) return;
    for (int i = 0; i < field.choice->count; ++i) add(field.choice->cases[i].type);
    add(field.choice->otherwise);
  }

  std::set<const Type*> known_;
};

}  // namespace

std::vector<const Type*> message_types(const reflect::Protocol& protocol) {
  Collector collector;
  for (int i = 0; i < protocol.carrier_count; ++i) {
    const Type* carrier = protocol.carriers[i].type;
    collector.without.insert(carrier);
    for (int k = 0; k < carrier->field_count; ++k) {
      if (carrier->fields[k].type) collector.without.insert(carrier->fields[k].type);
    }
  }
  for (int i = 0; i < protocol.type_count; ++i) collector.add(protocol.types[i]);
  return collector.types;
}
std::vector<const Type*> all_types(const reflect::Protocol& protocol) {
  Collector collector;
  for (int i = 0; i < protocol.carrier_count; ++i) collector.add(protocol.carriers[i].type);
  for (int i = 0; i < protocol.type_count; ++i) collector.add(protocol.types[i]);
  return collector.types;
}

}  // namespace rubric::format
