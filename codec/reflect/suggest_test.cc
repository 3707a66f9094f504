#include "codec/reflect/suggest.h"

#include <gtest/gtest.h>

namespace rubric::reflect {
namespace {

TEST(Suggest, counts_steps) {
  EXPECT_EQ(edit_distance("", ""), 0);
  EXPECT_EQ(edit_distance("", "abc"), 3);
  EXPECT_EQ(edit_distance("abc", "abc"), 0);
  EXPECT_EQ(edit_distance("decoed", "decode"), 1);  // Neighbours swapped.
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3);
}

TEST(Suggest, knows_what_was_meant) {
  const std::vector<std::string> names = {"decode", "encode", "convert", "stats"};
  EXPECT_EQ(nearest("decod", names), "decode");
  EXPECT_EQ(nearest("dec", names), "decode");
  EXPECT_EQ(nearest("stat", names), "stats");
  EXPECT_EQ(nearest("conver", names), "convert");
  EXPECT_EQ(nearest("output", {"decode", "out"}), "out");
  EXPECT_EQ(nearest("an", {"a", "b"}), "a");
  EXPECT_EQ(nearest("android", {"an"}), "");
  EXPECT_EQ(nearest("frobnicate", names), "");
  EXPECT_EQ(nearest("x", {}), "");
  EXPECT_EQ(nearest("xncode", {"encode", "uncode"}), "encode");  // The first of two.
  const std::string at_most(64, 'x');
  EXPECT_EQ(nearest(at_most, {at_most}), at_most);
  EXPECT_EQ(nearest(at_most + 'x', {at_most}), "");
  EXPECT_EQ(did_you_mean("encod", names), " (did you mean 'encode'?)");
  EXPECT_EQ(did_you_mean("qqqqqq", names), "");
}

}  // namespace
}  // namespace rubric::reflect
