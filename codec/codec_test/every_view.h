// Every structure of every spec, for tests that cover all of them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "codec/generated/oscilloscope/all.h"
#include "codec/generated/rubicon/all.h"
#include "codec/generated/tinyos/all.h"

namespace rubric {

/// Calls f(name, ViewTag) with names such as "rubicon.net_msg".
template <class F>
void for_each_view_of_all(F f) {
  const auto in = [&f](const std::string& spec) {
    return [&f, spec](const char* name, auto tag) { f(spec + "." + name, tag); };
  };
  auto tinyos = in("tinyos");
  tinyos::for_each_view(tinyos);
  auto rubicon = in("rubicon");
  rubicon::for_each_view(rubicon);
  auto oscilloscope = in("oscilloscope");
  oscilloscope::for_each_view(oscilloscope);
}

/// A row of a spec's kMessages, under its name with the spec's before it.
struct NamedCodec {
  std::string name;
  MessageCodec codec;
};
inline std::vector<NamedCodec> all_codecs() {
  std::vector<NamedCodec> out;
  const auto add = [&out](const std::string& spec, const auto& messages) {
    for (const MessageCodec& m : messages) out.push_back({spec + "." + m.name, m});
  };
  add("tinyos", tinyos::kMessages);
  add("rubicon", rubicon::kMessages);
  add("oscilloscope", oscilloscope::kMessages);
  return out;
}

}  // namespace rubric
