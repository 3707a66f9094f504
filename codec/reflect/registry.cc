#include "codec/reflect/registry.h"

#include "codec/generated/oscilloscope/tables.h"
#include "codec/generated/rubicon/tables.h"

namespace rubric::reflect {

const std::vector<const Protocol*>& protocols() {
  static const std::vector<const Protocol*> all = {
      &rubicon::tables::kProtocol,
      &oscilloscope::tables::kProtocol,
  };
  return all;
}

const Protocol* find_protocol(std::string_view id) {
  for (const Protocol* protocol : protocols()) {
    if (id == protocol->id) return protocol;
  }
  return nullptr;
}

}  // namespace rubric::reflect
