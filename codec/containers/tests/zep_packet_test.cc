// tshark_zep_test compares the same layout with Wireshark's dissector.
#include "codec/containers/zep_packet.h"

#include <gtest/gtest.h>

#include <vector>

#include "codec/containers/crc16_fast.h"
#include "codec/containers/link_record.h"
#include "codec/runtime/crc16.h"

namespace rubric {
namespace {

std::vector<std::uint8_t> frame_with_fcs() {
  std::vector<std::uint8_t> out = {0x41, 0x88, 7, 0x22, 0, 0xFF, 0xFF, 2, 0, 0x3F, 3, 1};
  const std::uint16_t fcs = fcs_fast(Bytes(out.data(), out.size()));
  out.push_back(static_cast<std::uint8_t>(fcs));
  out.push_back(static_cast<std::uint8_t>(fcs >> 8));
  return out;
}

Bytes as_bytes(const std::string& text) {
  return Bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
}

std::string sound_datagram(std::int64_t time_ns = 1'700'000'000'123'456'789) {
  static const std::vector<std::uint8_t> frame = frame_with_fcs();
  ZepPacket zep{.channel = 17,
                .device = 0x0102,
                .lqi = 200,
                .time_ns = time_ns,
                .sequence = 0x01020304,
                .frame = Bytes(frame.data(), frame.size())};
  std::string out;
  append_zep(zep, out);
  return out;
}

TEST(Zep, VersionTwoHasItsFieldsAtTheirPlaces) {
  const std::string datagram = sound_datagram();
  ASSERT_EQ(datagram.size(), 32 + 14);
  EXPECT_EQ(datagram.substr(0, 9), std::string("EX\2\1\x11\1\2\1\xC8", 9));
  EXPECT_EQ(datagram.substr(17, 4), "\1\2\3\4");
  EXPECT_EQ(datagram[31], 14);
  const auto zep = parse_zep(as_bytes(datagram));
  ASSERT_TRUE(zep);
  EXPECT_EQ(zep->channel, 17);
  EXPECT_EQ(zep->device, 0x0102);
  EXPECT_EQ(zep->lqi, 200);
  EXPECT_EQ(zep->sequence, 0x01020304u);
  EXPECT_EQ(zep->time_ns, 1'700'000'000'123'456'789);
}

TEST(Zep, TimesAreKeptToTheNanosecond) {
  for (const std::int64_t time_ns :
       {std::int64_t{0}, std::int64_t{1}, std::int64_t{1'999'999'999}, kNoTime,
        std::int64_t{2'085'978'496'000'000'001}, std::int64_t{4'000'000'000'999'999'999}}) {
    const std::string datagram = sound_datagram(time_ns);
    EXPECT_EQ(parse_zep(as_bytes(datagram))->time_ns, time_ns);
  }
}

TEST(Zep, EveryCutIsTruncated) {
  const std::string datagram = sound_datagram();
  for (std::size_t size = 0; size < datagram.size(); ++size) {
    const auto zep = parse_zep(as_bytes(datagram).first(size));
    EXPECT_EQ(zep.error().fault, Fault::kTruncated) << size;
    EXPECT_EQ(zep.error().offset_bytes, size);
  }
}

TEST(Zep, WhatIsNotZepIsRefused) {
  for (const std::size_t at : {0u, 1u, 2u}) {
    std::string datagram = sound_datagram();
    datagram[at] = 9;
    Packet packet;
    ASSERT_TRUE(decode_zep_datagram(as_bytes(datagram), packet));
    EXPECT_EQ(packet.error, fail(Fault::kUnexpected, at, "WIRE-ZEP"_rule).error);
  }
}

TEST(Zep, AFrameIsReadWithItsFcs) {
  std::string datagram = sound_datagram();
  Packet packet;
  ASSERT_TRUE(decode_zep_datagram(as_bytes(datagram), packet));
  EXPECT_EQ(packet.error.fault, Fault::kNone);
  EXPECT_EQ(packet.bytes.size(), 12u);
  EXPECT_EQ(packet.offset_bytes, 32u);
  datagram.back() ^= 1;
  ASSERT_TRUE(decode_zep_datagram(as_bytes(datagram), packet));
  EXPECT_EQ(packet.error.fault, Fault::kFcs);
}

TEST(Zep, TheCheckSumOfRiotsNativeBoardsIsNoFcs) {
  std::string datagram = sound_datagram();
  const std::size_t end = datagram.size() - 2;
  const std::uint16_t sum = crc16(as_bytes(datagram).first(end).from(32));
  store_le16(reinterpret_cast<std::uint8_t*>(datagram.data()) + end, sum);
  Packet packet;
  ASSERT_TRUE(decode_zep_datagram(as_bytes(datagram), packet));
  EXPECT_EQ(packet.error.fault, Fault::kNone);
  EXPECT_EQ(packet.fcs, kAbsent);
  EXPECT_EQ(packet.bytes.size(), 12u);
}

// With CRC mode 0 the last bytes are RSSI, and the chip's verdict of the check sum.
TEST(Zep, AChipsVerdictStandsForTheFcs) {
  std::string datagram = sound_datagram();
  datagram[7] = 0;
  for (const bool ok : {true, false}) {
    datagram.back() = static_cast<char>(ok ? 0xEB : 0x6B);
    Packet packet;
    ASSERT_TRUE(decode_zep_datagram(as_bytes(datagram), packet));
    EXPECT_EQ(packet.error.fault, ok ? Fault::kNone : Fault::kFcs);
    EXPECT_EQ(packet.fcs, kAbsent);
    EXPECT_EQ(packet.bytes.size(), 12u);
  }
}

TEST(Zep, VersionOneHasAShorterHeader) {
  const std::string two = sound_datagram();
  std::string one = "EX\1" + two.substr(4, 5) + std::string(7, '\0') + two.substr(31);
  const auto zep = parse_zep(as_bytes(one));
  ASSERT_TRUE(zep);
  EXPECT_EQ(zep->channel, 17);
  EXPECT_EQ(zep->device, 0x0102);
  EXPECT_EQ(zep->frame_offset_bytes, 16u);
  Packet packet;
  ASSERT_TRUE(decode_zep_datagram(as_bytes(one), packet));
  EXPECT_EQ(packet.error.fault, Fault::kNone);
}

TEST(Zep, AnAckCarriesNoFrame) {
  ZepPacket ack{.type = ZepPacket::Type::kAck, .sequence = 77};
  std::string datagram;
  append_zep(ack, datagram);
  EXPECT_EQ(datagram, std::string("EX\2\2\0\0\0\x4D", 8));
  EXPECT_EQ(parse_zep(as_bytes(datagram))->sequence, 77u);
  Packet packet;
  EXPECT_FALSE(decode_zep_datagram(as_bytes(datagram), packet));
}

TEST(Zep, AHelloCarriesAnAddress) {
  std::string datagram = sound_datagram();
  datagram[3] = '\xFF';
  Packet packet;
  EXPECT_FALSE(decode_zep_datagram(as_bytes(datagram), packet));
}

std::string big16(std::size_t value) {
  return {static_cast<char>(value >> 8), static_cast<char>(value)};
}

std::string udp(const std::string& datagram, std::uint16_t port = kZepPort) {
  return big16(40000) + big16(port) + big16(8 + datagram.size()) + big16(0) + datagram;
}

std::string ipv4(const std::string& payload, std::uint16_t fragment = 0) {
  return std::string("\x45\0", 2) + big16(20 + payload.size()) + big16(1) + big16(fragment) +
         "\x40\x11" + big16(0) + "\x7f\1\1\1\x7f\1\1\1" + payload;
}

std::string ipv6(const std::string& payload, bool option) {
  const std::string hop = option ? std::string("\x11\0\1\4\0\0\0\0", 8) : "";
  return std::string("\x60\0\0\0", 4) + big16(hop.size() + payload.size()) +
         std::string(1, option ? '\0' : '\x11') + "\x40" + std::string(32, '\1') + hop + payload;
}

TEST(ZepOverUdp, IsFoundBehindEveryLinkHeader) {
  const std::string v4 = ipv4(udp(sound_datagram()));
  const std::string macs(12, '\2');
  const struct {
    std::uint16_t link_type;
    std::string record;
  } kRecords[] = {
      {kLinkRawIp, v4},
      {kLinkIpv4, v4},
      {kLinkIpv6, ipv6(udp(sound_datagram()), false)},
      {kLinkRawIp, ipv6(udp(sound_datagram()), true)},
      {kLinkEthernet, macs + "\x08" + std::string(1, '\0') + v4 + "padding"},
      {kLinkEthernet, macs + "\x81" + std::string("\0\0\5\x08\0", 5) + v4},
      {kLinkSll, std::string(14, '\0') + std::string("\x08\0", 2) + v4},
      {kLinkSll2, std::string("\x08\0", 2) + std::string(18, '\0') + v4},
      {kLinkNull, std::string("\2\0\0\0", 4) + v4},
      {kLinkLoop, std::string("\0\0\0\x1E", 4) + ipv6(udp(sound_datagram()), false)},
      {kLinkRawIp, ipv4(udp(sound_datagram(), 17755))},
  };
  for (const auto& row : kRecords) {
    Packet packet{.time_ns = 5};
    decode_record(as_bytes(row.record), row.record.size(), row.link_type, "WIRE-PCAP"_rule, packet);
    EXPECT_EQ(packet.error.fault, Fault::kNone) << row.link_type;
    EXPECT_EQ(packet.framing, Framing::kRadio);
    EXPECT_EQ(packet.bytes.size(), 12u);
    EXPECT_EQ(packet.time_ns, 5);
    EXPECT_EQ(packet.radio.channel, 17);
    EXPECT_EQ(packet.radio.lqi, 200);
    EXPECT_EQ(packet.link_type, kLinkRadioTap);
    EXPECT_EQ(row.record[packet.offset_bytes], 0x41);
    // However much of it was captured: cut, or nothing for us.
    for (std::size_t size = 0; size < row.record.size(); ++size) {
      Packet part;
      decode_record(as_bytes(row.record).first(size), row.record.size(), row.link_type,
                    "WIRE-PCAP"_rule, part);
      const bool whole = row.record.ends_with("padding") && size + 7 >= row.record.size();
      const Fault fault = part.error.fault;
      EXPECT_EQ(fault == Fault::kNone, whole) << row.link_type << ' ' << size;
      EXPECT_TRUE(whole || fault == Fault::kCut || fault == Fault::kUnsupported);
      EXPECT_LE(part.offset_bytes + part.bytes.size(), size);
    }
  }
}

TEST(ZepOverUdp, WhatIsNoneIsLeftAlone) {
  const std::string datagram = sound_datagram();
  std::string tcp = ipv4(udp(datagram));
  tcp[9] = 6;
  for (const std::string& record :
       {ipv4(udp("query", 53)), ipv4(udp(datagram), 0x2000), ipv4(udp(datagram), 3), tcp,
        std::string("\x45"), std::string()}) {
    Packet packet;
    decode_record(as_bytes(record), record.size(), kLinkRawIp, "WIRE-PCAP"_rule, packet);
    EXPECT_EQ(packet.error, fail(Fault::kUnsupported, 0, "WIRE-PCAP"_rule).error);
    EXPECT_EQ(packet.link_type, kLinkRawIp);
    EXPECT_EQ(packet.offset_bytes, 0u);
  }
}

// On another port all of the datagram has to be a ZEP packet.
TEST(ZepOverUdp, OnOtherPortsIsFoundByItsForm) {
  std::string cut = sound_datagram();
  cut.pop_back();
  std::string kind = sound_datagram();
  kind[3] = 9;
  for (const std::string& datagram : {cut, kind, sound_datagram() + "x", std::string("EX\2\2")}) {
    const std::string record = ipv4(udp(datagram, 17755));
    Packet packet;
    decode_record(as_bytes(record), record.size(), kLinkRawIp, "WIRE-PCAP"_rule, packet);
    EXPECT_EQ(packet.error, fail(Fault::kUnsupported, 0, "WIRE-PCAP"_rule).error);
    EXPECT_EQ(packet.link_type, kLinkRawIp);
  }
}

TEST(ZepOverUdp, APacketWithoutFrameIsNamed) {
  std::string hello = sound_datagram();
  hello[3] = '\xFF';
  for (const std::uint16_t port : {kZepPort, std::uint16_t{17755}}) {
    for (const auto& [datagram, kind] : {std::pair(std::string("EX\2\2\0\0\0\1", 8), kLinkZepAck),
                                         std::pair(hello, kLinkZepHello)}) {
      const std::string record = std::string(4, '\0') + ipv4(udp(datagram, port));
      Packet packet;
      decode_record(as_bytes(record), record.size(), kLinkNull, "WIRE-PCAP"_rule, packet);
      EXPECT_EQ(packet.error, fail(Fault::kUnsupported, 0, "WIRE-PCAP"_rule).error);
      EXPECT_EQ(packet.framing, Framing::kBare);
      EXPECT_EQ(packet.link_type, kind);
    }
  }
}

}  // namespace
}  // namespace rubric
