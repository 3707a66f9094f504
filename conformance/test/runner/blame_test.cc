// Blame by evidence: one rule of a line, and what an earlier failure implies.
#include "conformance/test/runner/blame.h"

#include <gtest/gtest.h>

namespace rubric::runner {
namespace {

using Rules = std::vector<std::string>;

std::string blamed(Rules rules, const Evidence& evidence) {
  Failure failure{.requirements = std::move(rules)};
  const std::size_t all = failure.requirements.size();
  blame_one(failure, evidence);
  EXPECT_EQ(failure.requirements.size(), 1u);
  EXPECT_EQ(failure.suspected.size(), all - 1);
  EXPECT_EQ(failure.rules().size(), all);
  return failure.requirements.front();
}

TEST(Blame, AnAckEventIsNoResend) {
  const Rules rules = {"T3-RESEND", "T3-ONCE"};
  EXPECT_EQ(blamed(rules, {"app", "ack_received", "fail", "again"}), "T3-ONCE");
  EXPECT_EQ(blamed(rules, {"radio", "net_msg", "again"}), "T3-RESEND");
  EXPECT_EQ(blamed({"T3-MATCH", "T3-TIMEOUT"}, {"app", "ack_received", "fail"}), "T3-TIMEOUT");
}

TEST(Blame, ByLinkAndRepetition) {
  const Rules up = {"N8-INCOMING", "N8-PEIS", "T3-RESEND"};
  EXPECT_EQ(blamed(up, {"peis", "net_msg", "new"}), "N8-PEIS");
  EXPECT_EQ(blamed(up, {"serial", "net_msg", "new"}), "N8-INCOMING");
  const Rules on = {"N6-ONCE", "N7-CONTENT"};
  EXPECT_EQ(blamed(on, {"radio", "net_msg", "again"}), "N6-ONCE");
  EXPECT_EQ(blamed(on, {"radio", "net_msg", "new"}), "N7-CONTENT");
  EXPECT_EQ(blamed({"N2-ONCE", "T2-ONCE"}, {"radio", "ack", "again"}), "T2-ONCE");
}

TEST(Blame, WhatIsMissingHasNoContent) {
  const Rules rules = {"J4-CONTENT", "J4-ACK"};
  EXPECT_EQ(blamed(rules, {"missing"}), "J4-ACK");
  EXPECT_EQ(blamed({"J4-ACK", "J4-CONTENT"}, {"differs", "dest"}), "J4-CONTENT");
  EXPECT_EQ(blamed({"N1-ROOM", "N1-SEQ", "N2-QUEUE"}, {"missing"}), "N2-QUEUE");
  const Rules reply = {"J3-REPLY", "J3-SEQ", "J3-ADDRESS", "J3-DEST"};
  EXPECT_EQ(blamed(reply, {"differs", "seq_num"}), "J3-SEQ");
  EXPECT_EQ(blamed(reply, {"differs", "am"}), "J3-DEST");
  EXPECT_EQ(blamed(reply, {"missing"}), "J3-REPLY");
}

TEST(Blame, WhatIsLeftForTheLocalIslandGoesToItsWrongAddressToo) {
  const Rules rules = {"N3-LOCAL", "N4-MOTE"};
  EXPECT_EQ(blamed(rules, {"differs", "dest", "am"}), "N3-LOCAL");
  EXPECT_EQ(blamed(rules, {"differs", "am"}), "N4-MOTE");
}

TEST(Blame, WhatWaitedAndIsDeliveredTwiceSaysNothingOfAFullBuffer) {
  const Rules rules = {"N2-IN-FULL", "N2-IN-ORDER"};
  EXPECT_EQ(blamed(rules, {"app", "received", "again"}), "N2-IN-ORDER");
  EXPECT_EQ(blamed(rules, {"app", "received", "new"}), "N2-IN-FULL");
}

TEST(Blame, AReportIsANetMsgOnItsLine) {
  const Rules rules = {"N6-ONCE", "J6-REPEAT"};
  EXPECT_EQ(blamed(rules, {"serial", "net_msg", "new"}), "J6-REPEAT");
  EXPECT_EQ(blamed(rules, {"app", "mote_joined", "new"}), "J6-REPEAT");
  EXPECT_EQ(blamed(rules, {"serial", "net_msg", "again"}), "N6-ONCE");
}

TEST(Blame, AnAckOfAnotherNumberAndWhatIsMissingOnItsOwn) {
  EXPECT_EQ(blamed({"N3-LOCAL", "T3-SUCCESS"}, {"differs", "seq_num"}), "T3-SUCCESS");
  EXPECT_EQ(blamed({"T4-SEVERAL", "T3-SUCCESS"}, {"missing"}), "T4-SEVERAL");
  EXPECT_EQ(blamed({"S1-ALL", "S2-SIGNAL"}, {"missing"}), "S2-SIGNAL");
  EXPECT_EQ(blamed({"T2-ACK", "N8-PEIS"}, {"missing", "unused"}), "N8-PEIS");
  EXPECT_EQ(blamed({"T2-ACK", "N8-PEIS"}, {"missing"}), "T2-ACK") << "PEIS is in use.";
  EXPECT_EQ(blamed({"S5-UNKNOWN", "S2-SIGNAL"}, {"differs", "status"}), "S5-UNKNOWN");
}

TEST(Blame, AnAckThatDiffersIsWrongWhateverItWasAskedFor) {
  Failure next{.requirements = {"N11-NEXT"}};
  blame_one(next, {"differs", "ack", "payload"});
  EXPECT_EQ(next.requirements, Rules{"T2-CONTENT"});
  EXPECT_EQ(next.suspected, Rules{"N11-NEXT"});
  EXPECT_EQ(blamed({"N6-FORWARD"}, {"differs", "ack", "payload"}), "N6-FORWARD") << "Another's.";
  EXPECT_EQ(blamed({"T2-ACK"}, {"differs", "ack", "order"}), "T2-ACK");
}

TEST(Blame, TheFirstOfThoseThatFitAlike) {
  EXPECT_EQ(blamed({"S6-OTHERS", "S6-STOPPED"}, {"radio", "net_msg", "new"}), "S6-OTHERS");
  Failure none;
  blame_one(none, {"missing"});
  EXPECT_TRUE(none.rules().empty());
}

TEST(Blame, LaterFailuresOfANodeAreImplied) {
  std::vector<Failure> failures(5);
  const char* const nodes[] = {"m5", "m5", "sA", "m5", "sA"};
  for (std::size_t i = 0; i < failures.size(); ++i) failures[i].node = nodes[i];
  failures[0].weak = true;
  mark_implied(failures);
  const bool implied[] = {false, false, false, true, true};
  for (std::size_t i = 0; i < failures.size(); ++i) EXPECT_EQ(failures[i].implied, implied[i]) << i;
}

}  // namespace
}  // namespace rubric::runner
