#include "tools/commands/stats/counters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "codec/generated/rubicon/tables.h"
#include "codec/reflect/encode.h"
#include "tools/commands/stats/report.h"

namespace rubric::stats {
namespace {

using testing::HasSubstr;

/// Feeds packets from hex text.
class Feed {
 public:
  void packet(const std::string& hex, std::int64_t time_ns, std::string_view file = "a",
              std::string_view interface_name = "radio") {
    std::vector<std::uint8_t> bytes;
    ASSERT_TRUE(reflect::parse_hex(hex, bytes));
    Packet packet{
        .framing = Framing::kSf, .bytes = Bytes(bytes.data(), bytes.size()), .time_ns = time_ns};
    decoder_.decode(packet, frame_);
    counters.take(frame_, {file, interface_name, index_, index_ + 1});
    ++index_;
  }
  Counters counters;

 private:
  reflect::FrameDecoder decoder_{rubicon::tables::kProtocol};
  reflect::Frame frame_;
  std::uint64_t index_ = 0;
};

constexpr std::int64_t kSecond = 1'000'000'000;
// An opaque message from 11:2 to 11:null with sequence number 7 or 8, and two that are malformed.
const std::string kSeven = "00 0001 0000 0e 00 1c 000bfffd 000b0002 00 0007 02 050a";
const std::string kEight = "00 0001 0000 0e 00 1c 000bfffd 000b0002 00 0008 02 050a";
const std::string kBadNbytes = "00 0001 0000 0e 00 1c 000bfffd 000b0002 00 0008 67 050a";
const std::string kConfig = "00 0001 0000 03 00 25 0a000c";

TEST(Counters, MessagesAndPairs) {
  Feed feed;
  feed.packet(kSeven, 0);
  feed.packet(kEight, kSecond);
  feed.packet(kConfig, 3 * kSecond);
  const Counters& c = feed.counters;
  EXPECT_EQ(c.all().frames, 3u);
  EXPECT_EQ(c.all().bytes, 22u + 22u + 11u);
  EXPECT_EQ(c.messages().at("app_msg").frames, 2u);
  EXPECT_EQ(c.messages().at("config").frames, 1u);
  EXPECT_EQ(c.pairs().at("11:2>11:null").frames, 2u);
  EXPECT_EQ(c.pairs().at("AM 0>1").frames, 1u);
  EXPECT_DOUBLE_EQ(c.all().rate(), 1);
  EXPECT_DOUBLE_EQ(c.messages().at("app_msg").rate(), 2);
  EXPECT_EQ(c.sources().at("11:2").frames, 2u);
  EXPECT_EQ(c.sources().at("AM 0").frames, 1u);
}

TEST(Counters, LargestGapWithItsNeighbours) {
  Feed feed;
  feed.packet(kSeven, 0);
  feed.packet(kEight, kSecond);
  feed.packet(kConfig, 3 * kSecond);
  feed.packet(kConfig, 4 * kSecond);
  const Flow& all = feed.counters.all();
  EXPECT_EQ(all.gap_ns, 2 * kSecond);
  EXPECT_EQ(all.gap_from.index, 1u);
  EXPECT_EQ(all.gap_to.index, 2u);
}

TEST(Counters, TimesOfDifferentFilesAreNotCompared) {
  Feed feed;
  feed.packet(kSeven, 0, "a");
  feed.packet(kEight, 100 * kSecond, "b");
  EXPECT_EQ(feed.counters.all().gap_ns, -1);
  EXPECT_EQ(feed.counters.all().rate(), 0);
}

TEST(Counters, TimeThatRunsBackwards) {
  Feed feed;
  feed.packet(kSeven, kSecond);
  feed.packet(kEight, 0);
  feed.packet(kConfig, kNoTime);
  EXPECT_EQ(feed.counters.all().backward, 1u);
  EXPECT_EQ(feed.counters.gaps().count(), 0u);
  EXPECT_DOUBLE_EQ(feed.counters.all().seconds(), 1);
  EXPECT_DOUBLE_EQ(feed.counters.all().rate(), 2);
}

// The length of a file does not depend on the order of its frames.
TEST(Counters, LengthsOfFilesAreSummed) {
  Feed feed;
  for (const std::int64_t time : {5, 2, 9, 3}) feed.packet(kSeven, time * kSecond, "a");
  for (const std::int64_t time : {100, 101}) feed.packet(kSeven, time * kSecond, "b");
  EXPECT_DOUBLE_EQ(feed.counters.all().seconds(), 8);
  EXPECT_DOUBLE_EQ(feed.counters.all().rate(), 6.0 / 8);
  EXPECT_EQ(feed.counters.all().backward, 2u);
}

TEST(Distribution, PercentilesAreWithinTheirError) {
  Gaps gaps;
  EXPECT_EQ(gaps.percentile(50), -1);
  for (std::int64_t i = 1; i <= 1000; ++i) gaps.take(i * 1'000'000);
  for (const double percent : {1.0, 50.0, 90.0, 99.0, 100.0}) {
    const double wanted = percent * 10'000'000;
    const auto found = static_cast<double>(gaps.percentile(percent));
    EXPECT_GE(found, wanted) << percent;
    EXPECT_LE(found, wanted * 1.032) << percent;
  }
  Gaps regular;
  for (const std::int64_t gap : {250'000'000, 500'000'000}) regular.take(gap);
  EXPECT_EQ(regular.percentile(50), 250'000'000);
  EXPECT_EQ(regular.percentile(90), 500'000'000);  // Not a little less, which is not true.
  Gaps small;
  for (const std::int64_t gap : {0, 1, 63, 64, 65}) small.take(gap);
  EXPECT_EQ(small.percentile(20), 0);
  EXPECT_EQ(small.percentile(60), 63);
  Gaps extreme;
  extreme.take(INT64_MAX);
  EXPECT_EQ(extreme.percentile(50), INT64_MAX);
}

TEST(Distribution, BinsGrowAndKeepAllFrames) {
  TimeLine line;
  for (int i = 0; i < 10'000; ++i) line.take((i * 7919 % 10'000 - 3000) * 50'000'000LL);
  EXPECT_EQ(line.width_ns(), 10'000'000'000);
  EXPECT_EQ(line.bins().begin()->first, -15);
  EXPECT_EQ(line.bins().rbegin()->first, 34);
  for (const auto& [bin, frames] : line.bins()) EXPECT_EQ(frames, 200u) << bin;
  TimeLine far;
  for (const std::int64_t time : {INT64_MIN + 1, std::int64_t{0}, INT64_MAX}) far.take(time);
  EXPECT_LE(far.bins().size(), 3u);
}

TEST(Counters, ExtremeTimes) {
  Feed feed;
  feed.packet(kSeven, INT64_MIN + 1);
  feed.packet(kEight, INT64_MAX);
  EXPECT_EQ(feed.counters.all().gap_ns, INT64_MAX);
}

TEST(Counters, RepeatedSequenceNumbers) {
  Feed feed;
  feed.packet(kSeven, 0);
  feed.packet(kSeven, 1);
  feed.packet(kEight, 2);
  feed.packet(kSeven, 3);
  EXPECT_EQ(feed.counters.all().repeated, 1u);
  // The same message on its way through another interface, or in another capture, is no repetition.
  feed.packet(kSeven, 4, "a", "serial");
  EXPECT_EQ(feed.counters.all().repeated, 1u);
  feed.packet(kSeven, 0, "b", "serial");
  EXPECT_EQ(feed.counters.all().repeated, 1u);
}

TEST(Counters, FaultsByRule) {
  Feed feed;
  feed.packet(kSeven, 0);
  feed.packet(kBadNbytes, 1);
  feed.packet(kBadNbytes, 2);
  const auto& faults = feed.counters.faults();
  ASSERT_EQ(faults.size(), 1u);
  const auto& [key, count] = *faults.begin();
  EXPECT_EQ(key.second, "WIRE-NET-NBYTES"_rule);
  EXPECT_EQ(count.frames, 2u);
  EXPECT_EQ(count.first.index, 1u);
  EXPECT_THAT(text_report(feed.counters), HasSubstr("WIRE-NET-NBYTES"));
  EXPECT_THAT(json_report(feed.counters),
              HasSubstr(R"("fault":"out_of_range","requirement":"WIRE-NET-NBYTES","frames":2)"));
}

TEST(Counters, ManyPairsAreBounded) {
  Feed feed;
  for (std::size_t i = 0; i < Counters::kMaxPairs + 500; ++i) {
    char hex[64];
    std::snprintf(hex, sizeof(hex), "00 %04x %04x 03 00 25 0a000c", static_cast<unsigned>(i & 0xff),
                  static_cast<unsigned>(i >> 8));
    feed.packet(hex, 0);
  }
  EXPECT_EQ(feed.counters.pairs().size(), Counters::kMaxPairs + 1);
  EXPECT_EQ(feed.counters.pairs().at(std::string(Counters::kOtherPairs)).frames, 500u);
}

TEST(Counters, NothingCounted) {
  const Counters none;
  EXPECT_EQ(text_report(none), "0 frames, 0 bytes, 0 malformed\n");
  EXPECT_THAT(json_report(none), HasSubstr("\"largest_gap\":null"));
}

}  // namespace
}  // namespace rubric::stats
