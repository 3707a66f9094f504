#include "codec/reflect/combined.h"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <string_view>

#include "codec/reflect/decode.h"

namespace rubric::reflect {
namespace {

const Switch* choice_of(const Type& carrier) {
  return carrier.field_count ? carrier.fields[carrier.field_count - 1].choice : nullptr;
}

bool same(const Expr& a, const Expr& b) {
  return std::equal(a.steps, a.steps + a.count, b.steps, b.steps + b.count,
                    [](const ExprStep& x, const ExprStep& y) {
                      return x.op == y.op && x.value == y.value && x.from == y.from;
                    });
}

bool same_places(const Type& a, const Type& b) {
  const Field& last = a.fields[a.field_count - 1];
  const Field& other = b.fields[b.field_count - 1];
  return last.fixed_offset == other.fixed_offset && same(last.choice->key, other.choice->key);
}

bool is_carrier(const Protocol& protocol, const Type* type) {
  return std::any_of(protocol.carriers, protocol.carriers + protocol.carrier_count,
                     [&](const Carrier& carrier) { return carrier.type == type; });
}

}  // namespace

CombinedProtocol::CombinedProtocol(const std::vector<ProtocolPart>& parts) {
  for (const ProtocolPart& part : parts) {
    const Protocol& one = *part.protocol;
    id_ += (id_.empty() ? "" : ",") + std::string(one.id);
    title_ += (title_.empty() ? "" : ", ") + std::string(one.title);
    add_carriers(one);
    std::copy_if(one.types, one.types + one.type_count, std::back_inserter(types_),
                 [&](const Type* type) { return !is_carrier(one, type); });
    enums_.insert(enums_.end(), one.enums, one.enums + one.enum_count);
    masks_.insert(masks_.end(), one.masks, one.masks + one.mask_count);
  }
  for (const Carrier& carrier : carriers_) types_.push_back(carrier.type);
  protocol_ = {id_.c_str(),      title_.c_str(),
               types_.data(),    static_cast<std::uint16_t>(types_.size()),
               enums_.data(),    static_cast<std::uint16_t>(enums_.size()),
               masks_.data(),    static_cast<std::uint16_t>(masks_.size()),
               carriers_.data(), static_cast<std::uint16_t>(carriers_.size())};
  for (const ProtocolPart& part : parts) {
    if (!part.routes) continue;
    const Route* const end = part.routes->routes + part.routes->count;
    std::copy_if(part.routes->routes, end, std::back_inserter(routes_),
                 [&](const Route& route) { return leads_to_its_message(route, *part.protocol); });
  }
  route_table_ = {routes_.data(), static_cast<std::uint16_t>(routes_.size())};
}

void CombinedProtocol::add_carriers(const Protocol& part) {
  for (int i = 0; i < part.carrier_count; ++i) {
    const Carrier& carrier = part.carriers[i];
    const auto known = std::find_if(carriers_.begin(), carriers_.end(), [&](const Carrier& one) {
      return std::string_view(one.name) == carrier.name;
    });
    if (known == carriers_.end()) {
      carriers_.push_back(carrier);
    } else if (!choice_of(*known->type)) {
      known->type = carrier.type;  // The first one chooses no messages.
    } else if (choice_of(*carrier.type)) {
      add_cases(*known, carrier, part);
    }
  }
}

// Gives the carrier the cases of the other for keys that it has no case for.
void CombinedProtocol::add_cases(Carrier& carrier, const Carrier& other, const Protocol& part) {
  if (!same_places(*carrier.type, *other.type)) {
    throw std::invalid_argument(std::string(part.id) + " has the messages of " + other.name +
                                " frames, or the number that chooses one, in another place than " +
                                id_.substr(0, id_.rfind(',')));
  }
  const Switch& first = *choice_of(*carrier.type);
  const Switch& second = *choice_of(*other.type);
  std::vector<SwitchCase>& cases = cases_.emplace_back(first.cases, first.cases + first.count);
  cases.insert(cases.end(), second.cases, second.cases + second.count);
  const auto less = [](const SwitchCase& a, const SwitchCase& b) { return a.key < b.key; };
  std::stable_sort(cases.begin(), cases.end(), less);
  const auto equal = [](const SwitchCase& a, const SwitchCase& b) { return a.key == b.key; };
  cases.erase(std::unique(cases.begin(), cases.end(), equal), cases.end());
  Switch& choice = choices_.emplace_back(first);
  choice.cases = cases.data();
  choice.count = static_cast<std::uint16_t>(cases.size());
  if (!choice.otherwise) choice.otherwise = second.otherwise;
  const Type& type = *carrier.type;
  std::vector<Field>& fields = fields_.emplace_back(type.fields, type.fields + type.field_count);
  fields.back().choice = &choice;
  Type& combined = carrier_types_.emplace_back(type);
  combined.fields = fields.data();
  carrier.type = &combined;
}

// Returns whether the route's key leads to the message of its own part.
bool CombinedProtocol::leads_to_its_message(const Route& route, const Protocol& part) const {
  const Type* const carrier = find_carrier(protocol_, route.carrier);
  const Type* const own = find_carrier(part, route.carrier);
  if (!carrier || carrier == own || !choice_of(*own)) return true;  // Bare, or of one part alone.
  const auto offset = choice_of(*own)->key.steps[0].value;
  return std::all_of(
      route.choices, route.choices + route.choice_count, [&](const RouteChoice& choice) {
        return choice.offset != offset ||
               choose(*choice_of(*carrier), choice.value) == choose(*choice_of(*own), choice.value);
      });
}

}  // namespace rubric::reflect
