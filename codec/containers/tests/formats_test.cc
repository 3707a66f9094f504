// Serial forwarder streams, radio records, hex text, detection.
#include <gtest/gtest.h>

#include <iterator>
#include <optional>

#include "codec/containers/capture_time.h"
#include "codec/containers/hex_reader.h"
#include "codec/containers/link_record.h"
#include "codec/containers/sf_reader.h"
#include "codec/containers/tests/testing.h"
#include "codec/runtime/ieee802154_fcs.h"

namespace rubric {
namespace {

using namespace testing;

struct Row {
  std::uint64_t offset;
  const char* bytes;
  Error error = kSound;
  std::uint64_t dropped = 0;
};
struct StreamCase {
  const char* name;
  const char* input;
  std::vector<Row> packets;
};

void check(const StreamCase& row, InputFormat format, const std::string& input) {
  const auto reader = make_reader(format);
  const std::vector<Kept> got = read_all(*reader, view(input));
  ASSERT_EQ(got.size(), row.packets.size()) << row.name;
  for (std::size_t i = 0; i < got.size(); ++i) {
    const Row& want = row.packets[i];
    EXPECT_EQ(got[i].packet.offset_bytes, want.offset) << row.name << ' ' << got[i];
    EXPECT_EQ(got[i].bytes, from_hex(want.bytes)) << row.name << ' ' << got[i];
    EXPECT_EQ(got[i].packet.error, want.error) << row.name << ' ' << got[i];
    EXPECT_EQ(got[i].packet.dropped_bytes, want.dropped) << row.name << ' ' << got[i];
  }
  std::mt19937 random(1);
  for (std::size_t piece_max : {1u, 2u, 5u}) {
    EXPECT_EQ(read_split(*reader, view(input), random, piece_max), got) << row.name;
  }
}

const StreamCase kSfCases[] = {
    {"Nothing", "", {}},
    {"HandshakeAlone", "55 20", {}},
    {"TwoPackets", "55 20 02 00 11 01 33", {{2, "00 11"}, {5, "33"}}},
    {"HigherVersion", "55 21 01 33", {{2, "33"}}},
    {"LowerVersion",
     "55 1f 00",
     {{0, "55 1f", {Fault::kHandshake, 1, "WIRE-SF-HANDSHAKE"_rule}},
      {0, "1f 00", {Fault::kCut, 3, "WIRE-SF-LENGTH"_rule}, 0x53}}},
    {"NoHandshake",
     "02 00 11",
     {{0, "02", {Fault::kHandshake, 0, "WIRE-SF-HANDSHAKE"_rule}}, {0, "00 11"}}},
    {"EmptyPacket",
     "55 20 00 01 33",
     {{2, "", {Fault::kEmpty, 0, "WIRE-SF-LENGTH"_rule}}, {3, "33"}}},
    {"CutInHandshake", "55", {{0, "", {Fault::kCut, 1, "WIRE-SF-HANDSHAKE"_rule}, 1}}},
    {"CutInPacket", "55 20 04 00 11", {{2, "00 11", {Fault::kCut, 3, "WIRE-SF-LENGTH"_rule}, 2}}},
    {"CutBehindLength", "55 20 04", {{2, "", {Fault::kCut, 1, "WIRE-SF-LENGTH"_rule}, 4}}},
};

TEST(WireSfLength, WhatCanBeInAStream) {
  for (const StreamCase& row : kSfCases) check(row, InputFormat::kSf, from_hex(row.input));
}

const StreamCase kHexCases[] = {
    {"Listen", "00 FF FF 00\n00 01\n", {{0, "00ffff00"}, {12, "0001"}}},
    {"Unbroken", "00ffFF00\r\n", {{0, "00ffff00"}}},
    {"Prefixed", "0x00 0XfF 0x0001", {{0, "00ff0001"}}},
    {"CommentsAndBlanks", "# a\n\n  \n\t00 11 # b\n#", {{8, "0011"}}},
    {"NoEndOfLine", "0011", {{0, "0011"}}},
    {"NoHex",
     "00 1g\n22\n",
     {{0, "3030203167", {Fault::kUnexpected, 4, "WIRE-HEX"_rule}}, {6, "22"}}},
    {"OddDigits", "001\n22", {{0, "303031", {Fault::kUnexpected, 3, "WIRE-HEX"_rule}}, {4, "22"}}},
    {"SingleDigit", "0 1", {{0, "302031", {Fault::kUnexpected, 1, "WIRE-HEX"_rule}}}},
    {"PrefixAlone", "00 0x", {{0, "3030203078", {Fault::kUnexpected, 5, "WIRE-HEX"_rule}}}},
    {"PrefixInsideAByte",
     "000x11",
     {{0, "303030783131", {Fault::kUnexpected, 3, "WIRE-HEX"_rule}}}},
};

TEST(WireHex, WhatCanBeInAText) {
  for (const StreamCase& row : kHexCases) check(row, InputFormat::kHex, row.input);
}

TEST(WireHex, LongLinesAndPackets) {
  std::string text(2 * 256, '0');
  text += '\n';
  text += std::string(3 * kHexLineMax, '1');
  text += "\n22\n";
  const auto reader = make_reader(InputFormat::kHex);
  const std::vector<Kept> got = read_all(*reader, view(text));
  ASSERT_EQ(got.size(), 3u);
  EXPECT_EQ(got[0].packet.error, (Error{Fault::kTooLong, 255, "WIRE-SF-LENGTH"_rule}));
  EXPECT_EQ(got[1].packet.error, (Error{Fault::kTooLong, kHexLineMax, "WIRE-HEX"_rule}));
  EXPECT_EQ(got[1].packet.dropped_bytes, 2 * kHexLineMax);
  EXPECT_EQ(got[2].packet.offset_bytes, 513 + 3 * kHexLineMax + 1);
  std::mt19937 random(2);
  EXPECT_EQ(read_split(*reader, view(text), random, 50'000), got);
}

TEST(WireHex, OtherFramings) {
  ReaderOptions options{
      .direction = Direction::kInbound, .interface_name = "typed", .hex_framing = Framing::kHdlc};
  auto reader = make_reader(InputFormat::kHex, options);
  const std::vector<Kept> serial = read_all(*reader, view("43 01 be 48\n"));
  ASSERT_EQ(serial.size(), 1u);
  EXPECT_EQ(serial[0].packet.kind, 0x43);
  EXPECT_EQ(serial[0].packet.error, kSound);
  EXPECT_EQ(serial[0].packet.direction, Direction::kInbound);
  EXPECT_EQ(reader->interfaces().at(0).name, "typed");
  options.hex_framing = Framing::kRadio;
  options.hex_has_fcs = true;
  reader = make_reader(InputFormat::kHex, options);
  const std::vector<Kept> radio = read_all(*reader, view("02 00 01 31 a4\n02 00 01 31 a5\n"));
  ASSERT_EQ(radio.size(), 2u);
  EXPECT_EQ(radio[0].packet.fcs, 0xa431);
  EXPECT_EQ(radio[0].packet.error, kSound);
  EXPECT_EQ(radio[1].packet.error, (Error{Fault::kFcs, 3, "WIRE-RADIO-FCS"_rule}));
}

struct RadioText {
  const char* line;
  const char* bytes;  // Null: the line is passed over.
  std::int64_t time_ms;
  std::optional<float> rssi = {};
  std::int16_t lqi = kAbsent;
  Error error = kSound;
};
const RadioText kRadioTexts[] = {
    {"received: 0200010000 power: -44 lqi: 220 time: 1500000", "020001", 1500, -44, 220},
    {"\t psdu: 020001 power: -32768 lqi: 0 time: 7000\r", "020001", 7, {}, 0},
    {"1000\t1\t-\t5: 0x02000131 A4", "020001", 1000},
    {"1000\t1\t2,3\t3: 0x020001", "020001", 1000},
    {"1000\t1\t2,3\t 15: 15.4 D 01:00|020001", nullptr, 0},
    {"received: 0000 power: -44 lqi: 220 time: 1", nullptr, 0},
    {"received: 02000 power: -44 lqi: 220 time: 1", nullptr, 0},
    {"received: 020001 power: -44 lqi: 256 time: 1", nullptr, 0},
    {"received: 020001 power: -44 lqi: 2 time: -1", nullptr, 0},
    {"psdu: 020001 power: -44 lqi: 220", nullptr, 0},
};

TEST(WireHex, WhatSniffersAndSimulatorsPrint) {
  std::string log = "booted\n";
  for (const RadioText& row : kRadioTexts) log += std::string(row.line) + "\n";
  EXPECT_EQ(detect(view(log)), InputFormat::kLog);
  const auto reader = make_reader(InputFormat::kLog);
  const std::vector<Kept> got = read_all(*reader, view(log));
  std::size_t at = 0;
  for (std::size_t i = 0; i < std::size(kRadioTexts); ++i) {
    const RadioText& row = kRadioTexts[i];
    if (row.bytes == nullptr) continue;
    ASSERT_LT(at, got.size()) << row.line;
    const Kept& one = got[at++];
    EXPECT_EQ(one.packet.framing, Framing::kRadio) << row.line;
    EXPECT_EQ(to_hex(view(one.bytes)), row.bytes) << row.line;
    EXPECT_EQ(one.packet.time_ns, row.time_ms * 1'000'000) << row.line;
    EXPECT_EQ(one.packet.radio.rssi, row.rssi) << row.line;
    EXPECT_EQ(one.packet.radio.lqi, row.lqi) << row.line;
    EXPECT_EQ(one.packet.error, row.error) << row.line;
    EXPECT_EQ(one.packet.line, i + 2) << row.line;
  }
  EXPECT_EQ(at, got.size());
  EXPECT_EQ(reader->noise().lines, 7u);
  // A size that is not that of the bytes is a mistake, not another line.
  const std::vector<Kept> wrong = read_all(*reader, view("1000\t1\t2,3\t4: 0x020001\n"));
  ASSERT_EQ(wrong.size(), 1u);
  EXPECT_EQ(wrong[0].packet.error.fault, Fault::kUnexpected);
}

TEST(WireHex, ALineThatIsCutHidesNoOthers) {
  const std::string packet = "00 ff ff 00 00 04 22 06 00 02 00 01\n";
  const std::string text = packet + "00 ff ff 0\n" + packet;
  EXPECT_EQ(detect(view(text)), InputFormat::kHex);
  const std::vector<Kept> got = read_all(*make_reader(InputFormat::kHex), view(text));
  ASSERT_EQ(got.size(), 3u);
  EXPECT_EQ(got[0].packet.error, kSound);
  EXPECT_EQ(got[1].packet.error.fault, Fault::kUnexpected);
  EXPECT_EQ(got[1].packet.line, 2u);
  EXPECT_EQ(got[2].packet.error, kSound);
  EXPECT_EQ(detect(view(std::string("add\nbad\n"))), InputFormat::kUnknown);
}

TEST(WireHex, WordsBeforeAPacketAreFound) {
  const std::string packet = "00 ff ff 00 00 04 22 06 00 02 00 01\n";
  const std::string text = "12 words\nmote INFO 2 > " + packet;
  const PrefixedLine line = find_prefixed_line(view(text));
  EXPECT_EQ(line.number, 2u);
  EXPECT_EQ(std::string(line.prefix.begin(), line.prefix.end()), "mote INFO 2 > ");
  EXPECT_EQ(find_prefixed_line(view("[12.3] " + packet + "INFO 00 ff\n")).number, 0u);
}

TEST(WireHex, LinesThatEndWithTheirFcs) {
  EXPECT_TRUE(lines_end_with_fcs(view("02 00 01 31 a4\n")));
  EXPECT_TRUE(lines_end_with_fcs(view("hello\n02 00 01 31 a4\n02 00 01 31 a5\n")));
  EXPECT_FALSE(lines_end_with_fcs(view("02 00 01 31 a4\n00 01 02\n00 01 02\n")));
  EXPECT_FALSE(lines_end_with_fcs(view("00 00\n")));
  EXPECT_FALSE(lines_end_with_fcs(view("")));
}

TEST(WireHex, RowsOfAHexDumpAreNoPackets) {
  const char* const dumps[] = {
      "0000 41 88 00 22 00 ff ff 01\n",
      "2026-01-02 03:04:05\n0000  41 88 00 22 00 ff ff 01 00 3f 07 00 00 00 00 00\n0010  41 88\n",
      "00000000: 4188 0022 00ff ff01  A..\"....\n",
  };
  for (const char* const dump : dumps) {
    EXPECT_TRUE(is_hex_dump(view(dump))) << dump;
    EXPECT_EQ(detect(view(dump)), InputFormat::kUnknown) << dump;
  }
  for (const char* const text : {"0000 01 02\n", "41881d220001000200 04 c4f5 01\n", "00 FF FF\n"}) {
    EXPECT_FALSE(is_hex_dump(view(text))) << text;
    EXPECT_EQ(detect(view(text)), InputFormat::kHex) << text;
  }
}

struct PpiCase {
  const char* record;
  std::size_t cut;  // Bytes that the capture lacks.
  std::uint64_t offset;
  const char* bytes;
  Error error = kSound;
};
TEST(WirePcap, ARecordAfterAPpiHeader) {
  const PpiCase rows[] = {
      {"0000 0800 c3000000  02 00 01 31 a4", 0, 8, "020001"},
      {"0000 0c00 e6000000  aabbccdd 02 00 01", 0, 12, "020001"},
      {"0000 0800 c3000000  02 00 01", 2, 8, "020001", {Fault::kCut, 3, ReqId::kNone}},
      {"0000 0800 c3", 0, 0, "00000800c3", {Fault::kTruncated, 5, "WIRE-PCAP"_rule}},
      {"0000 0800 c3", 9, 0, "00000800c3", {Fault::kCut, 5, ReqId::kNone}},
      {"0000 0900 c3000000", 0, 0, "00000900c3000000", {Fault::kTruncated, 8, "WIRE-PCAP"_rule}},
      {"0000 0700 c3000000", 0, 0, "00000700c3000000", {Fault::kUnexpected, 2, "WIRE-PCAP"_rule}},
      {"0000 0800 c0000000", 0, 0, "00000800c0000000", {Fault::kUnexpected, 4, "WIRE-PCAP"_rule}},
      {"0000 0800 c3000100", 0, 0, "00000800c3000100", {Fault::kUnexpected, 4, "WIRE-PCAP"_rule}},
      {"0000 0800 69000000 11", 0, 8, "11", {Fault::kUnsupported, 0, "WIRE-PCAP"_rule}},
  };
  for (const PpiCase& row : rows) {
    const std::string record = from_hex(row.record);
    Packet packet;
    decode_record(view(record), record.size() + row.cut, kLinkPpi, "WIRE-PCAP"_rule, packet);
    EXPECT_EQ(packet.offset_bytes, row.offset) << row.record;
    EXPECT_EQ(to_hex(packet.bytes), row.bytes) << row.record;
    EXPECT_EQ(packet.error, row.error) << row.record;
  }
}

TEST(WirePcap, PpiHeadersAreNotNested) {
  // 0x100C0 is PPI in its low 16 bits: each level would take stack.
  const std::string header = from_hex("0000 0800 c0000100");
  std::string record;
  for (int i = 0; i < 32 * 1024; ++i) record += header;
  Packet packet;
  decode_record(view(record), record.size(), kLinkPpi, "WIRE-PCAP"_rule, packet);
  EXPECT_EQ(packet.offset_bytes, 0U);
  EXPECT_EQ(packet.error, (Error{Fault::kUnexpected, 4, "WIRE-PCAP"_rule}));
}

TEST(WirePcap, APpiHeaderLongerThanTheStatedRecord) {
  const std::string record = from_hex("0000 0800 c3000000  02 00 01 31 a4");
  Packet packet;
  decode_record(view(record), 4, kLinkPpi, "WIRE-PCAP"_rule, packet);
  EXPECT_EQ(packet.dropped_bytes, 0U);
  EXPECT_EQ(packet.error, kSound);
}

struct RadioCase {
  const char* name;
  std::uint16_t link_type;
  const char* record;
  std::uint64_t offset;
  const char* bytes;
  int fcs;
  Error error = kSound;
};
// A record whose bytes are kept as they are, with an error.
RadioCase refused(const char* name, std::uint16_t link_type, const char* record, Fault fault,
                  std::uint32_t offset, ReqId rule) {
  return {name, link_type, record, 0, record, kAbsent, {fault, offset, rule}};
}
constexpr Error kWrongFcs{Fault::kFcs, 3, "WIRE-RADIO-FCS"_rule};
const RadioCase kRadioCases[] = {
    {"WithFcs", 195, "02 00 01 31 a4", 0, "02 00 01", 0xa431},
    {"WrongFcs", 195, "02 00 01 31 a5", 0, "02 00 01", 0xa531, kWrongFcs},
    refused("NoRoomForFcs", 195, "02", Fault::kTooShort, 1, "WIRE-RADIO-FCS"_rule),
    refused("Empty", 195, "", Fault::kEmpty, 0, "WIRE-RADIO-HEADER"_rule),
    {"NoFcs", 230, "02 00 01", 0, "02 00 01", kAbsent},
    refused("NoFcsEmpty", 230, "", Fault::kEmpty, 0, "WIRE-RADIO-HEADER"_rule),
    {"TapFcs16", 283, "00 00 0c 00  00 00 01 00 01 00 00 00  02 00 01 31 a4", 12, "02 00 01",
     0xa431},
    {"TapWrongFcs16", 283, "00 00 0c 00  00 00 01 00 01 00 00 00  02 00 01 31 a5", 12, "02 00 01",
     0xa531, kWrongFcs},
    {"TapNoFcs", 283, "00 00 0c 00  00 00 01 00 00 00 00 00  02 00 01", 12, "02 00 01", kAbsent,
     kSound},
    {"TapOtherField", 283,
     "00 00 14 00  01 00 04 00 00 00 00 c2  00 00 01 00 01 00 00 00  02 00 01 31 a4", 20,
     "02 00 01", 0xa431},
    {"TapUnpaddedLast", 283, "00 00 09 00  00 00 01 00 01  02 00 01 31 a4", 9, "02 00 01", 0xa431,
     kSound},
    {"TapNoFields", 283, "00 00 04 00  02 00 01", 4, "02 00 01", kAbsent},
    // zlib.crc32(bytes.fromhex("0200010203")), and of 3 bytes without and with the zero behind.
    {"TapFcs32", 283, "00 00 0c 00  00 00 01 00 02 00 00 00  02 00 01 02 03 72 fd 1f 16", 12,
     "02 00 01 02 03", kAbsent},
    {"TapFcs32Short", 283, "00 00 0c 00  00 00 01 00 02 00 00 00  02 00 01 ea 3d c2 8b", 12,
     "02 00 01", kAbsent},
    {"TapFcs32Padded", 283, "00 00 0c 00  00 00 01 00 02 00 00 00  02 00 01 d6 26 56 92", 12,
     "02 00 01", kAbsent},
    {"TapWrongFcs32", 283, "00 00 0c 00  00 00 01 00 02 00 00 00  02 00 01 ea 3d c2 8a", 12,
     "02 00 01", kAbsent, kWrongFcs},
    {"TapNoRoomForFcs32", 283, "00 00 0c 00  00 00 01 00 02 00 00 00  02 00 01", 12, "02 00 01",
     kAbsent, kWrongFcs},
    refused("TapFcsUnknown", 283, "00 00 0c 00  00 00 01 00 03 00 00 00", Fault::kUnexpected, 8,
            "WIRE-RADIO-TAP"_rule),
    refused("TapFcsWithoutValue", 283, "00 00 08 00  00 00 00 00", Fault::kTruncated, 4,
            "WIRE-RADIO-TAP"_rule),
    refused("TapTooShort", 283, "00 00 04", Fault::kTruncated, 3, "WIRE-RADIO-TAP"_rule),
    refused("TapVersion", 283, "01 00 04 00", Fault::kUnexpected, 0, "WIRE-RADIO-TAP"_rule),
    refused("TapLengthBelowHeader", 283, "00 00 03 00", Fault::kOutOfRange, 2,
            "WIRE-RADIO-TAP"_rule),
    refused("TapLengthBeyondRecord", 283, "00 00 05 00", Fault::kOutOfRange, 2,
            "WIRE-RADIO-TAP"_rule),
    refused("TapHalfField", 283, "00 00 06 00 00 00", Fault::kTruncated, 4, "WIRE-RADIO-TAP"_rule),
    refused("TapFieldBeyondHeader", 283, "00 00 08 00 01 00 04 00", Fault::kTruncated, 4,
            "WIRE-RADIO-TAP"_rule),
};

TEST(WireRadioFcs, WhatARecordCanBe) {
  for (const RadioCase& row : kRadioCases) {
    const std::string record = from_hex(row.record);
    Packet packet;
    decode_radio_record(view(record), row.link_type, packet);
    EXPECT_EQ(packet.framing, Framing::kRadio) << row.name;
    EXPECT_EQ(packet.offset_bytes, row.offset) << row.name;
    EXPECT_EQ(to_hex(packet.bytes), to_hex(view(from_hex(row.bytes)))) << row.name;
    EXPECT_EQ(packet.fcs, row.fcs) << row.name;
    EXPECT_EQ(packet.error, row.error) << row.name;
  }
}

TEST(WireRadioTap, NoFrameIsMadeOfAHeaderThatTheCaptureCut) {
  const std::string record = from_hex("00 00 0c 00  00 00 01 00 01 00 00 00  02 00 01 31 a4");
  Packet packet;
  for (std::size_t kept = 1; kept < record.size(); ++kept) {
    decode_record(view(record).first(kept), record.size(), 283, "WIRE-PCAP"_rule, packet);
    EXPECT_EQ(packet.error.fault, Fault::kCut) << kept;
    EXPECT_EQ(packet.framing, kept < 12 ? Framing::kBare : Framing::kRadio) << kept;
    EXPECT_EQ(packet.bytes.size(), kept < 12 ? kept : kept - 12) << kept;
  }
}

TEST(WireRadioLength, AtMost127BytesWithFcs) {
  std::string frame(125, '\x11');
  const std::uint16_t sum = fcs(view(frame));
  Packet packet;
  decode_radio_record(view(frame), 230, packet);
  EXPECT_EQ(packet.error, kSound);
  frame += static_cast<char>(sum & 0xFF);
  frame += static_cast<char>(sum >> 8);
  decode_radio_record(view(frame), 195, packet);
  EXPECT_EQ(packet.error, kSound);
  decode_radio_record(view(frame), 230, packet);
  EXPECT_EQ(packet.error, (Error{Fault::kTooLong, 125, "WIRE-RADIO-LENGTH"_rule}));
  frame += '\0';
  decode_radio_record(view(frame), 195, packet);
  EXPECT_EQ(packet.error, (Error{Fault::kTooLong, 127, "WIRE-RADIO-LENGTH"_rule}));
}

TEST(WirePcapng, Times) {
  EXPECT_EQ(ticks_of_resolution(6), 1'000'000u);
  EXPECT_EQ(ticks_of_resolution(0), 1u);
  EXPECT_EQ(ticks_of_resolution(19), 10'000'000'000'000'000'000u);
  EXPECT_EQ(ticks_of_resolution(20), 0u);
  EXPECT_EQ(ticks_of_resolution(0x80 | 10), 1024u);
  EXPECT_EQ(ticks_of_resolution(0x80 | 63), std::uint64_t{1} << 63);
  EXPECT_EQ(ticks_of_resolution(0xC0), 0u);
  Interface interface;
  EXPECT_EQ(time_ns_of_ticks(1'500'000, interface), 1'500'000'000);
  interface.offset_seconds = -2;
  EXPECT_EQ(time_ns_of_ticks(1'500'000, interface), -500'000'000);
  interface = {};
  interface.ticks_per_second = 1024;
  EXPECT_EQ(time_ns_of_ticks(500, interface), 488'281'250);
  interface.ticks_per_second = std::uint64_t{1} << 63;
  EXPECT_EQ(time_ns_of_ticks(UINT64_MAX, interface), 1'999'999'999);
  interface.ticks_per_second = 1;
  EXPECT_EQ(time_ns_of_ticks(UINT64_MAX, interface), kNoTime);
  interface.ticks_per_second = 0;
  EXPECT_EQ(time_ns_of_ticks(1, interface), kNoTime);
}

TEST(Writers, TakeWhatTheyCanHold) {
  const std::string ack_packet = from_hex("00 ff ff 00 00 03 00 25 63 00 0c");
  Packet sf{.framing = Framing::kSf, .bytes = view(ack_packet)};
  Packet serial_ack{.framing = Framing::kHdlc, .kind = 0x43, .serial_seq = 1, .crc = 0x48be};
  Packet radio{.framing = Framing::kRadio, .bytes = view(ack_packet)};
  Packet bad = sf;
  bad.error = Error{Fault::kUnexpected, 0, "WIRE-HEX"_rule};
  const struct {
    InputFormat format;
    bool takes[4];  // In the order of `packets`.
  } rows[] = {
      {InputFormat::kHdlc, {true, true, false, true}},
      {InputFormat::kSf, {true, false, false, false}},
      {InputFormat::kPcap, {false, false, true, false}},
      {InputFormat::kPcapng, {true, true, true, true}},
      {InputFormat::kHex, {true, false, true, false}},
  };
  const Packet packets[] = {sf, serial_ack, radio, bad};
  for (const auto& row : rows) {
    const auto writer = make_writer(row.format, kLinkRadioNoFcs);
    std::string out;
    writer->begin(out);
    for (std::size_t i = 0; i < 4; ++i) {
      const std::size_t size = out.size();
      EXPECT_EQ(writer->write(packets[i], out), row.takes[i]) << static_cast<int>(row.format) << i;
      EXPECT_EQ(out.size() > size, row.takes[i]);
    }
  }
  EXPECT_EQ(make_writer(InputFormat::kJsonl), nullptr);
  std::string text;
  HexWriter().write(sf, text);
  HexWriter(false).write(sf, text);
  EXPECT_EQ(text, "00 FF FF 00 00 03 00 25 63 00 0C\n00 ff ff 00 00 03 00 25 63 00 0c\n");
  std::string frame;
  HdlcWriter().write(sf, frame);
  EXPECT_EQ(to_hex(view(frame.substr(0, 3))), "7e4500");
  const auto reader = make_reader(InputFormat::kHdlc);
  EXPECT_EQ(read_all(*reader, view(frame)).at(0).bytes, ack_packet);
}

// A packet may begin with a flag's byte: its line is refused if it would read as a serial line's.
TEST(Writers, HexLinesReadBackAsPackets) {
  const struct {
    const char* bytes;
    bool taken;
  } rows[] = {
      {"7e 10 00 01 02 03 04 05 06", true},
      {"7e 45 00 01 02 03 04 05 06", false},
      {"7e", false},
      {"12 34 56 78 9a bc de f0", true},  // No time of day.
  };
  for (const auto& row : rows) {
    const std::string bytes = from_hex(row.bytes);
    Packet packet{.framing = Framing::kSf, .bytes = view(bytes)};
    std::string text;
    EXPECT_EQ(HexWriter().write(packet, text), row.taken) << row.bytes;
    ReaderOptions options{.hex_framing = Framing::kSf};
    HexReader reader(options);
    const std::vector<Kept> again = read_all(reader, view(text));
    ASSERT_EQ(again.size(), row.taken ? 1U : 0U) << row.bytes;
    if (row.taken) {
      EXPECT_EQ(again[0].bytes, bytes);
    }
  }
}

struct DetectCase {
  const char* name;
  std::string input;
  InputFormat format;
};

TEST(Detect, ByContent) {
  const std::string ack = from_hex("7e 43 01 be 48 7e");
  const DetectCase cases[] = {
      {"Nothing", "", InputFormat::kUnknown},
      {"Pcapng", from_hex("0a0d0d0a 1c000000 4d3c2b1a"), InputFormat::kPcapng},
      {"PcapLittle", from_hex("d4c3b2a1 0200"), InputFormat::kPcap},
      {"PcapBig", from_hex("a1b2c3d4 0002"), InputFormat::kPcap},
      {"PcapNanoLittle", from_hex("4d3cb2a1"), InputFormat::kPcap},
      {"PcapNanoBig", from_hex("a1b23c4d"), InputFormat::kPcap},
      {"Sf", from_hex("55 20 01 33"), InputFormat::kSf},
      {"SfHandshake", from_hex("55 20"), InputFormat::kSf},
      {"Jsonl", " \n{\"t_us\":1}", InputFormat::kJsonl},
      {"HexListen", "00 FF FF 00 00\n00 FF", InputFormat::kHex},
      {"HexUnbroken", "00ffff0000\n", InputFormat::kHex},
      {"HexCutInAByte", "00 FF\n00 F", InputFormat::kHex},
      {"HexComment", "# captured on Monday\n", InputFormat::kHex},
      {"Text", "hello\nworld\n", InputFormat::kUnknown},
      {"Hdlc", ack, InputFormat::kHdlc},
      {"HdlcFromTheMiddle", from_hex("00 11 22 be 48 7e") + ack, InputFormat::kHdlc},
      {"HdlcFirstFrameUnended", from_hex("7e 45 00 ff ff 00"), InputFormat::kHdlc},
      {"Noise", from_hex("00 11 22 33 7e 99 88 77 7e"), InputFormat::kUnknown},
      {"Blank", "  \n\n", InputFormat::kUnknown},
  };
  for (const DetectCase& row : cases) EXPECT_EQ(detect(view(row.input)), row.format) << row.name;
  EXPECT_EQ(make_reader(InputFormat::kUnknown), nullptr);
  EXPECT_EQ(make_reader(InputFormat::kJsonl), nullptr);
}

}  // namespace
}  // namespace rubric
