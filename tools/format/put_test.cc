#include "tools/format/put.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "tools/format/buffer.h"

namespace rubric::format {
namespace {

template <class Put>
std::string text_of(Put put) {
  char text[4096];
  return std::string(text, put(text));
}

TEST(Put, integers_of_every_length_read_back) {
  std::vector<std::uint64_t> values = {0, 9, std::numeric_limits<std::uint64_t>::max()};
  for (std::uint64_t power = 10; power < 10'000'000'000'000'000'000U; power *= 10) {
    values.insert(values.end(), {power - 1, power, power + 1, 7 * power});
  }
  for (const std::uint64_t value : values) {
    EXPECT_EQ(text_of([&](char* at) { return put_uint(at, value); }), std::to_string(value));
  }
  for (std::uint64_t value = 0; value < 120'000; ++value) {
    ASSERT_EQ(text_of([&](char* at) { return put_uint(at, value); }), std::to_string(value));
  }
  for (const std::int64_t value : {std::int64_t{-1}, std::int64_t{-65536}, INT64_MIN, INT64_MAX}) {
    EXPECT_EQ(text_of([&](char* at) { return put_int(at, value); }), std::to_string(value));
  }
}

TEST(Put, floats_are_shortest_and_read_back) {
  const auto text = [](float value) {
    return text_of([&](char* at) { return put_float(at, bits_of_float(value)); });
  };
  EXPECT_EQ(text(1.5F), "1.5");
  EXPECT_EQ(text(0.1F), "0.1");
  EXPECT_EQ(text(-0.0F), "-0");
  EXPECT_EQ(text(std::numeric_limits<float>::infinity()), "\"Infinity\"");
  EXPECT_EQ(text(-std::numeric_limits<float>::infinity()), "\"-Infinity\"");
  EXPECT_EQ(text(std::numeric_limits<float>::quiet_NaN()), "\"NaN\"");
  std::uint32_t bits = 1;
  for (int i = 0; i < 100'000; ++i, bits = bits * 1664525 + 1013904223) {
    const float value = float_of_bits(bits);
    if (value != value) continue;
    const std::string shown = text(value);
    if (shown[0] == '"' || shown[1] == 'I') continue;
    ASSERT_EQ(bits_of_float(std::strtof(shown.c_str(), nullptr)), bits) << shown;
    ASSERT_LE(shown.size(), kMaxFloatChars);
  }
}

TEST(Put, time_is_exact_and_short) {
  const auto text = [](std::int64_t ns) {
    return text_of([&](char* at) { return put_time(at, ns); });
  };
  EXPECT_EQ(text(0), "0");
  EXPECT_EQ(text(1), "0.000000001");
  EXPECT_EQ(text(500'000'000), "0.5");
  EXPECT_EQ(text(12'000'000'000), "12");
  EXPECT_EQ(text(1'700'000'000'123'456'789), "1700000000.123456789");
  EXPECT_EQ(text(-1'000'001'000), "-1.000001");
  EXPECT_EQ(text(INT64_MIN + 1), "-9223372036.854775807");
}

TEST(Put, hex_of_every_length) {
  std::vector<std::uint8_t> bytes;
  std::string expected;
  for (int i = 0; i < 300; ++i) {
    EXPECT_EQ(text_of([&](char* at) {
                return put_hex(at, {bytes.data(), bytes.size()});
              }),
              expected);
    const auto byte = static_cast<std::uint8_t>(i * 7);
    bytes.push_back(byte);
    expected += "0123456789abcdef"[byte >> 4];
    expected += "0123456789abcdef"[byte & 15];
  }
}

TEST(Buffer, grows_and_keeps_what_it_holds) {
  Buffer buffer(4);
  std::string expected;
  for (int i = 0; i < 1000; ++i) {
    const std::string piece(static_cast<std::size_t>(i % 17), static_cast<char>('a' + i % 26));
    buffer.append(piece);
    expected += piece;
  }
  buffer.append('!');
  buffer.append(3, '?');
  EXPECT_EQ(buffer.view(), expected + "!???");
}

}  // namespace
}  // namespace rubric::format
