#include "codec/reflect/registry.h"

#include <iterator>

#include "codec/generated/protocols.h"

namespace rubric::reflect {

const std::vector<const Protocol*>& protocols() {
  static const std::vector<const Protocol*> all(std::begin(kProtocols), std::end(kProtocols));
  return all;
}

const Protocol* find_protocol(std::string_view id) {
  for (const Protocol* protocol : protocols()) {
    if (id == protocol->id) return protocol;
  }
  return nullptr;
}

}  // namespace rubric::reflect
