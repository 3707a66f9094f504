// Captures alone, without a log: a node that breaks a rule is found, and nodes that are prompt,
// slow, late or unlucky but keep it are not blamed.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "conformance/check/observation.h"
#include "conformance/check/tests/failures.h"
#include "conformance/check/tests/testing.h"

namespace rubric::check::passive_test {
namespace {

using machine::kNullDevid;

std::vector<Finding> findings_of(const Script& script, Severity severity,
                                 const Options& options = {}) {
  std::vector<Finding> out;
  for (const Finding& finding : judge(script.run, options).findings) {
    if (finding.severity == severity) out.push_back(finding);
  }
  return out;
}

std::string failures_of(const Script& script, const Options& options = {}) {
  return rules_of(findings_of(script, Severity::kFail, options));
}

NetFields to_mote(std::uint16_t seq_num) { return message({11, kNullDevid}, {11, 2}, seq_num); }

// J6-REPORT: mote 2 is confirmed at 20 ms; mote 3 joins at 1000 ms and is reported.
Script two_joins(const std::function<void(Script&)>& report_of_2, bool confirmed = true) {
  Script script = Script().request(0, 2, 100).reply(10, 11, 2, 100, 10).ack_join(20, 11, 2, 100);
  if (confirmed) script.link_ack();
  report_of_2(script);
  script.join(1000, 11, 3, 200).net(1500, 3, 1, update(3, 1)).up(1515, update(3, 1).forwarded());
  return script;
}

TEST(Passive, AMemberThatIsNeverReportedWhileALaterOneIs) {
  const auto never = [](Script&) {};
  EXPECT_EQ(failures_of(two_joins(never)), "J6-REPORT");
  for (const double ms : {21.0, 40.0, 310.0}) {  // Prompt, usual, late.
    EXPECT_EQ(failures_of(two_joins([&](Script& s) { s.joined(ms, 11, 2); })), "");
  }
  EXPECT_EQ(failures_of(two_joins(never, false)), "");  // It may not have arrived.
  // Its repetition is reported.
  EXPECT_EQ(failures_of(two_joins(
                [](Script& s) { s.ack_join(280, 11, 2, 100).link_ack().joined(500, 11, 2); })),
            "");
}

// A capture that misses other things of the line may miss the report as well; one that misses next
// to nothing does not.
TEST(Passive, AReportMayBeWhereOtherFramesOfTheLineAre) {
  const auto with = [](std::uint16_t messages, bool up, bool down) {
    Script script = two_joins([](Script&) {});
    for (std::uint16_t i = 2; i <= messages; ++i) {
      script.net(1500 + 20 * i, 3, 1, update(3, i));
      if (up || i > 2) script.up(1515 + 20 * i, update(3, i).forwarded());
    }
    if (down) script.down(5000, to_mote(7));
    script.net(5010, 1, 2, to_mote(7), 11).net(6000, 3, 1, update(3, 900));
    return script.up(6015, update(3, 900).forwarded());
  };
  EXPECT_EQ(failures_of(with(20, true, true)), "J6-REPORT");
  EXPECT_EQ(failures_of(with(20, false, true)), "");
  EXPECT_EQ(failures_of(with(20, true, false)), "");
  EXPECT_EQ(failures_of(with(100, false, true)), "J6-REPORT");
}

TEST(Passive, OneThatIsReportedAfterALaterOneIsNotMissing) {
  Script script;
  script.request(0, 2, 100).reply(10, 11, 2, 100, 10).ack_join(20, 11, 2, 100).link_ack();
  script.request(50, 3, 200).reply(60, 11, 3, 200, 60).ack_join(70, 11, 3, 200).link_ack();
  script.joined(90, 11, 3).joined(250, 11, 2);
  script.net(1500, 3, 1, update(3, 1)).up(1515, update(3, 1).forwarded());
  EXPECT_EQ(failures_of(script), "");
}

TEST(Passive, WithoutALaterOneItsListMayBeFull) {
  Script script;
  script.request(0, 2, 100).reply(10, 11, 2, 100, 10).ack_join(20, 11, 2, 100).link_ack();
  script.net(1500, 2, 1, update(2, 1)).up(1515, update(2, 1).forwarded());
  EXPECT_EQ(failures_of(script), "");
  EXPECT_EQ(rules_of(findings_of(script, Severity::kInconclusive)), "J6-REPORT");
}

// J3-TIME and J3-DRIFT: replies with these values of cur_time, 600 ms apart, or so many.
std::string replies(const std::vector<std::uint32_t>& clock, double apart_ms = 600) {
  Script script;
  for (std::size_t i = 0; i < clock.size(); ++i) {
    const auto mote = static_cast<std::uint16_t>(2 + i);
    const double ms = apart_ms * static_cast<double>(i);
    script.request(ms, mote, 100).reply(ms + 10, 11, mote, 100, clock[i]);
  }
  const std::string weak = rules_of(findings_of(script, Severity::kWeak));
  return failures_of(script) + (weak.empty() ? "" : " " + weak);
}

TEST(Passive, AClockThatStandsStillFromOneReplyToTheNext) {
  EXPECT_EQ(replies({10, 10, 10}), "J3-TIME");
  EXPECT_EQ(replies({10, 610, 610, 610}), "J3-TIME");
  EXPECT_EQ(replies({10, 610, 1210, 1810}), "");
  EXPECT_EQ(replies({1000, 1000, 2000, 2000, 3000}), "");        // It counts seconds.
  EXPECT_EQ(replies({10, 624, 1239, 1853}), "");                 // Binary ms.
  EXPECT_EQ(replies({0xFFFFFF00, 0xFFFFFF00, 0x00000200}), "");  // It wraps.
}

// A reboot starts it anew, which no capture shows: it may be that old, whatever it said before.
TEST(Passive, AClockThatMayHaveBegunAnew) {
  EXPECT_EQ(replies({500, 100'000}, 200'000), "");
  EXPECT_EQ(replies({90'000, 500}, 200'000), "");
  EXPECT_EQ(replies({500, 700'000'000}, 60 * 86'400'000.0), "");
  EXPECT_EQ(replies({150'000, 203'000}, 200'000), " J3-DRIFT");  // It would be older than that.
}

TEST(Passive, AClockThatWrapsWhileNothingIsSeen) {
  constexpr double kDayMs = 86'400'000;
  const auto all = [](const std::vector<std::uint32_t>& clock, double days) {
    return replies(clock, days * kDayMs);
  };
  EXPECT_EQ(all({10, 2'592'000'010}, 30), "");
  EXPECT_EQ(all({10, 889'032'714}, 60), "");  // 2^32 ms are 49.7 days.
  EXPECT_EQ(all({10, 889'052'714}, 60), "");
  EXPECT_EQ(all({10, 10}, 30), "J3-TIME");
  EXPECT_EQ(all({10, 10}, 60), "J3-TIME");
  EXPECT_EQ(all({10, 2'700'000'000}, 30), " J3-DRIFT");
}

// N7-RADIO: a message comes down the line at 500 ms; `after` is what the sink does then.
Script down_one(const std::function<void(Script&)>& after, bool confirmed = true) {
  Script script = Script().join(0, 11, 2, 100).down(500, to_mote(7));
  if (confirmed) script.confirm();
  after(script);
  return script;
}
void radiates(Script& script, double ms) { script.net(ms, 1, 2, to_mote(7), 11); }
void answers(Script& script, double ms) {
  script.request(ms - 10, 3, 200).reply(ms, 11, 3, 200, static_cast<std::uint32_t>(ms));
}

TEST(Passive, WhatCameDownALineLeavesByRadio) {
  EXPECT_EQ(failures_of(down_one([](Script& s) { answers(s, 900); })), "N7-RADIO");
  EXPECT_EQ(failures_of(down_one([](Script& s) {
              answers(s, 600);
              s.net(900, 1, 2, message({11, 1}, {11, 2}, 50), 11);
            })),
            "N7-RADIO");
  for (const double ms : {505.0, 600.0, 790.0}) {  // Prompt, usual, backing off.
    EXPECT_EQ(failures_of(down_one([&](Script& s) {
                radiates(s, ms);
                answers(s, 900);
              })),
              "");
  }
  EXPECT_EQ(failures_of(down_one([](Script& s) {  // Behind another frame.
              answers(s, 700);
              radiates(s, 780);
            })),
            "");
  Script early;  // By taps whose clocks differ.
  early.join(0, 11, 2, 100);
  radiates(early, 470);
  early.down(500, to_mote(7)).confirm();
  answers(early, 900);
  EXPECT_EQ(failures_of(early), "");
  EXPECT_EQ(failures_of(down_one([](Script&) {})), "");                      // The end.
  EXPECT_EQ(failures_of(down_one([](Script& s) { answers(s, 700); })), "");  // Too soon to say.
}

TEST(Passive, LifeOnTheOtherLineShowsWhatIsMissing) {
  const auto unseen = [](Script script, bool two_files) {
    script.run.files = {"radio", "line"};
    for (Observation& seen : script.run.seen) {
      seen.place.file = two_files && seen.kind == Observation::Kind::kSerial ? 1 : 0;
    }
    return failures_of(script) + rules_of(findings_of(script, Severity::kInconclusive)) + " " +
           failures_of(script, complete());
  };
  const auto forwards = [](Script& s) {
    s.net(900, 2, 1, update(2, 8)).link_ack().up(912, update(2, 8).forwarded());
  };
  EXPECT_EQ(unseen(down_one(forwards), false), "N7-RADIO N7-RADIO");
  EXPECT_EQ(unseen(down_one(forwards), true), "N7-RADIO ") << "One recorder may end before.";
  Script script = Script().join(0, 11, 2, 100).net(500, 2, 1, update(2, 8)).link_ack();
  EXPECT_EQ(unseen(script, false), " ") << "The end.";
  answers(script, 1200);
  EXPECT_EQ(unseen(script, false), "N6-FORWARD N6-FORWARD");
  EXPECT_EQ(unseen(script, true), "N6-FORWARD ");
}

TEST(Passive, WhatNobodyConfirmedMayNotHaveArrived) {
  const Script script = down_one([](Script& s) { answers(s, 900); }, false);
  EXPECT_EQ(failures_of(script), "");
  EXPECT_EQ(rules_of(findings_of(script, Severity::kInconclusive)), "N7-RADIO");
}

// The sink radiates a message of its own to its base station, which that one may have handed down.
Script own_by_radio(const std::function<void(Script&)>& line, double ms = 600) {
  Script script = Script().join(0, 11, 2, 100);
  line(script);
  script.net(ms, 1, 2, message({11, 1}, {12, 2}, 50), 11);
  return script;
}

TEST(Passive, ALineOfWhichFramesAreMissingProvesNoAbsence) {
  const auto whole = [](Script& s) {
    s.down(400, to_mote(7)).confirm().net(405, 1, 2, to_mote(7), 11);
  };
  EXPECT_EQ(failures_of(own_by_radio(whole)), "N6-OWN");
  const auto number_missing = [&](Script& s) {
    s.down(300, to_mote(6)).confirm().net(305, 1, 2, to_mote(6), 11);
    ++s.serial_number;
    whole(s);
  };
  EXPECT_EQ(failures_of(own_by_radio(number_missing)), "");
  const auto confirmation_missing = [&](double next_ms) {
    const auto line = [&](Script& s) {
      s.down(300, to_mote(6)).confirm(false).net(305, 1, 2, to_mote(6), 11);
      s.down(next_ms, to_mote(7)).confirm().net(next_ms + 5, 1, 2, to_mote(7), 11);
    };
    return failures_of(own_by_radio(line, next_ms + 200));
  };
  EXPECT_EQ(confirmation_missing(400), "");
  EXPECT_EQ(confirmation_missing(1240), "");
  EXPECT_EQ(confirmation_missing(1300), "N6-OWN");  // The host waited for it as long as it does.
}

// Only what the sink sends up its line is captured: its host's messages are not.
TEST(Passive, ALineOfAForwarderLacksItsOtherClientsAndThatIsSaidOnce) {
  Script script = Script().join(0, 11, 2, 100);
  for (std::uint16_t i = 0; i < 20; ++i) {
    NetFields up = update(2, i);
    up.reliable = 1;
    const double ms = 500 + 700.0 * i;
    script.net(ms, 2, 1, up).up(ms + 15, up.forwarded());
    script.up(ms + 300,
              message({11, kNullDevid}, {11, 1}, i).ack(static_cast<std::uint16_t>(100 + i)));
  }
  const std::vector<Finding> open = findings_of(script, Severity::kInconclusive);
  ASSERT_EQ(open.size(), 1U);
  EXPECT_EQ(open[0].requirement, ReqId::kNone);
  EXPECT_NE(open[0].text.find("40 things"), std::string::npos) << open[0].text;
  EXPECT_EQ(failures_of(script), "");
}

// Nothing shows of which island the sink was before (decision 126).
TEST(Passive, WhatASinkDidBeforeItsIslandWasSetIsOpen) {
  const NetFields away = message({11, 5}, {12, 3}, 51);
  for (const bool late : {false, true}) {
    Script script;
    if (!late) script.net(50, 5, 1, away).up(60, away.forwarded());
    script.up(70, message({11, 6}, {12, 3}, 52).forwarded());
    if (late) script.net(4990, 5, 1, away);
    script.serial(5000, true, am::kConfig, {10, 1, 11}).confirm();
    if (late) script.up(5010, away.forwarded());
    script.join(6000, 267, 6, 55).net(8000, 6, 1, message({267, 6}, {267, kNullDevid}, 3));
    script.up(8010, message({267, 6}, {267, kNullDevid}, 3).forwarded());
    EXPECT_EQ(failures_of(script), "") << late;
    // From then on it is known.
    script.net(9000, 5, 1, message({11, 5}, {12, 3}, 53));
    script.up(9010, message({11, 5}, {12, 3}, 53).forwarded());
    EXPECT_EQ(failures_of(script), "N6-COLLISION") << late;
  }
}

TEST(Passive, WhatASinkReportsOutranksTheNamesThatHostsWrite) {
  Script script = Script().down(50, message({12, kNullDevid}, {12, 7}, 9)).confirm();
  script.join(100, 11, 5, 300).join(1000, 11, 6, 301);
  script.net(2000, 5, 1, message({11, 5}, {11, kNullDevid}, 44));
  script.up(2010, message({11, 5}, {11, kNullDevid}, 44).forwarded());
  EXPECT_EQ(failures_of(script), "");
}

TEST(Passive, AReceiverThatDiedIsOneFinding) {
  Script script = Script().join(0, 11, 2, 100).join(100, 11, 3, 200);
  for (std::uint16_t i = 0; i < 12; ++i) {
    NetFields down = message({11, 1}, {11, 3}, i);
    down.reliable = 1;
    script.net(500 + 1200.0 * i, 1, 3, down, 11);
  }
  const std::vector<Finding> open = findings_of(script, Severity::kInconclusive);
  ASSERT_EQ(open.size(), 1U);
  EXPECT_EQ(rules_of(open), "T2-ACK");
  EXPECT_NE(open[0].text.find("Nothing of mote 3 is seen"), std::string::npos) << open[0].text;
  EXPECT_NE(open[0].text.find("12 things"), std::string::npos) << open[0].text;
}

TEST(Passive, AnAckOnItsWayEndsNoWait) {
  const auto again = [](bool relayed, bool link_ack) {
    const NetFields asked = message({11, 2}, {11, kNullDevid}, 700, 1);
    Script script = Script().join(0, 11, 2, 100);
    script.net(500, 2, 1, asked).up(512, asked.forwarded()).down(540, asked.ack(40)).confirm();
    if (relayed) script.net(560, 1, 2, asked.ack(40), 11);
    if (link_ack) script.link_ack();
    script.net(900, 2, 1, asked);
    if (!relayed) script.net(1000, 1, 2, asked.ack(40), 11);
    script.up(1012, asked.forwarded());
    return found_in(script);
  };
  EXPECT_NE(again(false, false).find("F:T3-RESEND"), std::string::npos) << again(false, false);
  EXPECT_NE(again(true, false).find("I:T3-RESEND"), std::string::npos) << "It may be lost.";
  EXPECT_EQ(again(true, true).find("T3-RESEND"), std::string::npos) << again(true, true);
}

TEST(Passive, AMemberMaySendBeforeItsAckJoinHasLeft) {
  const auto sends = [](bool acks) {
    Script script = Script().request(0, 2, 100).reply(10, 11, 2, 100, 10);
    script.net(15, 2, 1, update(2, 7)).up(27, update(2, 7).forwarded());
    if (acks) script.ack_join(35, 11, 2, 100).link_ack().joined(60, 11, 2);
    return found_in(script);
  };
  EXPECT_EQ(sends(true), "");
  EXPECT_NE(sends(false).find("F:J4-ACK"), std::string::npos) << sends(false);
}

TEST(Passive, AHostThatNobodyHearsMaySetTheIsland) {
  Script script;  // Of the line only what the sink sends is captured.
  script.join(0, 11, 2, 100).join(2000, 30, 3, 200);
  script.net(3000, 3, 1, message({30, 3}, {30, kNullDevid}, 7));
  script.up(3012, message({30, 3}, {30, kNullDevid}, 7).forwarded());
  EXPECT_EQ(found_in(script), "I:");
  script.down(4000, message({30, kNullDevid}, {30, 3}, 9));
  EXPECT_NE(found_in(script).find("F:"), std::string::npos) << found_in(script);
}

void tell(Script& script, double ms, std::uint8_t island) {
  script.serial(ms, true, am::kConfig, {10, 0, island}).confirm();
}

// A sink that was told island 12, and took it, says later that it is of island 8, which nobody saw.
// What comes damaged may be what is missing: a packet down the line, or a copy by radio.
TEST(Passive, WhatCameDamagedMayBeTheCause) {
  for (const bool damaged : {true, false}) {
    const auto damage = [&](Script& script) {
      if (damaged) script.run.seen.back().kind = Observation::Kind::kDamaged;
    };
    Script script;
    script.join(0, 11, 2, 100).down(500, to_mote(7)).confirm();
    radiates(script, 510);
    Script again = script;
    again.serial(600, true, am::kConfig, {});
    damage(again);
    radiates(again, 610);
    EXPECT_EQ(failures_of(again, complete()), damaged ? "" : "N2-ONCE");
    Script moved = script;  // By SET_ISLAND_ID.
    moved.serial(1000, true, am::kConfig, {});
    damage(moved);
    const NetFields net = message({13, 3}, {13, kNullDevid}, 7);
    moved.net(3000, 3, 1, net).up(3015, net.forwarded());
    EXPECT_EQ(failures_of(moved, complete()), damaged ? "" : "J11-SEND N6-COLLISION");
    Script copies = script;
    copies.net(700, 2, 1, update(2, 5));
    damage(copies);
    if (!damaged) copies.run.seen.pop_back();
    --copies.dsn[2];
    copies.net(710, 2, 1, update(2, 5)).up(725, update(2, 5).forwarded());
    copies.up(740, update(2, 5).forwarded());
    EXPECT_EQ(failures_of(copies, complete()), damaged ? "" : "N6-ONCE");
  }
}

TEST(Passive, ASinkThatIsNotHeardAgainMayHaveLostItsPower) {
  const auto says = [](bool heard) {
    Script script;
    tell(script, 100, 12);
    script.join(500, 12, 2, 100).up(5000, message({8, 1}, {12, kNullDevid}, 6).forwarded());
    if (heard) {
      script.net(6000, 1, machine::kAmBroadcast,
                 message({12, 1}, {12, machine::kBroadcastDevid}, 7), 12);
    }
    NetFields down = message({12, kNullDevid}, {12, 1}, 9);
    down.size = 114;
    script.down(7000, down).confirm();
    return found_in(script);
  };
  EXPECT_EQ(says(false), "I:N9-SET") << "Its base station goes on with island 12.";
  EXPECT_EQ(says(true), "F:N9-SET");
}

TEST(Passive, ASinkThatIsToldItsIslandAgainHasNoOther) {
  Script script;  // An ack from another island, whose way down the line is not captured.
  script.join(0, 11, 2, 100);
  tell(script, 1000, 11);
  const NetFields asked = message({11, 2}, {12, 1}, 7, 1);
  script.net(1100, 2, 1, asked).up(1112, asked.forwarded()).net(1200, 1, 2, asked.ack(40), 11);
  EXPECT_EQ(found_in(script, false).find("F:"), std::string::npos) << found_in(script, false);
}

TEST(Passive, ASinkThatBeginsAnewActsForItsFirstIsland) {
  const auto acts = [](bool anew) {
    Script script = Script().join(0, 7, 2, 100);
    tell(script, 500, 11);
    script.dsn[11 * 65536U + 1] = script.dsn[7 * 65536U + 1];
    script.join(1000, 11, 3, 200);
    script.dsn[7 * 65536U + 1] = static_cast<std::uint8_t>(script.dsn[11 * 65536U + 1] + 99 * anew);
    const NetFields passed = message({7, 2}, {7, kNullDevid}, 8);
    script.net(5000, 2, 1, passed).up(5012, passed.forwarded());
    const NetFields asked = message({7, 2}, {7, 1}, 9, 1);
    script.net(6000, 2, 1, asked).net(6040, 1, 2, asked.ack(50), 7);
    return found_in(script);
  };
  EXPECT_EQ(acts(true).find("F:"), std::string::npos) << acts(true);
  EXPECT_NE(acts(true).find("I:N9-SET"), std::string::npos) << acts(true);
  EXPECT_EQ(acts(false).substr(0, 8), "F:N9-SET") << acts(false);
}

// A report is missing beside a line with so many packets of its host, none of which is missing, and
// one frame in `each` of the air is.
TEST(Passive, ALineMayMissAsMuchAsTheAir) {
  const auto fails = [](int packets, int each) {
    Script script;
    script.request(0, 2, 100).reply(10, 11, 2, 100, 10).ack_join(20, 11, 2, 100).link_ack();
    for (int i = 0; i < packets; ++i) {
      script.serial(1000 + 100.0 * i, true, am::kConfig, {1, 0, 0}).confirm();
    }
    for (std::uint16_t i = 0; i < 200; ++i) {
      if (i % each == 0) ++script.dsn[2];
      const NetFields sent = update(2, static_cast<std::uint16_t>(300 + i));
      script.net(20'000 + 100.0 * i, 2, 1, sent).up(20'012 + 100.0 * i, sent.forwarded());
    }
    for (const Finding& finding : judge(script.run, {.start_cold = true}).findings) {
      if (finding.requirement == "J6-REPORT"_rule) return finding.severity == Severity::kFail;
    }
    return false;
  };
  EXPECT_TRUE(fails(60, 4));
  EXPECT_FALSE(fails(60, 25)) << "So few packets would not show it.";
  EXPECT_TRUE(fails(180, 25));
}

// A sink loses `lost` of 80 messages that its link acknowledged; one frame of the air is missing,
// or none.
TEST(Passive, ALineMayLoseAFewFramesAsTheAirDoes) {
  const auto finds = [](int lost, bool hole) {
    Script script = Script().join(0, 11, 2, 100);
    if (hole) ++script.dsn[2];
    for (std::uint16_t i = 0; i < 80; ++i) {
      const NetFields sent = update(2, static_cast<std::uint16_t>(300 + i));
      script.net(1000 + 700.0 * i, 2, 1, sent).link_ack();
      if (i == 0 || i > lost) script.up(1012 + 700.0 * i, sent.forwarded());
    }
    const std::string found = found_in(script, {.start_cold = true});
    return found.find("F:N6-FORWARD") != std::string::npos   ? "fails"
           : found.find("I:N6-FORWARD") != std::string::npos ? "suspected"
                                                             : "";
  };
  EXPECT_STREQ(finds(0, true), "");
  EXPECT_STREQ(finds(1, false), "fails");
  EXPECT_STREQ(finds(1, true), "suspected");
  EXPECT_STREQ(finds(78, true), "fails") << "So many no recorder loses.";
}

// What a host may have sent down a line makes these lawful: SET_ISLAND_ID of the same island, which
// empties the list, a message to pass on, and a copy of one that came by radio.
TEST(Passive, ALineThatIsNotCapturedMayExplainWhatASinkDoes) {
  const auto finds = [](auto acts, bool line) {
    Script script;
    script.join(0, 11, 2, 100).serial(500, true, am::kConfig, {1, 0, 0}).confirm();
    acts(script);
    const auto of_line = [](const Observation& seen) { return seen.tap != 0; };
    if (!line) std::erase_if(script.run.seen, of_line);
    return found_in(script, {.sniffer_complete = true});
  };
  const auto answers_member = [](Script& script) {
    script.dsn[2] = 77;  // It was started again.
    script.join(900, 11, 2, 555);
  };
  EXPECT_EQ(finds(answers_member, true), "F:J2-LISTED");
  EXPECT_EQ(finds(answers_member, false), "I:J2-LISTED");
  const auto radiates = [](Script& script) {
    script.net(1000, 1, 5, message({11, 1}, {12, 5}, 7), 11);
  };
  EXPECT_EQ(finds(radiates, true), "F:N6-OWN");
  EXPECT_EQ(finds(radiates, false), "I:N6-OWN");
  Script first;  // The line may have had frames just before its capture began.
  first.join(0, 11, 2, 100).net(60, 1, 5, message({11, 1}, {12, 5}, 7), 11);
  first.serial(500, true, am::kConfig, {1, 0, 0}).confirm();
  EXPECT_EQ(found_in(first, true).substr(0, 8), "F:N6-OWN");
  EXPECT_EQ(found_in(first, false).substr(0, 8), "I:N6-OWN");
  const auto acks_twice = [](Script& script) {
    const NetFields asked = message({12, 3}, {11, 1}, 7, 1);
    script.net(1000, 3, 1, asked).net(1040, 1, 3, asked.ack(50), 11);
    script.net(1080, 1, 3, asked.ack(51), 11);
  };
  EXPECT_EQ(finds(acks_twice, true), "F:N6-OWN F:T2-ONCE");
  EXPECT_EQ(finds(acks_twice, false), "I:N6-OWN I:T2-ONCE");
}

TEST(Passive, AfterWrongSourcesTheRightOneIsRight) {
  Script script = Script().join(0, 11, 2, 100);
  const auto sends = [&](double ms, std::uint16_t devid, std::uint16_t seq_num) {
    const NetFields net = message({11, devid}, {11, kNullDevid}, seq_num);
    script.net(ms, 2, 1, net).up(ms + 12, net.forwarded());
  };
  for (std::uint16_t i = 0; i < 3; ++i) sends(1000 + 500 * i, 79, 7 + i);
  EXPECT_EQ(found_in(script), "F:N1-SRC");
  sends(3000, 2, 10);
  sends(3500, 2, 11);
  EXPECT_EQ(found_in(script), "F:N1-SRC");
  sends(4000, 79, 12);
  EXPECT_EQ(found_in(script), "F:N1-SRC F:N1-SRC");
}

TEST(Passive, WhatComesFromOtherIslandsIsSeenOnNoLine) {
  const auto acks = [](machine::Address of) {
    const NetFields asked = message(of, {11, kNullDevid}, 2464, 1);
    Script script = Script().join(0, 11, 2, 100).down(100, asked.ack(90)).confirm();
    return found_in(script).find("F:T2-CONTENT") != std::string::npos;
  };
  EXPECT_FALSE(acks({12, 8}));
  EXPECT_TRUE(acks({11, 2}));
}

// Nothing else shows the island that the sink had before its host set another.
TEST(Passive, AReportThatIsUnderWayShowsTheFormerIsland) {
  const auto found = [](double reported_ms, std::int64_t response_ms = 293) {
    Script script;
    script.request(0, 4, 100).reply(10, 7, 4, 100, 10).ack_join(20, 7, 4, 100).link_ack();
    script.dsn[11 * 65536U + 1] = script.dsn[7 * 65536U + 1];
    script.serial(60, true, am::kConfig, {10, 0, 11}).confirm();
    script.ack_join(80, 7, 4, 100).link_ack().joined(reported_ms, 7, 4);
    script.join(2500, 11, 5, 200).join(3000, 12, 6, 300, 2);
    return found_in(
        script, {.sniffer_complete = true, .start_cold = true, .response_us = 1000 * response_ms});
  };
  EXPECT_EQ(found(110), "");
  EXPECT_EQ(found(1000).substr(0, 8), "F:N9-SET") << "It keeps its island.";
  EXPECT_EQ(found(1000, 1500), "");
  EXPECT_EQ(found(2000, 1500).substr(0, 8), "F:N9-SET");
}

TEST(Passive, ABufferIsNotFullOfWhatHasLeft) {
  const auto loses = [](double forward_ms) {  // A message each 60 ms; the fifth is lost.
    Script script = Script().join(0, 11, 2, 100);
    for (std::uint16_t i = 0; i < 16; ++i) {
      const double ms = 1000 + 60 * i;
      const NetFields net = update(2, 7 + i);
      script.net(ms, 2, 1, net).link_ack();
      if (i != 4) script.up(ms + forward_ms, net.forwarded());
    }
    std::ranges::stable_sort(script.run.seen, {},
                             [](const auto& one) { return one.place.time_us; });
    for (std::size_t i = 0; i < script.run.seen.size(); ++i) script.run.seen[i].place.frame = i + 1;
    return found_in(script).substr(0, 12);
  };
  EXPECT_EQ(loses(12), "F:N6-FORWARD");
  EXPECT_EQ(loses(240), "I:N6-FORWARD") << "Four were waiting.";
}

}  // namespace
}  // namespace rubric::check::passive_test
