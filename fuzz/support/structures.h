// Every structure of every spec, as a generated view and as in the tables.
#pragma once

#include <string>
#include <vector>

#include "codec/reflect/decode.h"
#include "codec/reflect/registry.h"
#include "codec/tests/every_view.h"

namespace rubric::fuzz {

/// A structure, and the function that checks it with its view.
template <class In>
struct Structure {
  const reflect::Type* type;
  void (*check)(In bytes, const reflect::Type& type);
};

/// Returns all structures. `check_of(ViewTag)` returns what checks one.
template <class In, class F>
std::vector<Structure<In>> all_structures(F check_of) {
  std::vector<Structure<In>> out;
  for_each_view_of_all([&](const std::string& name, auto tag) {
    const std::size_t dot = name.find('.');
    const reflect::Protocol& spec = *reflect::find_spec(name.substr(0, dot));
    out.push_back({reflect::find_type(spec, name.substr(dot + 1)), check_of(tag)});
  });
  return out;
}

}  // namespace rubric::fuzz
