#include "codec/reflect/fault_text.h"

#include <gtest/gtest.h>

#include <vector>

#include "codec/reflect/registry.h"

namespace rubric::reflect {
namespace {

std::string text_of(const char* type, std::vector<std::uint8_t> bytes) {
  Decoded decoded;
  decode(*find_type(*find_protocol("rubicon"), type), Bytes(bytes.data(), bytes.size()),
         Tail::kFault, true, decoded);
  return error_text(decoded);
}

TEST(FaultText, has_a_name_and_a_sentence_for_every_fault) {
  for (int i = 0; i <= static_cast<int>(Fault::kUnsupported); ++i) {
    const auto fault = static_cast<Fault>(i);
    EXPECT_EQ(find_fault(fault_name(fault)), fault);
    EXPECT_FALSE(fault_sentence(fault).empty());
  }
  EXPECT_EQ(fault_name(static_cast<Fault>(200)), "unknown");
  EXPECT_FALSE(find_fault("nonsense"));
}

TEST(FaultText, finds_requirements) {
  EXPECT_STREQ(requirement("WIRE-NET-NBYTES"_rule).id, "WIRE-NET-NBYTES");
  EXPECT_STREQ(requirement(ReqId::kNone).id, "");
  EXPECT_STREQ(requirement(static_cast<ReqId>(60000)).id, "");
  EXPECT_EQ(find_requirement("wire-net-nbytes"), "WIRE-NET-NBYTES"_rule);
  EXPECT_EQ(find_requirement("WIRE-NET"), ReqId::kNone);
  EXPECT_EQ(find_requirement(""), ReqId::kNone);
}

TEST(FaultText, says_the_numbers) {
  EXPECT_EQ(text_of("config", {10, 0}), "value needs 2 bytes, the bytes end at 2");
  EXPECT_EQ(text_of("config", {10, 0, 12, 0}), "1 byte more than the length says");
  EXPECT_EQ(text_of("net_msg", {0, 11, 0, 2, 0, 11, 0, 1, 0, 0, 1, 119}),
            "nbytes is 119, allowed are 2 to 102");
  EXPECT_EQ(text_of("net_msg", {0, 11, 0, 2, 0, 11, 0, 1, 0, 0, 1, 5, 3}),
            "payload needs 5 bytes, the bytes end at 13");
}

TEST(FaultText, compares_check_sums) {
  const std::uint8_t bytes[] = {0x00, 0xff};
  Packet packet;
  packet.framing = Framing::kHdlc;
  packet.bytes = bytes;
  packet.kind = 69;
  packet.crc = 0;
  packet.error = Error{Fault::kCrc, 3, "WIRE-SERIAL-CRC"_rule};
  Frame frame;
  FrameDecoder(*find_protocol("rubicon")).decode(packet, frame);
  EXPECT_EQ(error_text(frame).find("the check sum of the serial frame does not match: it is 0x0000,"
                                   " the bytes give 0x"),
            0U);
  EXPECT_EQ(frame.error.offset_bytes, 2U);
}

TEST(FaultText, says_what_was_expected) {
  Decoded decoded;
  const std::uint8_t updates[] = {34, 0};
  decode(*find_type(*find_protocol("rubicon"), "updates"), updates, Tail::kFault, true, decoded);
  ASSERT_EQ(decoded.note_count(), 1U);
  EXPECT_EQ(note_name(decoded.notes()[0].kind), "unexpected_value");
  EXPECT_EQ(note_text(decoded.notes()[0]), "type is 34 (demo_data), expected is 35 (updates)");
}

TEST(Registry, has_protocols_by_name) {
  ASSERT_NE(find_protocol("rubicon"), nullptr);
  ASSERT_NE(find_protocol("oscilloscope"), nullptr);
  EXPECT_EQ(find_protocol("nonsense"), nullptr);
  EXPECT_EQ(protocols().size(), 2U);
}

}  // namespace
}  // namespace rubric::reflect
