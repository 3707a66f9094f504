// Writers and difficult packets: damaged ones, and times beyond a format.
#include <gtest/gtest.h>

#include <deque>
#include <string>

#include "codec/containers/hdlc_reader.h"
#include "codec/containers/link_record.h"
#include "codec/containers/pcap_reader.h"
#include "codec/containers/tests/testing.h"
#include "codec/containers/writer.h"

namespace rubric {
namespace {

using namespace testing;

const std::string kTap = from_hex("0000 0c00 0000 0100 01000000");  // 16-bit FCS.

// Keeps all records, as packets refer to their bytes.
Packet of_record(const std::string& text, std::uint16_t link_type, std::size_t missing = 0) {
  static std::deque<std::string> records;
  const std::string& record = records.emplace_back(text);
  Packet packet;
  decode_record(view(record), record.size() + missing, link_type, "WIRE-PCAP"_rule, packet);
  return packet;
}

struct TapCase {
  const char* name;
  const char* frame;  ///< After the TAP header.
  std::size_t missing;
  Error error;
  std::uint16_t link_type;  ///< Under which it is written.
};
const TapCase kTapCases[] = {
    {"Sound", "02 00 01 31 a4", 0, kSound, kLinkRadioFcs},
    {"WrongFcs", "02 00 01 ff ff", 0, {Fault::kFcs, 3, "WIRE-RADIO-FCS"_rule}, kLinkRadioFcs},
    {"NoRoomForTheFcs", "02", 0, {Fault::kTooShort, 1, "WIRE-RADIO-FCS"_rule}, kLinkRadioFcs},
    {"Empty", "", 0, {Fault::kEmpty, 0, "WIRE-RADIO-HEADER"_rule}, kLinkRadioNoFcs},
    {"Cut", "02 00 01", 2, {Fault::kCut, 3, ReqId::kNone}, kLinkRadioNoFcs},
};

// The header is gone once it was understood, so that a record without it must not claim one.
TEST(WireRadioTap, FramesAreWrittenWithoutTheHeader) {
  for (const TapCase& row : kTapCases) {
    const std::string record = kTap + from_hex(row.frame);
    const Packet packet = of_record(record, kLinkRadioTap, row.missing);
    EXPECT_EQ(packet.error, row.error) << row.name;
    EXPECT_EQ(link_type_of(packet), row.link_type) << row.name;
    std::string written;
    append_record(packet, written);
    EXPECT_EQ(written, from_hex(row.frame)) << row.name;
    const Packet again = of_record(written, row.link_type, row.missing);
    EXPECT_EQ(again.error, packet.error) << row.name;
    EXPECT_TRUE(equal(again.bytes, packet.bytes)) << row.name;
    EXPECT_EQ(again.fcs, packet.fcs) << row.name;
  }
}

// Facts as a sniffer for TSCH states them; the bit rate is not kept.
const std::string kFacts = from_hex(
    "0000 3000 0000 0100 01000000 0100 0400 00008fc2 0300 0300 1a000000 0700 0800 15cd5b0700000000"
    "0a00 0100 80000000");

TEST(WireRadioTap, FactsAreKept) {
  for (const TapCase& row : kTapCases) {
    const std::string record = kFacts + from_hex(row.frame);
    const Packet packet = of_record(record, kLinkRadioTap, row.missing);
    EXPECT_EQ(packet.error, row.error) << row.name;
    EXPECT_EQ(packet.radio.rssi, -71.5F);
    EXPECT_EQ(packet.radio.channel, 26);
    EXPECT_EQ(packet.radio.slot, 123456789);
    EXPECT_EQ(packet.radio.lqi, 128);
    EXPECT_FALSE(packet.radio.more);
    EXPECT_EQ(link_type_of(packet), kLinkRadioTap) << row.name;
    std::string written;
    append_record(packet, written);
    const Packet again = of_record(written, kLinkRadioTap, row.missing);
    EXPECT_EQ(again.error, packet.error) << row.name;
    EXPECT_TRUE(equal(again.bytes, packet.bytes)) << row.name;
    EXPECT_EQ(again.fcs, packet.fcs) << row.name;
    EXPECT_EQ(again.radio, packet.radio) << row.name;
  }
  const std::string rate = from_hex("0000 0c00 0200 0400 90d00300 02 00 01");
  const Packet packet = of_record(rate, kLinkRadioTap);
  EXPECT_TRUE(packet.radio.more);
  EXPECT_FALSE(packet.radio.any());
}

TEST(WireRadioTap, FactsThatAreNoneAreLeftOut) {
  for (const char* fact : {"0100 0400 0000c07f", "0100 0200 00000000", "0300 0100 1a000000",
                           "0a00 0000", "0700 0800 0000000000000080"}) {
    const std::string body = from_hex(fact);
    std::string header = from_hex("00000000") + body;
    header[2] = static_cast<char>(header.size());
    const Packet packet = of_record(header + from_hex("02 00 01"), kLinkRadioTap);
    EXPECT_EQ(packet.error, kSound) << fact;
    EXPECT_FALSE(packet.radio.any()) << fact;
  }
}

// The chip's trailer in place of the FCS says the same as a header would.
TEST(WireRadioTap, ATrailerStaysATrailer) {
  Packet packet = of_record(from_hex("02 00 01 d0 eb"), kLinkRadioFcs);
  packet.error = kSound;
  packet.radio.rssi = -48.0F;
  EXPECT_EQ(link_type_of(packet), kLinkRadioFcs);
  std::string written;
  append_record(packet, written);
  EXPECT_EQ(written, from_hex("02 00 01 d0 eb"));
}

TEST(WireRadioPhy, ThePreambleIsTakenOff) {
  const std::string phy = from_hex("00000000 a7 05 02 00 01 31 a4");
  Packet packet = of_record(phy, kLinkRadioPhy);
  EXPECT_EQ(packet.error, kSound);
  EXPECT_EQ(packet.link_type, kLinkRadioFcs);
  EXPECT_EQ(packet.offset_bytes, 6u);
  EXPECT_EQ(packet.fcs, 0xa431);
  EXPECT_EQ(of_record(phy + "x", kLinkRadioPhy).error, kSound);
  packet = of_record(phy.substr(0, 9), kLinkRadioPhy, 2);
  EXPECT_EQ(packet.error, (Error{Fault::kCut, 3, ReqId::kNone}));
  EXPECT_EQ(of_record(phy.substr(0, 3), kLinkRadioPhy, 8).error.fault, Fault::kCut);
  EXPECT_EQ(of_record(phy.substr(0, 9), kLinkRadioPhy).error,
            (Error{Fault::kTruncated, 9, "WIRE-PCAP"_rule}));
  packet = of_record(from_hex("00000000 a6 05 02 00 01 31 a4"), kLinkRadioPhy);
  EXPECT_EQ(packet.error, (Error{Fault::kUnexpected, 4, "WIRE-PCAP"_rule}));
  std::string written;
  append_record(packet, written);
  EXPECT_EQ(written, from_hex("00000000 a6 05 02 00 01 31 a4"));
  EXPECT_EQ(link_type_of(packet), kLinkRadioPhy);
}

TEST(WireRadioLinux, AnFcsThatFitsIsOne) {
  Packet packet = of_record(from_hex("02 00 01 31 a4"), kLinkRadioLinux);
  EXPECT_EQ(packet.fcs, 0xa431);
  EXPECT_EQ(packet.link_type, kLinkRadioFcs);
  packet = of_record(from_hex("02 00 01"), kLinkRadioLinux);
  EXPECT_EQ(packet.fcs, kAbsent);
  EXPECT_EQ(packet.error, kSound);
  EXPECT_EQ(packet.link_type, kLinkRadioNoFcs);
}

TEST(WireRadioTap, AHeaderThatIsWrongIsWrittenAsItIs) {
  const std::string record = from_hex("01 00 0400 02 00 01");
  const Packet packet = of_record(record, kLinkRadioTap);
  EXPECT_EQ(packet.error, (Error{Fault::kUnexpected, 0, "WIRE-RADIO-TAP"_rule}));
  EXPECT_EQ(link_type_of(packet), kLinkRadioTap);
  std::string written;
  append_record(packet, written);
  EXPECT_EQ(written, record);
}

TEST(WireRadioTap, AFrameWithoutItsFcsOf32BitsIsAsSoundAsItWas) {
  const std::string header = from_hex("00 00 0c 00  00 00 01 00 02 00 00 00");
  const std::string frames[] = {from_hex("02 00 01 02 03 72 fd 1f 16"),
                                from_hex("02 00 01 02 03 72 fd 1f 17"),
                                from_hex("02 00 01"),
                                "\2",
                                std::string(127, 'x'),
                                std::string(128, 'x')};
  for (const std::string& frame : frames) {
    const std::string record = header + frame;
    const Packet packet = of_record(record, kLinkRadioTap);
    EXPECT_TRUE(packet.radio.more);
    std::string written;
    append_record(packet, written);
    const Packet again = of_record(written, link_type_of(packet));
    EXPECT_EQ(again.error, packet.error) << frame.size();
    EXPECT_EQ(again.bytes.size(), packet.bytes.size()) << frame.size();
  }
}

TEST(WirePcap, TimesBeyondTheFormatAreItsLast) {
  const std::string frame = from_hex("02 00 01 31 a4");
  Packet packet = of_record(frame, kLinkRadioFcs);
  const std::pair<std::int64_t, std::int64_t> kTimes[] = {
      {kNoTime, 0},
      {-1, 0},
      {1'000'000'001, 1'000'000'001},
      {4'294'967'295'999'999'999, 4'294'967'295'999'999'999},
      {4'294'967'296'000'000'000, 4'294'967'295'999'999'999},
      {INT64_MAX, 4'294'967'295'999'999'999},
  };
  for (const auto& [time_ns, wanted] : kTimes) {
    packet.time_ns = time_ns;
    PcapWriter writer(kLinkRadioFcs);
    std::string written;
    writer.begin(written);
    ASSERT_TRUE(writer.write(packet, written));
    PcapReader reader;
    EXPECT_EQ(read_all(reader, view(written)).at(0).packet.time_ns, wanted) << time_ns;
  }
}

TEST(WirePcap, DamageIsNoRecord) {
  Packet damage{.bytes = view(kTap), .error = Error{Fault::kContainer, 8, "WIRE-PCAP"_rule}};
  PcapWriter writer(0);
  std::string written;
  EXPECT_FALSE(writer.write(damage, written));
  EXPECT_EQ(written, "");
}

TEST(WireHdlcEscape, AFrameCutAfterItsFirstEscapeComesBack) {
  HdlcReader reader;
  const std::string stream = from_hex("7e 7d");
  const std::vector<Kept> got = read_all(reader, view(stream));
  ASSERT_EQ(got.size(), 1U);
  EXPECT_EQ(got[0].packet.error, (Error{Fault::kCut, 0, "WIRE-HDLC-FLAG"_rule}));
  HdlcWriter writer;
  std::string written;
  ASSERT_TRUE(writer.write(got[0].get(), written));
  EXPECT_EQ(written, stream);
}

}  // namespace
}  // namespace rubric
