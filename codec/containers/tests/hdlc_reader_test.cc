#include "codec/containers/hdlc_reader.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "codec/containers/serial_frame.h"
#include "codec/containers/tests/testing.h"
#include "codec/runtime/hdlc.h"

namespace rubric {
namespace {

using namespace testing;

struct Expected {
  std::uint64_t offset;
  int kind;
  int seq;
  const char* bytes;
  int crc;
  Error error;
};
struct Case {
  const char* name;
  const char* stream;
  std::vector<Expected> packets;
};

const Expected kAck1{1, 0x43, 1, "", 0x48be, kSound};
const Case kCases[] = {
    {"Nothing", "", {}},
    {"IdleLine", "7e 7e 7e", {}},
    {"OneAck", "7e 43 01 be 48 7e", {kAck1}},
    {"NoOpeningFlag", "43 01 be 48 7e", {{0, 0x43, 1, "", 0x48be, kSound}}},
    {"SharedFlag", "7e 43 01 be 48 7e 43 00 9f 58 7e", {kAck1, {6, 0x43, 0, "", 0x589f, kSound}}},
    {"ManyFlags",
     "7e 7e 7e 43 01 be 48 7e 7e 7e 43 00 9f 58 7e 7e",
     {{3, 0x43, 1, "", 0x48be, kSound}, {10, 0x43, 0, "", 0x589f, kSound}}},
    {"GarbageInFront",
     "00 11 22 33 7e 43 01 be 48 7e",
     {{0, 0, kAbsent, "11", 0x3322, {Fault::kCrc, 2, "WIRE-SERIAL-CRC"_rule}},
      {5, 0x43, 1, "", 0x48be, kSound}}},
    {"WrongCrc",
     "7e 43 01 be 49 7e 43 00 9f 58 7e",
     {{1, 0x43, 1, "", 0x49be, {Fault::kCrc, 2, "WIRE-SERIAL-CRC"_rule}},
      {6, 0x43, 0, "", 0x589f, kSound}}},
    {"OneByte",
     "7e 45 7e",
     {{1, 0x45, kAbsent, "", kAbsent, {Fault::kTooShort, 1, "WIRE-HDLC-SHORT"_rule}}}},
    {"TwoBytes",
     "7e 45 99 7e",
     {{1, 0x45, kAbsent, "99", kAbsent, {Fault::kTooShort, 2, "WIRE-HDLC-SHORT"_rule}}}},
    {"TwoBytesWithSeq",
     "7e 44 99 7e",
     {{1, 0x44, 0x99, "", kAbsent, {Fault::kTooShort, 2, "WIRE-HDLC-SHORT"_rule}}}},
    {"ThreeBytes",
     "7e 44 12 34 7e",
     {{1, 0x44, kAbsent, "", 0x3412, {Fault::kTooShort, 3, "WIRE-HDLC-SHORT"_rule}}}},
    {"Aborted",
     "7e 43 01 be 48 7d 7e 43 00 9f 58 7e",
     {{1, 0x43, 1, "", 0x48be, {Fault::kAborted, 4, "WIRE-HDLC-ESCAPE"_rule}},
      {7, 0x43, 0, "", 0x589f, kSound}}},
    {"AbortedAtOnce",
     "7e 7d 7e",
     {{1, kAbsent, kAbsent, "", kAbsent, {Fault::kAborted, 0, "WIRE-HDLC-ESCAPE"_rule}}}},
    {"EscapedEscapeIsNoAbort",
     "7e 45 7d 7d 7e",
     {{1, 0x45, kAbsent, "5d", kAbsent, {Fault::kTooShort, 2, "WIRE-HDLC-SHORT"_rule}}}},
    {"UnknownKind",
     "7e 99 01 02 f5 6f 7e",
     {{1, 0x99, kAbsent, "0102", 0x6ff5, {Fault::kCrc, 3, "WIRE-SERIAL-CRC"_rule}}}},
    {"Cut",
     "7e 43 01 be",
     {{1, 0x43, kAbsent, "", 0xbe01, {Fault::kCut, 3, "WIRE-HDLC-FLAG"_rule}}}},
    {"CutBeforeItsFlag",
     "7e 43 01 be 48",
     {{1, 0x43, 1, "", 0x48be, {Fault::kCut, 4, "WIRE-HDLC-FLAG"_rule}}}},
    {"CutInAnEscape",
     "7e 43 01 7d",
     {{1, 0x43, 1, "", kAbsent, {Fault::kCut, 2, "WIRE-HDLC-FLAG"_rule}}}},
};

TEST(WireHdlcFlag, WhatCanBeOnTheLine) {
  for (const Case& row : kCases) {
    const std::string stream = from_hex(row.stream);
    for (CpuPath path : kPaths) {
      if (!cpu_has(path)) continue;
      HdlcReader reader({}, path);
      const std::vector<Kept> got = read_all(reader, view(stream));
      ASSERT_EQ(got.size(), row.packets.size()) << row.name;
      for (std::size_t i = 0; i < got.size(); ++i) {
        Packet want;
        const Expected& e = row.packets[i];
        const std::string bytes = from_hex(e.bytes);
        want.framing = Framing::kHdlc;
        want.offset_bytes = e.offset;
        want.kind = e.kind;
        want.serial_seq = e.seq;
        want.bytes = view(bytes);
        want.crc = e.crc;
        want.error = e.error;
        EXPECT_EQ(got[i], Kept(want)) << row.name;
      }
    }
  }
}

std::string framed(const std::string& content) {
  std::string out(hdlc_frame_room(content.size() + 2), '\0');
  HdlcFramer framer(MutableBytes(reinterpret_cast<std::uint8_t*>(out.data()), out.size()));
  framer.open();
  framer.put(view(content));
  out.resize(*framer.close());
  return out;
}

TEST(WireHdlcEscape, EveryContentLengthBackToBackOnEveryPath) {
  std::mt19937 random(7);
  std::string stream;
  std::vector<std::string> contents;
  for (std::size_t size = 2; size <= 253; ++size) {
    for (unsigned special : {0u, 64u, 4u}) {  // One byte in `special` needs an escape.
      std::string content(size, '\0');
      for (char& c : content) {
        c = static_cast<char>(random());
        if (special == 0 && (c == 0x7D || c == 0x7E)) c = 0;
        if (special != 0 && random() % special == 0) c = static_cast<char>(0x7D + random() % 2);
      }
      content[0] = 0x45;
      contents.push_back(content);
      stream += framed(content);
    }
  }
  for (CpuPath path : kPaths) {
    if (!cpu_has(path)) continue;
    HdlcReader reader({}, path);
    const std::vector<Kept> got = read_all(reader, view(stream));
    ASSERT_EQ(got.size(), contents.size());
    for (std::size_t i = 0; i < got.size(); ++i) {
      EXPECT_EQ(got[i].packet.error, kSound);
      EXPECT_EQ('\x45' + got[i].bytes, contents[i]);
    }
    for (std::size_t piece_max : {1u, 7u, 100u, 5000u}) {
      EXPECT_EQ(read_split(reader, view(stream), random, piece_max), got);
    }
  }
}

TEST(WireHdlcLong, LimitsOfLength) {
  const auto one = [](const std::string& stream) {
    HdlcReader reader;
    const std::vector<Kept> got = read_all(reader, view(stream));
    EXPECT_EQ(got.size(), 1u);
    return got.at(0);
  };
  EXPECT_EQ(one(framed(std::string(253, '\x45'))).packet.error, kSound);
  EXPECT_EQ(one(framed(std::string(254, '\x45'))).packet.error,
            (Error{Fault::kTooLong, 255, "WIRE-HDLC-LONG"_rule}));
  EXPECT_EQ(one(framed(std::string(254, '\x44'))).packet.error, kSound);
  EXPECT_EQ(one(framed(std::string(255, '\x44'))).packet.error,
            (Error{Fault::kTooLong, 256, "WIRE-HDLC-LONG"_rule}));
  // Longer than the kept part, with and without escapes; the next frame is found.
  for (const char* filler : {"\x11", "\x7d\x31"}) {
    std::string stream = "\x7e";
    for (std::size_t i = 0; i < 100'000; ++i) stream += filler;
    stream += from_hex("7e 43 01 be 48 7e");
    HdlcReader reader;
    const std::vector<Kept> got = read_all(reader, view(stream));
    ASSERT_EQ(got.size(), 2u);
    EXPECT_EQ(got[0].packet.error, (Error{Fault::kTooLong, 255, "WIRE-HDLC-LONG"_rule}));
    EXPECT_EQ(got[0].packet.crc, kAbsent);
    EXPECT_EQ(1 + got[0].bytes.size(), kHdlcKeptMax);  // With its kind.
    EXPECT_EQ(got[0].packet.dropped_bytes, 100'000 - kHdlcKeptMax);
    EXPECT_EQ(got[1].packet.error, kSound);
    std::mt19937 random(3);
    EXPECT_EQ(read_split(reader, view(stream), random, 9000), got);
  }
}

// Expects reader(writer(packet)) == packet, for malformed ones too.
void comes_back(const std::string& content, const std::string& stream) {
  HdlcReader reader;
  const std::vector<Kept> first = read_all(reader, view(stream));
  RC_ASSERT(first.size() == 1u);
  std::string rebuilt_content;
  append_serial_content(first[0].get(), rebuilt_content);
  RC_ASSERT(rebuilt_content == content);
  std::string rebuilt;
  HdlcWriter writer;
  RC_ASSERT(writer.write(first[0].get(), rebuilt));
  RC_ASSERT(rebuilt == stream);
  RC_ASSERT(read_all(reader, view(rebuilt)) == first);
}

std::string escaped(const std::string& content) {
  std::string out = "\x7e";
  for (char c : content) {
    if (c == 0x7D || c == 0x7E) {
      out += '\x7d';
      c ^= 0x20;
    }
    out += c;
  }
  return out;
}

RC_GTEST_PROP(WireHdlcEscape, RebuildIsTheInverse, ()) {
  const auto size = *rc::gen::inRange<std::size_t>(1, 301);
  auto content = *rc::gen::container<std::string>(
      size, rc::gen::oneOf(rc::gen::arbitrary<char>(), rc::gen::element('\x7d', '\x7e', '\x5d')));
  if (*rc::gen::arbitrary<bool>()) content[0] = *rc::gen::element('\x43', '\x44', '\x45');
  comes_back(content, escaped(content) + "\x7e");
  comes_back(content, escaped(content) + "\x7d\x7e");
  comes_back(content, escaped(content));
}

RC_GTEST_PROP(WireHdlcFlag, AnySplitOfAnyBytesGivesTheSame, ()) {
  const auto stream = *rc::gen::container<std::string>(rc::gen::weightedOneOf<char>(
      {{4, rc::gen::arbitrary<char>()}, {1, rc::gen::element('\x7d', '\x7e', '\x45', '\x43')}}));
  std::mt19937 random(*rc::gen::arbitrary<unsigned>());
  HdlcReader portable({}, CpuPath::kPortable);
  const std::vector<Kept> whole = read_all(portable, view(stream));
  for (CpuPath path : kPaths) {
    if (!cpu_has(path)) continue;
    HdlcReader reader({}, path);
    RC_ASSERT(read_all(reader, view(stream)) == whole);
    RC_ASSERT(read_split(reader, view(stream), random, 3) == whole);
    RC_ASSERT(read_split(reader, view(stream), random, 40) == whole);
  }
}

// Long enough for the vector scan, and full of cases for slower code.
TEST(WireHdlcEscape, PathsAgreeOnLongStreamsOfOddities) {
  std::mt19937 random(12);
  const std::uint8_t odd[] = {kHdlcFlag, kHdlcFlag, kHdlcEscape, kHdlcEscape, 0x5D, 0x5E, 0x45};
  std::size_t packets = 0;
  for (int round = 0; round < 200; ++round) {
    std::string stream;
    const unsigned every = 2u << random() % 8;  // One byte in so many is odd.
    while (stream.size() < 6000) {
      if (random() % (2 * every) == 0) {
        std::string content(2 + random() % 250, '\x45');
        for (char& c : content) c = static_cast<char>(random() % 4 ? random() : 0x7D);
        stream += framed(content);
      }
      stream += static_cast<char>(random() % every == 0 ? odd[random() % 7] : random());
    }
    HdlcReader portable({}, CpuPath::kPortable);
    const std::vector<Kept> want = read_all(portable, view(stream));
    packets += want.size();
    for (CpuPath path : kPaths) {
      if (!cpu_has(path)) continue;
      HdlcReader reader({}, path);
      ASSERT_EQ(read_all(reader, view(stream)), want) << static_cast<int>(path);
      ASSERT_EQ(read_split(reader, view(stream), random, 2000), want);
    }
  }
  EXPECT_GT(packets, 10'000u);
}

TEST(WireHdlcFlag, SearchesAgree) {
  std::mt19937 random(11);
  for (int round = 0; round < 4000; ++round) {
    std::vector<std::uint8_t> data(random() % 200);
    for (std::uint8_t& byte : data) byte = static_cast<std::uint8_t>(0x70 + random() % 16);
    for (std::uint8_t& byte : data) {
      if (random() % 32 != 0 && (byte == kHdlcFlag || byte == kHdlcEscape)) byte = 0xFF;
    }
    const std::uint8_t* const end = data.data() + data.size();
    const std::uint8_t* const want =
        std::find_if(std::as_const(data).data(), end,
                     [](std::uint8_t b) { return b == kHdlcFlag || b == kHdlcEscape; });
    EXPECT_EQ(find_special_swar(data.data(), end), want);
    EXPECT_EQ(find_special_portable(data.data(), end), want);
    if (cpu_has(CpuPath::kVector)) {
      EXPECT_EQ(find_special_vector(data.data(), end), want);
    }
    if (cpu_has(CpuPath::kWide)) {
      EXPECT_EQ(find_special_wide(data.data(), end), want);
    }
  }
}

}  // namespace
}  // namespace rubric
