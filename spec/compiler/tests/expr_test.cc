// The expression parser, and interval arithmetic against brute force.
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "spec/compiler/check/intervals.h"
#include "spec/compiler/load/read_spec.h"
#include "spec/compiler/load/yaml_input.h"

namespace rubricc {
namespace {

std::string parsed(std::string_view text) {
  Diagnostics diagnostics;
  const ExprPtr expr = parse_expr(text, {"t", 1, 1}, diagnostics);
  return expr ? to_text(*expr) : diagnostics.sorted().at(0).text;
}

TEST(Expressions, BindAsInKaitaiStruct) {
  EXPECT_EQ(parsed("a + b * c"), "a + b * c");
  EXPECT_EQ(parsed("(a + b) * c"), "(a + b) * c");
  EXPECT_EQ(parsed("a - (b - c)"), "a - (b - c)");
  EXPECT_EQ(parsed("(a - b) - c"), "a - b - c");
  EXPECT_EQ(parsed("not a == b or c < 1 and d >= 0x10"), "not a == b or c < 1 and d >= 16");
  EXPECT_EQ(parsed("(a == 1 or b == 2) and c == 3"), "(a == 1 or b == 2) and c == 3");
  EXPECT_EQ(parsed("-4 + a.b.c"), "-4 + a.b.c");
  EXPECT_EQ(parsed("kind.to_i == tinyos::serial_kind::ack.to_i"),
            "kind.to_i == tinyos::serial_kind::ack.to_i");
}

TEST(Expressions, OnBitsBindAsInKaitaiStruct) {
  EXPECT_EQ(parsed("(a & 0b1111_0000) >> 4"), "(a & 240) >> 4");
  EXPECT_EQ(parsed("a & 0xf == 1 or b"), "a & 15 == 1 or b");
  EXPECT_EQ(parsed("a | (b ^ (c & (d << (e + 1))))"), "a | b ^ c & d << e + 1");
  EXPECT_EQ(parsed("a ? b : c ? d : e"), "a ? b : c ? d : e");
  EXPECT_EQ(parsed("(a ? b : c) + 1"), "(a ? b : c) + 1");
}

TEST(Expressions, PlacesCountFromTheStartOfTheText) {
  Diagnostics diagnostics;
  EXPECT_EQ(parse_expr("a + (b * ", {"t", 7, 20}, diagnostics), nullptr);
  EXPECT_EQ(diagnostics.sorted().at(0).place.line, 7);
  EXPECT_EQ(diagnostics.sorted().at(0).place.column, 29);
}

TEST(Intervals, HoldEveryResult) {
  std::mt19937 random(7);
  std::uniform_int_distribution<std::int64_t> some(-40, 40), width(0, 6);
  const ExprOp ops[] = {ExprOp::kAdd, ExprOp::kSub, ExprOp::kMul, ExprOp::kDiv, ExprOp::kMod};
  for (int i = 0; i < 2000; ++i) {
    const std::int64_t a0 = some(random), b0 = some(random);
    const Interval a{a0, a0 + width(random)}, b{b0, b0 + width(random)};
    for (const ExprOp op : ops) {
      const bool divides = op == ExprOp::kDiv || op == ExprOp::kMod;
      if (divides && b.min <= 0 && b.max >= 0) continue;
      const auto range = combine(op, a, b);
      ASSERT_TRUE(range);
      for (std::int64_t x = a.min; x <= a.max; ++x) {
        for (std::int64_t y = b.min; y <= b.max; ++y) {
          const std::int64_t value = op == ExprOp::kAdd   ? x + y
                                     : op == ExprOp::kSub ? x - y
                                     : op == ExprOp::kMul ? x * y
                                     : op == ExprOp::kDiv ? floor_div(x, y)
                                                          : floor_mod(x, y);
          ASSERT_GE(value, range->min) << x << ' ' << y << " op " << static_cast<int>(op);
          ASSERT_LE(value, range->max) << x << ' ' << y << " op " << static_cast<int>(op);
        }
      }
    }
  }
}

TEST(Intervals, HoldEveryResultOnBits) {
  std::mt19937 random(8);
  std::uniform_int_distribution<std::int64_t> some(0, 70), width(0, 6);
  const auto value_of = [](ExprOp op, std::int64_t x, std::int64_t y) {
    switch (op) {
      case ExprOp::kBitAnd: return x & y;
      case ExprOp::kBitOr: return x | y;
      case ExprOp::kBitXor: return x ^ y;
      case ExprOp::kShiftLeft: return x << y;
      default: return x >> y;
    }
  };
  for (int i = 0; i < 2000; ++i) {
    const std::int64_t a0 = some(random), b0 = some(random);
    const Interval a{a0, a0 + width(random)}, b{b0, b0 + width(random)};
    for (const ExprOp op : {ExprOp::kBitAnd, ExprOp::kBitOr, ExprOp::kBitXor, ExprOp::kShiftLeft,
                            ExprOp::kShiftRight}) {
      const auto range = combine(op, a, b);
      for (std::int64_t x = a.min; range && x <= a.max; ++x) {
        for (std::int64_t y = b.min; y <= b.max; ++y) {
          ASSERT_GE(value_of(op, x, y), range->min) << x << ' ' << y;
          ASSERT_LE(value_of(op, x, y), range->max) << x << ' ' << y;
        }
      }
      const bool shifts = op == ExprOp::kShiftLeft || op == ExprOp::kShiftRight;
      ASSERT_EQ(range.has_value(), !shifts || (b.max <= 31 && (op == ExprOp::kShiftRight ||
                                                               a.max << b.max <= 0xFFFFFFFF)));
    }
  }
  EXPECT_FALSE(combine(ExprOp::kBitAnd, {-1, 1}, {1, 1}));
  EXPECT_FALSE(combine(ExprOp::kBitOr, {0, 0x100000000}, {1, 1}));
}

TEST(Intervals, RoundDownLikeKaitaiStruct) {
  EXPECT_EQ(floor_div(-7, 2), -4);
  EXPECT_EQ(floor_mod(-7, 2), 1);
  EXPECT_EQ(floor_div(7, -2), -4);
  EXPECT_EQ(floor_mod(7, -2), -1);
}

TEST(Intervals, OverflowIsNoInterval) {
  constexpr Interval kAll{std::numeric_limits<std::int64_t>::min(),
                          std::numeric_limits<std::int64_t>::max()};
  for (const ExprOp op : {ExprOp::kAdd, ExprOp::kSub, ExprOp::kMul}) {
    EXPECT_FALSE(combine(op, kAll, {1, 2}));
  }
  EXPECT_FALSE(combine(ExprOp::kDiv, kAll, {-1, -1}));
}

TEST(Integers, AreReadWholeOrNotAtAll) {
  EXPECT_EQ(parse_integer("0x1f"), 31);
  EXPECT_EQ(parse_integer("-3"), -3);
  for (const char* bad : {"", "-", "--3", "0x", "1 ", "1.5", "ten", "9223372036854775808"}) {
    EXPECT_EQ(parse_integer(bad), std::nullopt) << bad;
  }
}

TEST(Suggestions, NameTheNearestOrListAll) {
  const std::vector<std::string> known{"size", "size-eos", "repeat"};
  EXPECT_EQ(suggestion("sizee", known), "did you mean 'size'?");
  EXPECT_EQ(suggestion("reapet", known), "did you mean 'repeat'?");
  EXPECT_EQ(suggestion("wholly", known), "known are size, size-eos, repeat");
}

}  // namespace
}  // namespace rubricc
