// Every structure of every spec, as a generated view and as in the tables.
#pragma once

#include <string>

#include "codec/codec_test/every_view.h"
#include "codec/reflect/decode.h"
#include "codec/reflect/registry.h"

namespace rubric::fuzz {

/// Calls f(type, ViewTag).
template <class F>
void for_each_structure(F f) {
  for_each_view_of_all([&f](const std::string& name, auto tag) {
    const std::size_t dot = name.find('.');
    f(*reflect::find_type(*reflect::find_spec(name.substr(0, dot)), name.substr(dot + 1)), tag);
  });
}

}  // namespace rubric::fuzz
