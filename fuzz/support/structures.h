// Every structure of every spec, as a generated view and as in the tables.
#pragma once

#include <string>

#include "codec/codec_test/every_view.h"
#include "codec/generated/oscilloscope/tables.h"
#include "codec/generated/rubicon/tables.h"
#include "codec/generated/tinyos/tables.h"
#include "codec/reflect/decode.h"

namespace rubric::fuzz {

/// Calls f(type, ViewTag).
template <class F>
void for_each_structure(F f) {
  for_each_view_of_all([&f](const std::string& name, auto tag) {
    const std::size_t dot = name.find('.');
    for (const reflect::Protocol* protocol :
         {&tinyos::tables::kProtocol, &rubicon::tables::kProtocol,
          &oscilloscope::tables::kProtocol}) {
      if (name.substr(0, dot) == protocol->id) {
        f(*reflect::find_type(*protocol, name.substr(dot + 1)), tag);
      }
    }
  });
}

}  // namespace rubric::fuzz
