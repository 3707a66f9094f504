#include "codec/reflect/registry.h"

#include <iterator>

#include "codec/generated/protocols.h"

namespace rubric::reflect {
namespace {

const Protocol* find(std::span<const Protocol* const> among, std::string_view id) {
  for (const Protocol* protocol : among) {
    if (id == protocol->id) return protocol;
  }
  return nullptr;
}

}  // namespace

const std::vector<const Protocol*>& protocols() {
  static const std::vector<const Protocol*> all(std::begin(kProtocols), std::end(kProtocols));
  return all;
}

const Protocol* find_protocol(std::string_view id) { return find(protocols(), id); }

std::span<const Protocol* const> specs() { return kSpecs; }

const Protocol* find_spec(std::string_view id) { return find(specs(), id); }

}  // namespace rubric::reflect
