#include "codec/runtime/bytes.h"

#include <gtest/gtest.h>

#include "codec/runtime/crc16.h"
#include "codec/runtime/ieee802154_fcs.h"

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

// The definitions, bit by bit, as an independent reference.
uint16_t crc16_bitwise(uint16_t crc, uint8_t byte) {
  uint32_t rest = crc ^ static_cast<uint32_t>(byte) << 8;
  for (int bit = 0; bit < 8; ++bit) {
    rest <<= 1;
    if ((rest & 0x10000) != 0) rest ^= 0x11021;
  }
  return static_cast<uint16_t>(rest);
}
uint16_t fcs_bitwise(uint16_t fcs, uint8_t byte) {
  uint32_t rest = fcs ^ byte;
  for (int bit = 0; bit < 8; ++bit) {
    const bool odd = (rest & 1) != 0;
    rest >>= 1;
    if (odd) rest ^= 0x8408;
  }
  return static_cast<uint16_t>(rest);
}

TEST(WireSerialCrc, EveryStateAndByte) {
  for (uint32_t crc = 0; crc < 0x10000; crc += 7) {
    for (uint32_t byte = 0; byte < 256; ++byte) {
      const auto state = static_cast<uint16_t>(crc);
      const auto in = static_cast<uint8_t>(byte);
      ASSERT_EQ(crc16_step(state, in), crc16_bitwise(state, in)) << crc << ' ' << byte;
      ASSERT_EQ(fcs_step(state, in), fcs_bitwise(state, in)) << crc << ' ' << byte;
    }
  }
}

TEST(WireSerialCrc, CheckValue) {
  const uint8_t digits[] = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  EXPECT_EQ(crc16(digits), 0x31C3);
  EXPECT_EQ(crc16(Bytes(digits).from(4), crc16(Bytes(digits).first(4))), 0x31C3);
}

TEST(WireRadioFcs, CheckValueAndMeasuredFrame) {
  const uint8_t digits[] = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  EXPECT_EQ(fcs(digits), 0x2189);
  // A join request as the firmware's radio sent it, FCS d720 little-endian.
  const uint8_t frame[] = {0x41, 0x88, 0x00, 0x22, 0x00, 0x01, 0x00, 0x02, 0x00,
                           0x3f, 0x0e, 0xc4, 0xf5, 0x01, 0x00, 0x43, 0x01};
  EXPECT_EQ(fcs(frame), 0xd720);
}

}  // namespace

}  // namespace rubric
