// Blame where send refused a message that a case goes on with.
#include "conformance/test/runner/refusals.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "conformance/trace/parse.h"

namespace rubric::runner {
namespace {

using Rules = std::vector<std::string>;

// Returns the last line of a case.
trace::Line line_of(const std::string& text) {
  const trace::Parsed parsed = trace::parse(
      "%rtr 1\n%node m5 mote id=5 iut\n%node sA sink id=1 island=11\ncase x\n" + text + "\n", "x");
  EXPECT_TRUE(parsed.ok()) << parsed.errors();
  return *parsed.file.cases.front().lines().back();
}

trace::Bindings bound(std::int64_t number) {
  trace::Bindings out;
  out.set("s", trace::Value::of(number));
  return out;
}

const std::string kResult = "  0..50 m5 > app send_result(seq_num=$s)";
const std::string kMessage = "  0..50 m5 > rA net_msg(seq_num=$s ...) [N2-ONCE N1-SRC]";

Failure blamed(const Refusals& refusals, const std::string& line, bool weak = false) {
  Failure failure;
  failure.requirements = {"N2-ONCE"};
  failure.suspected = {"N1-SRC"};
  failure.text = "nothing came";
  failure.broken_at = 99;
  failure.weak = weak;
  refusals.blame(line_of(line), failure);
  return failure;
}

TEST(Refusals, WhatWasRefusedIsTheCause) {
  Refusals refusals;
  refusals.note(line_of(kResult), 7, bound(0xFFFF));
  const Failure failure = blamed(refusals, kMessage);
  EXPECT_EQ(failure.requirements, Rules{"N1-ROOM"});
  EXPECT_EQ(failure.suspected, Rules{});
  EXPECT_EQ(failure.text, "send refused it: send_result(65535) at 7");
  EXPECT_EQ(failure.broken_at, 7);
}

TEST(Refusals, TheLineOfTheResultMayNameItsRule) {
  Refusals refusals;
  refusals.note(line_of(kResult + " [N1-SEQ]"), 7, bound(0xFFFF));
  EXPECT_EQ(blamed(refusals, kMessage).requirements, Rules{"N1-SEQ"});
}

TEST(Refusals, OtherFailuresKeepTheirRules) {
  Refusals refusals;
  refusals.note(line_of(kResult), 7, bound(20));  // It was accepted.
  EXPECT_EQ(blamed(refusals, kMessage).requirements, Rules{"N2-ONCE"});
  refusals.note(line_of("  0..50 m5 > app ack_received(seq_num=$s ...)"), 8, bound(0xFFFF));
  EXPECT_EQ(blamed(refusals, kMessage).requirements, Rules{"N2-ONCE"}) << "No result of send.";
  refusals.note(line_of(kResult), 9, bound(0xFFFF));
  EXPECT_EQ(blamed(refusals, kMessage, true).requirements, Rules{"N2-ONCE"}) << "A SHOULD.";
  const std::string other = "  0..50 m5 > rA net_msg(seq_num=$t ...) [N2-ONCE]";
  EXPECT_EQ(blamed(refusals, other).requirements, Rules{"N2-ONCE"}) << "Another number.";
  const Failure failure = blamed(refusals, other);
  EXPECT_EQ(failure.text, "nothing came");
  EXPECT_EQ(failure.broken_at, 99);
}

}  // namespace
}  // namespace rubric::runner
