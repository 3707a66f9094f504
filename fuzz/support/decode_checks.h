// What every output of `rubric decode` keeps, for the targets that print frames.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "codec/containers/tests/testing.h"
#include "codec/reflect/decode.h"
#include "fuzz/support/require.h"
#include "tools/encode/members.h"
#include "tools/format/record.h"

namespace rubric::fuzz {

inline void check_nodes(const reflect::Decoded& decoded) {
  for (std::size_t i = 0; i < decoded.node_count(); ++i) {
    const reflect::Node& node = decoded[i];
    require(node.offset + node.size <= decoded.bytes.size(), "a field lies within the packet");
    require(node.end > i && node.end <= decoded.node_count(), "nodes are nested");
  }
  for (std::size_t i = 0; i < decoded.stale_count(); ++i) {
    require(decoded.stale()[i].offset + decoded.stale()[i].size <= decoded.bytes.size(),
            "stale bytes lie within the packet");
  }
}

inline void check_json(std::string_view text, const format::Record& record) {
  require(!text.empty() && text.find('\n') == text.size() - 1, "a frame is one line of JSON");
  const reflect::Value line = encode::parse_json(text);  // Throws where it is not JSON in UTF-8.
  const auto member = [&](std::string_view key) {
    const reflect::Value* const found = line.find(key);
    return found ? *found : reflect::Value::of_array({});
  };
  require(member("schema").text == "rubric.decode/1", "a line says what it is");
  require(member("error").is(reflect::Value::Kind::kNull) == !record.frame->has_error(),
          "a line says what is malformed");
  require(member("raw").text == testing::to_hex(record.packet().bytes),
          "a line holds the packet's bytes");
}

inline void check_text(std::string_view text, bool color) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    if (color && c == 0x1B) {
      require(text.substr(i, 2) == "\x1b[", "an escape begins a colour");
      i = std::min(text.find('m', i), text.size() - 1);
      continue;
    }
    require((c >= ' ' && c != 0x7F) || c == '\n', "text holds no control characters");
  }
  require(text.ends_with('\n'), "text ends with its line");
}

}  // namespace rubric::fuzz
