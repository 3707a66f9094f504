// Every structure of every spec, for tests that cover all of them.
#pragma once

#include <string>
#include <vector>

#include "codec/generated/every_spec.h"

namespace rubric {

/// Calls f(name, ViewTag) with names such as "rubicon.net_msg".
template <class F>
void for_each_view_of_all(F f) {
  for_each_spec([&f](const char* spec, const auto&, auto for_each_view) {
    auto named = [&](const char* name, auto tag) { f(spec + std::string(".") + name, tag); };
    for_each_view(named);
  });
}

/// A row of a spec's kMessages, under its name with the spec's before it.
struct NamedCodec {
  std::string name;
  MessageCodec codec;
};
inline std::vector<NamedCodec> all_codecs() {
  std::vector<NamedCodec> out;
  for_each_spec([&out](const std::string& spec, const auto& messages, auto) {
    for (const MessageCodec& m : messages) out.push_back({spec + "." + m.name, m});
  });
  return out;
}

}  // namespace rubric
