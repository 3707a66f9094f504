#include <gtest/gtest.h>

#include "codec/containers/hex_reader.h"
#include "codec/containers/tests/testing.h"

namespace rubric {
namespace {

using namespace testing;

void expect_no_stamp(std::initializer_list<const char*> texts) {
  for (const char* text : texts) EXPECT_EQ(read_stamp(view(text)).size, 0u) << text;
}

TEST(WireHex, StampsOfALogArePassedOver) {
  const std::string packet = "00 ff ff 00 00 04 22 06 00 02 00 01";
  for (const std::string stamp :
       {"[12.345] ", "[2026-11-24 13:55:05.123] ", "12.345 ", "1700000000.123456\t",
        "12:34:56.789 -> ", "Nov 24 13:55:05 ", "Dec  4 13:55:05 ", "2026-11-24 13:55:05,123 ",
        "2026-11-24T13:55:05+0100 ", "24/11/2026 13:55 ", "(1764000000.123) ",
        "24.11.2026 10:00:00 ", "Nov 24 2026 10:00:00 ", "10:00:00 AM ", "11/24/2026 10:00:00 pm ",
        "2026-11-24 10:00:00|", "   0.123: ", "1700000000.123: ", "[12.345]: "}) {
    const std::string log = stamp + "serial@/dev/ttyUSB0:115200: resynchronising\n" + stamp +
                            packet + "\r\n" + stamp + "\n" + stamp + packet + "g\n";
    EXPECT_EQ(detect(view(log.substr(0, log.size() - 2))), InputFormat::kLog) << log;
    EXPECT_EQ(detect(view(stamp + packet)), InputFormat::kLog) << log;
    const auto hex = make_reader(InputFormat::kHex);
    EXPECT_EQ(read_all(*hex, view(stamp + packet)).at(0).bytes.size(), 12u) << stamp;
    const auto reader = make_reader(InputFormat::kLog);
    const std::vector<Kept> got = read_all(*reader, view(log));
    ASSERT_EQ(got.size(), 2u) << log;
    EXPECT_EQ(got[0].packet.error, kSound);
    EXPECT_EQ(got[0].bytes.size(), 12u);
    EXPECT_EQ(got[1].packet.error.offset_bytes, stamp.size() + packet.size());
    EXPECT_EQ(reader->noise().lines, 1u);
  }
  expect_no_stamp({"00 ff", "0010: 00 ff", "[00 ff", "[] 00", "dec 4 00", "12. 00", "1.2.3 00",
                   "(00 ff", "2026-11-24 00", "serial@x:1.2", "1764000000", "1764000000 00",
                   "2764000000 00 ff", "176400000 00 ff", "mote 2: 25 C"});
  expect_no_stamp({"1764000000 1764000001 00", "1764000000 00 # one group and a rest",
                   "1764000000\t1\t2\t3: 0x00ff", "mote: 00 ff ff 00 00 04 22 06 00",
                   "robot 2: 00 ff ff 00 00 04 22 06"});
  EXPECT_EQ(read_stamp(view("12:34 ")).size, 6u);
}

TEST(WireHex, AStampIsThePacketsTime) {
  constexpr std::int64_t kMs = 1'000'000;
  const struct {
    const char* stamp;
    std::int64_t time_ns;
  } kRows[] = {
      {"12:03:04.567 ", 43'384'567 * kMs},
      {"[123.456] ", 123'456 * kMs},
      {"1690000000.123 ", 1'690'000'000'123 * kMs},
      {"(1690000000.123456789): ", 1'690'000'000'123'456'789},
      {"1690000000123 ", 1'690'000'000'123 * kMs},
      {"1690000000123456 -> ", 1'690'000'000'123'456'000},
      {"1690000000123456789\t", 1'690'000'000'123'456'789},
      {"[2026-11-24 13:55:05.123] ", 1'795'528'505'123 * kMs},
      {"2026/11/24 13:55:05,123 ", 1'795'528'505'123 * kMs},
      {"24.11.2026 1:55:05.123 PM ", 1'795'528'505'123 * kMs},
      {"Nov 24 2026 13:55:05.123 ", 1'795'528'505'123 * kMs},
      {"2026-11-24T13:55:05.123Z ", 1'795'528'505'123 * kMs},
      {"2026-11-24T14:55:05.123+01:00 ", 1'795'528'505'123 * kMs},
      {"2026-11-24T12:25:05.123-0130 ", 1'795'528'505'123 * kMs},
      {"2000-02-29 00:00:00.000 ", 951'782'400'000 * kMs},
      {"12:00:00.000 AM ", 0},
      // Coarse, or of more than one meaning.
      {"12:03:04 ", kNoTime},
      {"12:03:04.5 ", kNoTime},
      {"[12.3] ", kNoTime},
      {"1690000000 ", kNoTime},
      {"24/11/2026 13:55:05.123 ", kNoTime},
      {"Nov 24 13:55:05.123 ", kNoTime},
      {"2026-13-24 13:55:05.123 ", kNoTime},
      {"25:00:00.000 ", kNoTime},
      {"99999999999.123 ", kNoTime},
      {"node 2: ", kNoTime},
  };
  for (const auto& row : kRows) {
    for (const char* packet :
         {"00 ff ff 00 00 04 22 06 00 02 00 01\n", "00ffff000004220600020001"}) {
      const auto reader = make_reader(InputFormat::kLog);
      const std::vector<Kept> got = read_all(*reader, view(std::string(row.stamp) + packet));
      ASSERT_EQ(got.size(), 1u) << row.stamp;
      EXPECT_EQ(got[0].packet.time_ns, row.time_ns) << row.stamp;
    }
  }
}

TEST(WireHex, TimesOfDayGoOnAfterMidnight) {
  const std::string packet = "00 ff ff 00 00 04 22 06 00 02 00 01\n";
  const auto reader = make_reader(InputFormat::kLog);
  const std::vector<Kept> got =
      read_all(*reader, view("23:59:59.900 " + packet + "00:00:00.100 " + packet + "00:00:00.050 " +
                             packet + "23:00:00.000 " + packet + "01:00:00.000 " + packet));
  ASSERT_EQ(got.size(), 5u);
  EXPECT_EQ(got[1].packet.time_ns - got[0].packet.time_ns, 200'000'000);
  EXPECT_LT(got[2].packet.time_ns, got[1].packet.time_ns);
  EXPECT_EQ(got[4].packet.time_ns - got[3].packet.time_ns, 2 * 3'600'000'000'000);
}

TEST(WireHex, ASerialFrameHasTheTimeOfItsLine) {
  const auto reader = make_reader(InputFormat::kLog);
  const std::vector<Kept> got = read_all(
      *reader, view("[1.001] 7E 43 01 30 32 7E\n[2.002] RX: 7E 43 02 53 02\n[3.003] rx: 7E\n"));
  ASSERT_EQ(got.size(), 2u);
  EXPECT_EQ(got[0].packet.time_ns, 1'001'000'000);
  EXPECT_EQ(got[1].packet.time_ns, 3'003'000'000);  // When it was whole.
}

TEST(WireHex, AMarkOfReceivedBytesIsPassedOverAndSaid) {
  const std::string packet = "00 ff ff 00 00 04 22 06 00 02 00 01\n";
  for (const std::string before :
       {"rx ", "RX: ", "<- ", "Rx:\t", "[1.001] <- ", "12:03:04 RX: 0x"}) {
    EXPECT_EQ(detect(view(before + packet)), InputFormat::kLog) << before;
    const auto reader = make_reader(InputFormat::kLog);
    const std::vector<Kept> got = read_all(*reader, view(before + packet + "rx full\n"));
    ASSERT_EQ(got.size(), 1u) << before;
    EXPECT_EQ(got[0].bytes.size(), 12u) << before;
    EXPECT_NE(before.find(reader->noise().marker), before.npos);
    EXPECT_GE(reader->noise().marker.size(), 2u);
    EXPECT_EQ(reader->noise().lines, 1u);
  }
  expect_no_stamp({"tx 00 ff", "rx fifo", "rxd 00 ff", "-> 00 ff", "rx: 1 packet", "RX:"});
}

TEST(WireHex, StampsAndLabelsBeforeAPacketArePassedOver) {
  for (const std::string stamp :
       {"1764000000 ", "1764000000123\t", "1764000000123456 -> ", "[12.3] mote 2: ", "node2: "}) {
    for (const std::string packet :
         {"00 ff ff 00 00 04 22 06 00 02 00 01", "00ffff000004220600020001"}) {
      EXPECT_EQ(detect(view(stamp + packet)), InputFormat::kLog) << stamp << packet;
      for (const InputFormat format : {InputFormat::kLog, InputFormat::kHex}) {
        const auto reader = make_reader(format);
        const std::vector<Kept> got = read_all(*reader, view(stamp + packet));
        ASSERT_EQ(got.size(), 1u) << stamp << packet;
        EXPECT_EQ(got[0].bytes.size(), 12u) << stamp << packet;
      }
    }
  }
}

}  // namespace
}  // namespace rubric
