// Helpers to write messages and frames in tests.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "codec/reflect/encode.h"
#include "conformance/trace/concrete.h"
#include "conformance/trace/parse.h"
#include "conformance/trace/value_text.h"

namespace rubric::trace {

inline Message message(std::string_view text) {
  Message out;
  EXPECT_EQ(parse_message(text, out), "") << text;
  return out;
}

inline AmFrame frame(std::uint8_t type, std::string_view hex) {
  AmFrame out;
  out.dest = kAmAll;
  out.src = 5;
  out.type = type;
  EXPECT_TRUE(reflect::parse_hex(hex, out.payload));
  return out;
}

inline std::string hex_of(const std::vector<std::uint8_t>& bytes) {
  std::string text;
  put_hex({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, text);
  return text;
}

}  // namespace rubric::trace
