#include "codec/runtime/bytes.h"

#include <gtest/gtest.h>

namespace rubric {
namespace {

TEST(Bytes, LoadsAndStoresAgreeAtEveryAlignment) {
  uint8_t room[16] = {};
  for (size_t at = 0; at < 8; ++at) {
    store_be16(room + at, 0x1234);
    EXPECT_EQ(room[at], 0x12);
    EXPECT_EQ(load_be16(room + at), 0x1234);
    EXPECT_EQ(load_le16(room + at), 0x3412);
    store_le16(room + at, 0x1234);
    EXPECT_EQ(load_le16(room + at), 0x1234);
    store_be32(room + at, 0x80ABCDEF);
    EXPECT_EQ(room[at], 0x80);
    EXPECT_EQ(load_be32(room + at), 0x80ABCDEFu);
    EXPECT_EQ(load_le32(room + at), 0xEFCDAB80u);
    store_le32(room + at, 0x80ABCDEF);
    EXPECT_EQ(load_le32(room + at), 0x80ABCDEFu);
  }
}

TEST(Bytes, CutsAreViews) {
  const uint8_t data[] = {1, 2, 3, 4, 5};
  const Bytes all(data);
  EXPECT_EQ(all.first(2).size(), 2u);
  EXPECT_EQ(all.from(3)[0], 4);
  EXPECT_EQ(all.sub(1, 2).data(), data + 1);
  EXPECT_TRUE(all.from(5).empty());
  EXPECT_TRUE(equal(all.first(0), Bytes()));
  EXPECT_FALSE(equal(all, all.first(4)));
}

TEST(Bytes, FloatsKeepTheirBits) {
  for (uint32_t bits : {0u, 0x80000000u, 0x3F800000u, 0x7FC00001u, 0xFF800000u}) {
    EXPECT_EQ(bits_of_float(float_of_bits(bits)), bits);
  }
}

}  // namespace
}  // namespace rubric
