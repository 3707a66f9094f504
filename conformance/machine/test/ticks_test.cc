#include "conformance/machine/ticks.h"

#include <gtest/gtest.h>

#include <limits>

#include "conformance/machine/profile.h"

namespace rubric::machine {
namespace {

constexpr Ticks kLast = std::numeric_limits<Ticks>::max();

TEST(Ticks, ASecondIs1024OfThem) {
  EXPECT_EQ(ticks_of(1'000'000), 1024U);
  EXPECT_EQ(us_of(1024), 1'000'000);
  EXPECT_EQ(Profile{}.ticks_per_second, kTicksPerSecond);
}

TEST(Ticks, ATickHasBegunFromItsFirstMicrosecondOn) {
  EXPECT_EQ(ticks_of(976), 0U);  // A tick lasts 976.5625 microseconds.
  EXPECT_EQ(ticks_of(977), 1U);
  EXPECT_EQ(us_of(1), 977);
  EXPECT_EQ(us_of(500), 488'282);  // 488281.25
  EXPECT_EQ(us_of(512), 500'000);
}

TEST(Ticks, ThereAndBackIsTheSameTickUntilTheLast) {
  const auto same = [](Ticks ticks) {
    return ticks_of(us_of(ticks)) == ticks && (ticks == 0 || ticks_of(us_of(ticks) - 1) < ticks);
  };
  for (Ticks ticks = 0; ticks < 100'000; ++ticks) ASSERT_TRUE(same(ticks)) << ticks;
  for (Ticks ticks = kLast; ticks > kLast - 1000; --ticks) ASSERT_TRUE(same(ticks)) << ticks;
}

TEST(Ticks, OtherUnitsAreCutOffToo) {
  EXPECT_EQ(ticks_of(1000, 1000), 1024U);
  EXPECT_EQ(ticks_of(1, 1000), 1U);    // 1.024
  EXPECT_EQ(ticks_of(41, 1000), 41U);  // 41.984
  EXPECT_EQ(ticks_of(42, 1000), 43U);  // 43.008
  EXPECT_EQ(ticks_of(777, 1024), 777U);
}

TEST(Ticks, WhatHoldsATimeIsRoundedUp) {
  EXPECT_EQ(ticks_to_hold(0), 0U);
  EXPECT_EQ(ticks_to_hold(1), 1U);
  EXPECT_EQ(ticks_to_hold(976), 1U);
  EXPECT_EQ(ticks_to_hold(977), 2U);
  EXPECT_EQ(ticks_to_hold(1'000'000), 1024U);
}

}  // namespace
}  // namespace rubric::machine
