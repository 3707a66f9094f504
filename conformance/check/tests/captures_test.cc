// Captures of lawful nodes that were blamed, and of faulty ones that were not, each beside its
// like.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "conformance/check/observation.h"
#include "conformance/check/tests/testing.h"

namespace rubric::check::captures_test {
namespace {

using machine::kNullDevid;

constexpr auto kSetIsland = static_cast<std::uint8_t>(rubicon::CommandCode::kSetIslandId);

void forwards(Script& script, double ms, std::uint16_t mote, std::uint16_t seq_num) {
  script.net(ms, mote, 1, update(mote, seq_num)).up(ms + 12, update(mote, seq_num).forwarded());
}

// A base station tells the sink its island at `ms`.
void set_island(Script& script, double ms, std::uint16_t island, bool confirmed = true) {
  Payload config{kSetIsland};
  put16(config, island);
  script.serial(ms, true, am::kConfig, config).confirm(confirmed);
}

TEST(Captures, AReportIsLateOrMissing) {
  for (const double ms : {320.0, 2000.0}) {  // It waited that long (decision 125).
    Script script;
    script.request(0, 2, 100).reply(10, 11, 2, 100, 10).ack_join(20, 11, 2, 100).link_ack();
    script.joined(ms, 11, 2);
    forwards(script, 3000, 2, 7);
    EXPECT_EQ(found_in(script), "") << ms;
  }
  Script script;
  script.request(0, 2, 100).reply(10, 11, 2, 100, 10).ack_join(20, 11, 2, 100).link_ack();
  forwards(script, 3000, 2, 7);
  EXPECT_EQ(found_in(script), "F:J6-REPORT");
}

// The sink's island is `to` from now on; its frames go on being counted.
void moves(Script& script, std::uint16_t to) {
  script.dsn[to * 65536U + 1] = script.dsn[11 * 65536U + 1];
}

// A mote joins, the sink's island is set to 13, and another mote joins in `then`.
Script moved(double set_ms, bool confirmed, std::uint16_t then, std::uint32_t clock_ms = 3010) {
  Script script = Script().join(0, 11, 2, 100);
  set_island(script, set_ms, 13, confirmed);
  moves(script, 13);
  script.request(3000, 4, 200).reply(3010, then, 4, 200, clock_ms);
  script.ack_join(3020, then, 4, 200).link_ack().joined(3040, then, 4);
  return script;
}

TEST(Captures, ASinkMayNotHaveHeardOfItsIsland) {
  EXPECT_EQ(found_in(moved(1500, true, 13)), "");
  EXPECT_EQ(found_in(moved(1500, true, 11)), "F:N9-SET");
  EXPECT_EQ(found_in(moved(1500, false, 11)), "I:N9-SET");  // Nothing confirms it.
}

TEST(Captures, ASinkThatLostItsPowerHasItsFirstIsland) {
  EXPECT_EQ(found_in(moved(1500, true, 11, 5)), "I:J3-DRIFT I:N9-SET");
}

// The capture begins when the sink is told its island; its clock and the island of its second life
// are given, and that of a reply to a third mote.
TEST(Captures, ASinkThatLostItsPowerHasAnIslandThatNobodySaw) {
  const auto found = [](std::uint32_t clock_ms, std::uint16_t then, std::uint16_t last) {
    Script script;
    set_island(script, 100, 13);
    script.request(1500, 2, 100).reply(1510, 13, 2, 100, 1510);
    script.dsn[then * 65536U + 1] = script.dsn[13 * 65536U + 1];
    script.request(3000, 4, 200).reply(3010, then, 4, 200, clock_ms);
    script.ack_join(3020, then, 4, 200).link_ack().joined(3040, then, 4);
    script.dsn[last * 65536U + 1] = script.dsn[then * 65536U + 1];
    script.request(4000, 5, 300).reply(4010, last, 5, 300, clock_ms + 1000);
    script.ack_join(4020, last, 5, 300).link_ack().joined(4040, last, 5);
    return found_in(script);
  };
  EXPECT_EQ(found(5, 11, 11), "I:J3-DRIFT I:N9-SET");
  EXPECT_EQ(found(5, 11, 12).substr(0, 28), "I:J3-DRIFT I:N9-SET F:N9-SET") << "It has one island.";
  EXPECT_EQ(found(3010, 11, 11).substr(0, 8), "F:N9-SET") << "Its clock went on.";
}

TEST(Captures, ASinkThatLostItsPowerForwardsForItsFirstIsland) {
  const auto found = [](std::uint8_t dsn, int frames) {
    Script script = Script().join(0, 11, 2, 100).net(500, 2, 1, message({11, 2}, {11, 1}, 5, 1));
    script.net(510, 1, 2, message({11, 2}, {11, 1}, 5, 1).ack(30), 11);
    set_island(script, 1500, 13);
    forwards(script, 3000, 2, 7);
    script.dsn[11 * 65536U + 1] += dsn;
    for (int i = 0; i < frames; ++i) {
      script.net(5000 + 100.0 * i, 1, machine::kAmBroadcast,
                 message({11, 1}, {11, machine::kBroadcastDevid}, static_cast<std::uint16_t>(i)),
                 11);
    }
    return found_in(script, false);
  };
  for (const int frames : {0, 1, 3}) {
    EXPECT_NE(found(0, frames).find("F:N9-SET"), std::string::npos) << found(0, frames);
  }
  for (const int frames : {1, 2, 3, 5}) {  // Its DSNs begin anew.
    EXPECT_EQ(found(100, frames).substr(0, 8), "I:N9-SET") << frames;
    EXPECT_EQ(found(100, frames).find("F:"), std::string::npos) << found(100, frames);
  }
}

TEST(Captures, WhatWasUnderWayShowsTheFormerIsland) {
  EXPECT_EQ(found_in(moved(3005, true, 11)), "F:N9-SET");  // Its ack_join came after.
  Script script = Script().join(0, 11, 2, 100).request(1000, 4, 200).reply(1010, 11, 4, 200, 1010);
  script.ack_join(1020, 11, 4, 200).link_ack();
  set_island(script, 1031, 13);
  script.joined(1040, 11, 4);
  EXPECT_EQ(found_in(script), "");
}

TEST(Captures, TheSameIslandAgainMayForgetMembers) {
  Script script = Script().join(0, 11, 2, 100);
  set_island(script, 1000, 11);
  script.join(2000, 11, 2, 200);
  EXPECT_EQ(found_in(script, false), "I:J5-STOP");
  EXPECT_EQ(found_in(script), "I:J5-STOP");
}

TEST(Captures, AnIslandIsNotTheSinksBeforeItWasSet) {
  Script script;  // The capture begins when the mote is a member.
  forwards(script, 0, 2, 7);
  set_island(script, 1000, 13);
  script.join(2000, 13, 3, 200);
  EXPECT_EQ(found_in(script, false), "");
}

TEST(Captures, AReservedIslandIsNobodys) {
  Script script = Script().join(0, 11, 2, 100).request(1000, 4, 200);
  moves(script, 65534);
  script.reply(1010, 65534, 4, 200, 1010);
  EXPECT_EQ(found_in(script).substr(0, 10), "F:N9-OTHER");
}

TEST(Captures, AfterAJoinRequestNothingIsAwaited) {
  Script script = Script().join(0, 11, 2, 100).net(500, 2, 1, message({11, 2}, {11, 1}, 1, 1));
  script.join(700, 11, 2, 200);
  script.net(900, 2, 1, message({11, 2}, {11, 1}, 1, 1));
  EXPECT_EQ(found_in(script).find("T3-RESEND"), std::string::npos) << found_in(script);
  Script again = Script().join(0, 11, 2, 100).net(500, 2, 1, message({11, 2}, {11, 1}, 1, 1));
  again.net(900, 2, 1, message({11, 2}, {11, 1}, 1, 1));
  EXPECT_NE(found_in(again).find("F:T3-RESEND"), std::string::npos) << found_in(again);
}

// The link repeats a frame within 100 ms.
TEST(Captures, ACopyIsTheLinksOnlySoLong) {
  const auto found = [](double ms) {
    Script script = Script().join(0, 11, 2, 100).net(1000, 2, 1, message({11, 2}, {11, 1}, 1, 1));
    --script.dsn[2];
    script.net(1000 + ms, 2, 1, message({11, 2}, {11, 1}, 1, 1));
    script.net(1000 + ms + 20, 1, 2, message({11, 2}, {11, 1}, 1, 1).ack(5), 11);
    return found_in(script);
  };
  EXPECT_EQ(found(90), "");
  EXPECT_NE(found(600).find("I:T3-RESEND"), std::string::npos) << found(600);
}

TEST(Captures, ALineGoesOnInTheNextFile) {
  Script script = Script().join(0, 11, 2, 100).net(1000, 2, 1, message({11, 2}, {12, 5}, 7));
  set_island(script, 1005, 32);
  script.up(1012, message({11, 2}, {12, 5}, 7).forwarded());
  const auto second = std::ranges::find(script.run.seen, true, &Observation::to_mote);
  const auto rotated = [&](const std::string& name) {
    auto& run = script.run;
    run.files = {"1", "2"};
    run.taps.resize(3);
    run.taps.push_back({name, machine::Link::kSerial, true});
    for (auto seen = second; seen != run.seen.end(); ++seen) {
      seen->place.file = 1;
      seen->tap = 3;
    }
    return found_in(script, false);
  };
  EXPECT_EQ(rotated("serial:1"), "");
  EXPECT_NE(rotated("another"), "");
}

TEST(Captures, AFrameToTheWrongAddressIsItsSendersFault) {
  Payload request;
  put16(request, 100);
  put(request, kDescriptor);
  Script script;
  script.radio(0, 2, machine::kAmBroadcast, am::kJoin, request).reply(10, 11, 2, 100, 10);
  script.ack_join(20, 11, 2, 100).link_ack().joined(40, 11, 2);
  EXPECT_EQ(found_in(script), "F:J1-DEST");
  Script reply = Script().join(0, 11, 3, 50).request(500, 2, 100);
  reply.reply(510, 11, 2, 100, 510, machine::kAmBroadcast).ack_join(520, 11, 2, 100).link_ack();
  reply.joined(540, 11, 2);
  EXPECT_EQ(found_in(reply), "F:J3-DEST");
}

TEST(Captures, AForwardUnderTheSinksOwnName) {
  Script script = Script().join(0, 11, 2, 100).net(500, 2, 1, update(2, 7));
  script.up(512, message({11, 1}, {11, kNullDevid}, 7).forwarded());
  EXPECT_EQ(found_in(script), "F:N6-CONTENT");
}

TEST(Captures, AHostThatSendsUnderAnothersName) {
  const auto from = [](machine::Address src) {
    Script script;
    const NetFields radio = message(src, {11, 2}, 7);
    NetFields line = radio;
    line.size = 114;
    script.join(0, 11, 2, 100).down(500, line).confirm().net(510, 1, 2, radio, 11);
    return found_in(script);
  };
  EXPECT_EQ(from({11, kNullDevid}), "");
  EXPECT_EQ(from({12, 5}), "");  // Through PEIS.
  EXPECT_EQ(from({11, 3}), "W:N1-SRC");
}

TEST(Captures, AMessageThatIsCutShort) {
  Script script = Script().join(0, 11, 2, 100).radio(500, 2, 1, am::kNet, Payload(10, 0));
  EXPECT_EQ(found_in(script), "F:WIRE-NET-HEADER");
}

// The link repeats a frame with its DSN, so that nothing shows that the sniffer missed one copy.
TEST(Captures, ACopyOfAFrameMayHaveEscaped) {
  Script script = Script().join(0, 11, 2, 100);
  forwards(script, 500, 2, 7);
  script.up(524, update(2, 7).forwarded());
  EXPECT_EQ(found_in(script, false), "I:N6-ONCE");
  EXPECT_EQ(found_in(script), "F:N6-ONCE");
}

// Mote 2 acks a message `copy_ms` before the link's copy of it, the first frame that is captured.
Script acked_before(double copy_ms, std::uint16_t acked = 4) {
  Script script = Script().join(0, 11, 2, 100);
  for (std::uint16_t i = 1; i <= 4; ++i) {
    const NetFields down = message({11, 1}, {11, 2}, i, 1);
    NetFields ack = down.ack(static_cast<std::uint16_t>(50 + i));
    if (i == 4) ack = message({11, 1}, {11, 2}, acked, 1).ack(54);
    if (i == 4) script.net(4000 - copy_ms, 2, 1, ack);
    script.radio(1000.0 * i, 1, 2, am::kNet, down.bytes(), 11, true).link_ack();
    if (i < 4) script.net(1000.0 * i + 20, 2, 1, ack);
  }
  forwards(script, 4500, 2, 7);
  return script;
}

TEST(Captures, ACopyComesAfterTheAckOfAFrameThatEscaped) {
  EXPECT_EQ(found_in(acked_before(6), false), "I:T2-CONTENT");
  EXPECT_EQ(found_in(acked_before(6)), "F:T2-CONTENT");
  EXPECT_EQ(found_in(acked_before(300), false), "I:T2-CONTENT F:T2-ACK");
  EXPECT_EQ(found_in(acked_before(6, 9), false), "I:T2-CONTENT F:T2-ACK");
}

TEST(Captures, ACopyComesAfterTheReplyToARequestThatEscaped) {
  const auto answered = [](double copy_ms) {
    Script script = Script().join(0, 11, 3, 50).reply(1000, 11, 2, 100, 1000);
    Payload request;
    put16(request, 100);
    put(request, kDescriptor);
    script.radio(1000 + copy_ms, 2, 1, am::kJoin, request, 0, true).link_ack();
    if (copy_ms < 100) script.ack_join(1010, 11, 2, 100).link_ack().joined(1030, 11, 2);
    script.join(2000, 11, 4, 60);
    return found_in(script, false);
  };
  EXPECT_EQ(answered(3).find("F:"), std::string::npos) << answered(3);
  EXPECT_NE(answered(300).find("F:J3-REPLY"), std::string::npos) << answered(300);
}

// Messages 1 to 3 to mote 2, all confirmed by its link; it acks those of `acked`.
Script acks(const std::vector<std::uint16_t>& acked) {
  Script script = Script().join(0, 11, 2, 100);
  for (std::uint16_t i = 1; i <= 3; ++i) {
    const NetFields down = message({11, 1}, {11, 2}, i, 1);
    script.radio(1000.0 * i, 1, 2, am::kNet, down.bytes(), 11, true).link_ack();
    for (const std::uint16_t number : acked) {
      if (number == i)
        script.net(1000.0 * i + 20, 2, 1, down.ack(static_cast<std::uint16_t>(50 + i)));
    }
  }
  forwards(script, 4500, 2, 7);
  return script;
}

TEST(Captures, AMoteThatAckedBeforeOwesAnAck) {
  EXPECT_EQ(found_in(acks({1, 2, 3})), "");
  EXPECT_EQ(found_in(acks({1, 3})), "F:T2-ACK");
  EXPECT_EQ(found_in(acks({2, 3})), "I:T2-ACK");  // Perhaps its application came later.
}

// Mote 2 of island 11 acks a message of island 12 for its devid, under an address of `island`; so
// many of its frames before that escaped.
Script acks_foreign(std::uint16_t island, std::uint8_t escaped) {
  Script script = Script().join(0, 11, 2, 100).join(500, 12, 3, 200, 2);
  forwards(script, 1000, 2, 6);
  script.dsn[2] += escaped;
  const NetFields foreign = message({12, 3}, {12, 2}, 5, 1);
  NetFields ack = foreign.ack(50);
  ack.src = {island, 2};
  script.net(5000, 3, 2, foreign).net(5015, 2, 3, ack);
  for (std::uint16_t i = 8; i < 11; ++i) {
    script.net(5000 + 100.0 * i, 2, 1, message({island, 2}, {island, 1}, i));
  }
  return script;
}

TEST(Captures, AMoteMayHaveJoinedAnotherIslandUnseen) {
  const auto has = [](const Script& script, const std::string& finding) {
    return found_in(script, false).find(finding) != std::string::npos;
  };
  EXPECT_TRUE(has(acks_foreign(12, 90), "I:N5-FOREIGN"));
  EXPECT_FALSE(has(acks_foreign(12, 90), "F:"));
  EXPECT_TRUE(has(acks_foreign(12, 0), "F:N5-FOREIGN"));
  EXPECT_TRUE(has(acks_foreign(11, 2), "F:N5-FOREIGN"));
}

TEST(Captures, AMoteThatAsksOnAfterAnOfferThatItHad) {
  Script script = Script().join(0, 11, 3, 50).request(1000, 2, 100).reply(1010, 11, 2, 100, 1010);
  script.run.seen.back().ack_request = true;
  script.link_ack();
  for (const double ms : {1490.0, 1980.0}) script.request(ms, 2, 100);
  EXPECT_EQ(found_in(script).substr(0, 8), "F:J4-ACK");
}

// Sink and mote lose their power at 3 s, and the mote joins anew; `more` others follow.
Script rebooted(int more) {
  Script script = Script().join(0, 11, 2, 100).join(1000, 11, 3, 200);
  script.dsn[11 * 65536U + 1] = script.dsn[2] = 90;
  for (int i = 0; i <= more; ++i) {
    const double ms = 5000 + 1000.0 * i;
    const auto mote = static_cast<std::uint16_t>(i == 0 ? 2 : 10 + i);
    const auto number = static_cast<std::uint16_t>(300 + i);
    script.request(ms, mote, number);
    script.reply(ms + 10, 11, mote, number, 500 + 1000 * static_cast<std::uint32_t>(i));
    script.ack_join(ms + 20, 11, mote, number).link_ack().joined(ms + 40, 11, mote);
  }
  return script;
}

TEST(Captures, ARebootedSinkHeardWhatItsFirstFrameAnswers) {
  EXPECT_EQ(found_in(rebooted(2)), "");
  EXPECT_EQ(found_in(rebooted(0)), "S:");  // An unknown sender: too few frames to know it by.
}

TEST(Captures, AMessageForEveryIslandMayBeSentOnOnce) {
  Script script;
  const NetFields all = message({11, 2}, {machine::kBroadcastPid, machine::kBroadcastDevid}, 7);
  script.join(0, 11, 2, 100).net(500, 2, 1, all).net(510, 1, machine::kAmBroadcast, all, 11);
  EXPECT_EQ(found_in(script), "");
  script.net(700, 1, machine::kAmBroadcast, all, 11);
  EXPECT_EQ(found_in(script), "F:N6-ONCE");
}

TEST(Captures, AReplyInTheNameOfAnIslandThatNobodyHas) {
  const auto offers = [](std::uint16_t island) {
    Script script = Script().join(0, 11, 2, 100).request(1000, 3, 200);
    script.dsn[island * 65536U + 1] = script.dsn[11 * 65536U + 1]++;
    script.reply(1010, island, 3, 200, 1010).join(3000, 11, 4, 300);
    return found_in(script);
  };
  EXPECT_EQ(offers(12), "F:J3-ADDRESS");
}

TEST(Captures, AReportIsOvertakenByAnother) {
  Script script;
  script.request(0, 2, 100).reply(10, 11, 2, 100, 10).ack_join(20, 11, 2, 100).link_ack();
  script.join(1000, 11, 3, 200);
  EXPECT_EQ(found_in(script), "F:J6-REPORT");
}

TEST(Captures, AnAckOfANumberThatNoMessageHad) {
  Script script;
  const NetFields up = message({11, 2}, {11, 1}, 5, 1);
  NetFields wrong = up;
  wrong.seq_num = 0x500;
  script.join(0, 11, 2, 100).net(500, 2, 1, up).link_ack().net(510, 1, 2, wrong.ack(30), 11);
  EXPECT_EQ(found_in(script), "F:T2-CONTENT");
}

// Sinks of islands 11 and 12 are in range; `then` adds what one of them does.
template <class Then>
std::string of_two_sinks(Then then) {
  Script script;
  script.dsn[12 * 65536U + 1] = 120;
  for (const std::uint32_t tap : {1U, 2U}) {  // Their hosts' frames are in the run.
    Payload config{kSetIsland};
    put16(config, 10 + tap);
    script.serial(tap, true, am::kConfig, config, tap).confirm();
  }
  script.join(100, 11, 2, 100).join(500, 12, 3, 200, 2);
  then(script);
  script.join(3000, 11, 4, 300).join(3500, 12, 5, 400, 2);
  return found_in(script);
}
// The next frame in the name of island 11 is the one of island 12.
void is_of_12(Script& script) { script.dsn[11 * 65536U + 1] = script.dsn[12 * 65536U + 1]++; }

TEST(Captures, ASinkThatSpeaksInTheNameOfAnotherOne) {
  const auto replies = [](Script& script) {
    const std::uint8_t own = script.dsn[11 * 65536U + 1];
    script.request(2000, 7, 5);
    is_of_12(script);
    script.reply(2005, 11, 7, 5, 2005);
    script.dsn[11 * 65536U + 1] = own;
  };
  EXPECT_EQ(of_two_sinks(replies), "F:N9-SET");
  const auto radiates = [](Script& script) {
    const std::uint8_t own = script.dsn[11 * 65536U + 1];
    is_of_12(script);
    script.net(2000, 1, 2, message({11, 1}, {11, 2}, 9), 11);
    script.dsn[11 * 65536U + 1] = own;
  };
  EXPECT_EQ(of_two_sinks(radiates), "F:N7-CONTENT");
}

// Two motes with devid 9 ask at once; both sinks answer both. The first takes the offer of island
// 12, and the second, if it `acks`, that of island 11; sink 12 announces its member.
void namesakes(Script& script, bool acks, bool first = true) {
  script.dsn[9] = 20;
  script.dsn[65536U + 9] = 90;
  script.request(2000, 9, 500).reply(2010, 12, 9, 500, 2010).reply(2013, 11, 9, 500, 2013);
  script.mote_key = 1;
  script.request(2019, 9, 900);
  script.mote_key = 0;
  if (first) script.ack_join(2021, 12, 9, 500).link_ack();
  script.reply(2025, 12, 9, 900, 2025).reply(2027, 11, 9, 900, 2027);
  script.mote_key = 1;
  if (acks) script.ack_join(2038, 11, 9, 900).link_ack();
  script.mote_key = 0;
  script.joined(2050, 12, 9, 2);
  if (acks) script.joined(2055, 11, 9, 1);
  for (std::uint16_t i = 0; i < 4; ++i) {
    const double ms = 2200 + 100.0 * i;
    const NetFields one = message({12, 9}, {12, kNullDevid}, i);
    const NetFields other = message({11, 9}, {11, kNullDevid}, i);
    if (first) script.net(ms, 9, 1, one).up(ms + 12, one.forwarded(), 2);
    if (acks) script.net(ms + 50, 9, 1, other, 1).up(ms + 62, other.forwarded(), 1);
  }
}

TEST(Captures, TwoMotesWithOneDevidAskAtOnce) {
  const auto found = [](bool first) {
    return of_two_sinks([&](Script& script) { namesakes(script, true, first); });
  };
  EXPECT_EQ(found(true), "I:J6-SEQ");
  EXPECT_NE(found(false).find("F:J6-ISLAND"), std::string::npos) << found(false);
}

TEST(Captures, AReportThatNamesAnIslandOfNobody) {
  Script script;
  script.request(0, 2, 100).reply(10, 267, 2, 100, 10).ack_join(20, 267, 2, 100).link_ack();
  NetFields report = message({267, 2}, {267, kNullDevid}, 0);
  report.app_id = 10;
  report.body = {16};
  put(report.body, machine::Address{11, 2});
  put(report.body, kDescriptor);
  script.up(40, report.forwarded()).join(1000, 267, 3, 200);
  EXPECT_EQ(found_in(script), "F:J6-CONTENT");
}

TEST(Captures, AMessageTooShortForItsPartsIsSentOn) {
  for (const int nbytes : {0, 1, 103}) {
    Script script;
    NetFields line = message({11, kNullDevid}, {11, 2}, 5);
    line.nbytes = nbytes;
    NetFields radio = line;
    radio.body.resize(nbytes > 2 ? 100 : 0);
    line.size = 114;
    line.body = radio.body;
    script.join(0, 11, 2, 100).down(1000, line).confirm();
    Payload bytes = radio.bytes();
    bytes.resize(kNetHeaderBytes + static_cast<std::size_t>(std::min(nbytes, 102)));
    script.radio(1020, 1, 2, am::kNet, bytes, 11);
    EXPECT_NE(found_in(script).find("F:N11-NBYTES"), std::string::npos) << nbytes;
    EXPECT_EQ(found_in(script).find("N7-CONTENT"), std::string::npos) << nbytes;
  }
}

TEST(Captures, ACallThatChangesItsDescriptor) {
  const machine::Descriptor other{2, 1, 0x43};
  Script script = Script().request(0, 2, 9).request(489, 2, 9, other).request(978, 2, 9, other);
  EXPECT_NE(found_in(script).find("W:J1-SEQ"), std::string::npos) << found_in(script);
  Script same = Script().request(0, 2, 9).request(489, 2, 9).request(5000, 2, 10, other);
  EXPECT_EQ(found_in(same).find("W:J1-SEQ"), std::string::npos) << found_in(same);
}

TEST(Captures, AMemberThatLostItsPowerIsNone) {
  Script script = Script().join(0, 11, 2, 100).join(500, 11, 3, 200);
  script.dsn[2] = 200;
  for (std::uint16_t i = 0; i < 3; ++i) forwards(script, 2000 + 500 * i, 2, i);
  EXPECT_EQ(found_in(script), "F:J11-SEND");
  EXPECT_EQ(found_in(script, false), "");  // Frames may have escaped, a join among them.
}

// Mote 2 joins, sends two messages, and loses its power; the island is set to another and back, so
// that the sink forgets it. It joins anew from the DSN `first` on, and sends messages.
Script reborn(std::uint8_t first, bool joins = true) {
  Script script = Script().join(0, 11, 2, 100).join(500, 11, 3, 200);
  for (std::uint16_t i = 0; i < 2; ++i)
    forwards(script, 1000 + 300 * i, 2, i);  // Its DSNs are 0-3.
  set_island(script, 2000, 12);
  set_island(script, 2200, 11);
  script.dsn[2] = first;
  if (joins) script.join(4000, 11, 2, 300);
  for (std::uint16_t i = 10; i < 30; ++i) forwards(script, 1000 + 400 * i, 2, i);
  return script;
}

TEST(Captures, ARebootedMoteComesToItsOldDsnsAgain) {
  for (int first = 250; first < 260; ++first) {
    const auto dsn = static_cast<std::uint8_t>(first);
    EXPECT_EQ(found_in(reborn(dsn)), "") << first;
    EXPECT_EQ(found_in(reborn(dsn), false), "") << first;
  }
  for (const int first : {252, 253, 254, 255, 256, 257, 200}) {
    const auto dsn = static_cast<std::uint8_t>(first);
    EXPECT_EQ(found_in(reborn(dsn, false)), "F:J11-SEND") << first;
  }
}

TEST(Captures, ARequestAfterARebootHasTheLastDsnBeforeIt) {
  for (const int asked : {1, 2, 3}) {  // The first ones get no answer.
    Script script = Script().join(0, 11, 2, 100).join(500, 11, 3, 200);
    set_island(script, 2000, 12);
    set_island(script, 2200, 11);
    --script.dsn[2];
    for (int i = 1; i < asked; ++i) script.request(4000 - 500.0 * i, 2, 300);
    std::ranges::sort(script.run.seen, {}, [](const auto& seen) { return seen.place.time_us; });
    script.join(4000, 11, 2, 300);
    for (std::uint16_t i = 10; i < 20; ++i) forwards(script, 1000 + 400 * i, 2, i);
    EXPECT_EQ(found_in(script, false).find("F:"), std::string::npos) << found_in(script, false);
  }
}

TEST(Captures, ASinkThatGetsTheIslandOfAnotherKeepsItsLine) {
  Script script;
  script.dsn[12 * 65536U + 1] = 120;
  script.join(0, 11, 2, 100).join(500, 12, 3, 200, 2);
  Payload config{kSetIsland};
  put16(config, 11);
  script.serial(1000, true, am::kConfig, config, 2).confirm();
  std::swap(script.dsn[11 * 65536U + 1], script.dsn[12 * 65536U + 1]);
  script.join(2000, 11, 6, 300, 2);
  std::swap(script.dsn[11 * 65536U + 1], script.dsn[12 * 65536U + 1]);
  script.join(3000, 11, 4, 400);
  EXPECT_EQ(found_in(script), "");
}

TEST(Captures, ARebootedSinkThatBeginsInTheNameOfAnotherIsland) {
  Script script = Script().join(0, 11, 2, 100).join(500, 11, 3, 200);
  script.dsn[12 * 65536U + 1] = 200;
  script.request(2000, 7, 5).reply(2005, 12, 7, 5, 300);
  script.dsn[11 * 65536U + 1] = 201;
  for (std::uint16_t i = 0; i < 3; ++i) {
    const double ms = 3000 + 500.0 * i;
    const auto mote = static_cast<std::uint16_t>(20 + i);
    script.request(ms, mote, mote).reply(ms + 5, 11, mote, mote, 1300 + 500U * i);
    script.ack_join(ms + 11, 11, mote, mote).link_ack().joined(ms + 19, 11, mote);
  }
  EXPECT_EQ(found_in(script), "F:J3-ADDRESS");
}

}  // namespace
}  // namespace rubric::check::captures_test
