// Templates: holes alone on a line, empty ones, and missing values.
#include "spec/compiler/emit/template.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace rubricc {
namespace {

TEST(Template, FillsHolesWithinALine) {
  EXPECT_EQ(fill("a <<x>> b <<x>><<y>>", {{"x", "1"}, {"y", "2"}}), "a 1 b 12");
}

TEST(Template, IndentsAValueThatStandsAlone) {
  EXPECT_EQ(fill("{\n  <<x>>\n}\n", {{"x", "a\n\nb\n"}}), "{\n  a\n\n  b\n}\n");
}

TEST(Template, AnOptionalHoleTakesItsLineWithIt) {
  EXPECT_EQ(fill("{\n  <<x?>>\n}\n", {{"x", ""}}), "{\n}\n");
  EXPECT_EQ(fill("(<<x?>>)", {{"x", ""}}), "()");
}

TEST(Template, ValuesAreNotReadAgain) { EXPECT_EQ(fill("<<x>>", {{"x", "<<y>>"}}), "<<y>>"); }

TEST(Template, MistakesOfTheEmitterThrow) {
  EXPECT_THROW(fill("<<x>>", {}), std::logic_error);
  EXPECT_THROW(fill("x", {{"x", "1"}}), std::logic_error);
  EXPECT_THROW(fill("<<x>>", {{"x", ""}}), std::logic_error);
}

}  // namespace
}  // namespace rubricc
