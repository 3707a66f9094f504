#include "codec/runtime/crc16.h"

#include <gtest/gtest.h>

#include "codec/runtime/ieee802154_fcs.h"

namespace rubric {
namespace {

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
