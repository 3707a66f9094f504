// Helpers to write messages and frames in tests.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "codec/reflect/encode.h"
#include "conformance/trace/concrete.h"
#include "conformance/trace/parse.h"

namespace rubric::trace {

inline Message message(std::string_view text) {
  Message out;
  EXPECT_EQ(parse_message(text, out), "") << text;
  return out;
}

inline AmFrame frame(std::uint8_t type, std::string_view hex) {
  AmFrame out{.dest = kAmAll, .src = 5, .type = type};
  EXPECT_TRUE(reflect::parse_hex(hex, out.payload));
  return out;
}

}  // namespace rubric::trace
