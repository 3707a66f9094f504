#include "codec/runtime/hdlc.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

namespace rubric {
namespace {

std::vector<uint8_t> from_hex(const std::string& text) {
  std::vector<uint8_t> bytes;
  std::string digits;
  for (char c : text) {
    if (c == ' ') continue;
    digits += c;
    if (digits.size() < 2) continue;
    bytes.push_back(static_cast<uint8_t>(std::stoi(digits, nullptr, 16)));
    digits.clear();
  }
  return bytes;
}

Bytes view(const std::vector<uint8_t>& bytes) { return Bytes(bytes.data(), bytes.size()); }

struct FrameCase {
  const char* name;
  const char* content;
  const char* frame;
};
// The firmware sent the first two.
const FrameCase kFrames[] = {
    {"Ack0", "43 00", "7e 43 00 9f 58 7e"},
    {"Ack1", "43 01", "7e 43 01 be 48 7e"},
    {"HostConfig", "44 00 00 ff ff 00 00 03 00 25 63 00 0c",
     "7e 44 00 00 ff ff 00 00 03 00 25 63 00 0c 18 f8 7e"},
    {"Escapes", "45 7e 7d 5e", "7e 45 7d 5e 7d 5d 5e"},
};

TEST(WireHdlcEscape, FramesAsMeasured) {
  for (const FrameCase& row : kFrames) {
    const auto content = from_hex(row.content);
    uint8_t room[64];
    const Result<size_t> size = write_hdlc_frame(view(content), room);
    ASSERT_TRUE(size.has_value()) << row.name;
    const auto expected = from_hex(row.frame);
    ASSERT_LE(expected.size(), *size);
    EXPECT_TRUE(equal(Bytes(room, expected.size()), view(expected))) << row.name;
    uint8_t buffer[64];
    HdlcDeframer deframer(buffer);
    HdlcEvent event = HdlcEvent::kNone;
    for (size_t i = 0; i < *size; ++i) {
      ASSERT_EQ(event, HdlcEvent::kNone);
      event = deframer.push(room[i]);
    }
    ASSERT_EQ(event, HdlcEvent::kFrame) << row.name;
    EXPECT_TRUE(equal(deframer.content(), view(content))) << row.name;
  }
}

TEST(WireHdlcFlag, ShorthandsWriteTheSameFrames) {
  const auto packet = from_hex("00 ff ff 00 00 03 00 25 63 00 0c");
  uint8_t room[64];
  ASSERT_EQ(*write_serial_ack(1, room), 6u);
  EXPECT_TRUE(equal(Bytes(room, 6), view(from_hex(kFrames[1].frame))));
  ASSERT_EQ(*write_serial_packet_ack(0, view(packet), room), 17u);
  EXPECT_TRUE(equal(Bytes(room, 17), view(from_hex(kFrames[2].frame))));
  ASSERT_EQ(*write_serial_packet(view(packet), room), 16u);
  EXPECT_EQ(room[1], kSerialPacketNoAck);
}

TEST(WireHdlcLong, WritersRefuseWhatIsTooLongOrDoesNotFit) {
  const std::vector<uint8_t> packet(300, 0x11);
  std::vector<uint8_t> room(700);
  const MutableBytes out(room.data(), room.size());
  const auto fault = [](Fault f, size_t at, ReqId id) {
    return Error{f, static_cast<uint32_t>(at), id};
  };
  EXPECT_TRUE(write_serial_packet(view(packet).first(252), out).has_value());
  EXPECT_EQ(write_serial_packet(view(packet).first(253), out).error(),
            fault(Fault::kTooLong, 253, "WIRE-HDLC-LONG"_rule));
  EXPECT_TRUE(write_serial_packet_ack(9, view(packet).first(252), out).has_value());
  EXPECT_EQ(write_serial_packet_ack(9, view(packet).first(253), out).error(),
            fault(Fault::kTooLong, 254, "WIRE-HDLC-LONG"_rule));
  EXPECT_EQ(write_hdlc_frame(view(packet), out).error(),
            fault(Fault::kTooLong, 253, "WIRE-HDLC-LONG"_rule));
  for (size_t size = 0; size < 6; ++size) {
    EXPECT_EQ(write_serial_ack(1, out.first(size)).error(),
              fault(Fault::kNoRoom, size, "WIRE-HDLC-FLAG"_rule));
  }
}

struct BadCase {
  const char* name;
  const char* stream;
  Error error;
  size_t kept;
};
const BadCase kBad[] = {
    {"OneByte", "7e 45 7e", {Fault::kTooShort, 1, "WIRE-HDLC-SHORT"_rule}, 1},
    {"ThreeBytes", "7e 45 00 00 7e", {Fault::kTooShort, 3, "WIRE-HDLC-SHORT"_rule}, 3},
    {"WrongCrc", "7e 43 00 9f 59 7e", {Fault::kCrc, 2, "WIRE-SERIAL-CRC"_rule}, 4},
    {"Aborted", "7e 43 00 9f 58 7d 7e", {Fault::kAborted, 4, "WIRE-HDLC-ESCAPE"_rule}, 4},
    {"AbortedAtOnce", "7e 7d 7e", {Fault::kAborted, 0, "WIRE-HDLC-ESCAPE"_rule}, 0},
    {"BeyondTheBuffer",
     "7e 43 00 00 00 00 00 00 00 00 7e",
     {Fault::kTooLong, 8, "WIRE-HDLC-LONG"_rule},
     8},
};

TEST(WireHdlcShort, BadFramesAreReportedAndTheNextIsFound) {
  for (const BadCase& row : kBad) {
    uint8_t buffer[8];
    HdlcDeframer deframer(buffer);
    HdlcEvent event = HdlcEvent::kNone;
    for (uint8_t byte : from_hex(row.stream)) event = deframer.push(byte);
    ASSERT_EQ(event, HdlcEvent::kBad) << row.name;
    EXPECT_EQ(deframer.error(), row.error) << row.name;
    EXPECT_EQ(deframer.content().size(), row.kept) << row.name;
    // The flag that closed the bad frame opens the next one.
    for (uint8_t byte : from_hex("43 01 be 48 7e")) event = deframer.push(byte);
    EXPECT_EQ(event, HdlcEvent::kFrame) << row.name;
  }
}

TEST(WireHdlcEscape, RandomContentsComeBack) {
  std::mt19937 random(20140);
  uint8_t out[hdlc_frame_room(300)];
  uint8_t buffer[256];
  HdlcDeframer deframer(buffer);
  for (int round = 0; round < 2000; ++round) {
    std::vector<uint8_t> content(2 + random() % 250);
    // Half of the bytes need escapes.
    for (uint8_t& byte : content) {
      byte = static_cast<uint8_t>(random() % 2 ? random() : 0x7C + random() % 4);
    }
    const Result<size_t> size = write_hdlc_frame(view(content), out);
    ASSERT_TRUE(size.has_value());
    int frames = 0;
    for (size_t i = 0; i < *size; ++i) {
      const HdlcEvent event = deframer.push(out[i]);
      ASSERT_NE(event, HdlcEvent::kBad);
      if (event != HdlcEvent::kFrame) continue;
      ++frames;
      EXPECT_TRUE(equal(deframer.content(), view(content)));
    }
    EXPECT_EQ(frames, 1);
  }
}

}  // namespace
}  // namespace rubric
