// Variants of joining. They change mote 2 (index 0 of the common plan).
#include "conformance/selftest/lawful_traffic/air.h"
#include "conformance/selftest/lawful_traffic/variants.h"
#include "conformance/selftest/lawful_traffic/world.h"

namespace rubric::lawful {
namespace {

using rubicon::AmType;

constexpr std::int64_t kAlways = INT64_MAX;
constexpr std::uint16_t kMote = 2;

bool is_ack_join(const RadioFrame& frame, std::uint16_t src) {
  return frame.type == static_cast<std::uint8_t>(AmType::kAckJoin) && frame.src == src;
}

/// Makes mote 2 miss its link acks before `until_us`.
AckLoss lose_link_acks(std::int64_t until_us) {
  return [until_us](World& world, const RadioFrame& frame) {
    return frame.src == kMote && world.now_us() < until_us;
  };
}

void early_boot(Plan& plan) { plan.motes[0].boot_us = 200'000; }

void four_requests(Plan& plan, Random&) {
  plan.traits.requests_max = 4;
  plan.losses.push_back(lose(AmType::kJoin, kMote, kAlways));
}
void five_requests(Plan& plan, Random&) {
  plan.losses.push_back(lose(AmType::kJoin, kMote, kAlways));
}
void five_requests_new_seq(Plan& plan, Random&) {
  plan.traits.new_seq_per_retry = true;
  plan.losses.push_back(lose(AmType::kJoin, kMote, kAlways));
}
void request_lost_same_seq(Plan& plan, Random&) {
  early_boot(plan);
  plan.losses.push_back(lose(AmType::kJoin, kMote, 1'000'000));
}
void request_lost_new_seq(Plan& plan, Random& random) {
  request_lost_same_seq(plan, random);
  plan.traits.new_seq_per_retry = true;
}
Loss lose_replies(std::int64_t until_us) {
  return [until_us](World& world, const RadioFrame& frame, const Device& to) {
    return frame.type == static_cast<std::uint8_t>(AmType::kJoinReply) && to.am() == kMote &&
           world.now_us() < until_us;
  };
}
void reply_lost_same_seq(Plan& plan, Random&) {
  early_boot(plan);
  plan.losses.push_back(lose_replies(1'000'000));
}
void reply_lost_new_seq(Plan& plan, Random& random) {
  reply_lost_same_seq(plan, random);
  plan.traits.new_seq_per_retry = true;
}
void joins_again_after_fail(Plan& plan, Random&) {
  early_boot(plan);
  plan.traits.join_calls = 2;
  plan.losses.push_back(lose(AmType::kJoin, kMote, 3'500'000));
}
void joins_again_at_once(Plan& plan, Random& random) {
  joins_again_after_fail(plan, random);
  plan.traits.join_pause_us = 1'000;
  plan.losses.push_back(lose(AmType::kJoin, kMote, kAlways));
}
void joined_at_acceptance(Plan& plan, Random&) {
  early_boot(plan);
  plan.traits.joined_when = JoinedWhen::kAcceptance;
  plan.traits.ack_join_max = 5;
  plan.losses.push_back(lose(AmType::kAckJoin, kMote, 260'000));
}
void joined_at_link_ack(Plan& plan, Random&) {
  early_boot(plan);
  plan.traits.joined_when = JoinedWhen::kLinkAck;
  plan.traits.ack_join_max = 5;
  plan.ack_losses.push_back(lose_link_acks(260'000));
}
void link_ack_lost(Plan& plan, Random&) {
  plan.traits.ack_join_max = 5;
  plan.ack_losses.push_back(lose_link_acks(kAlways));
}
void link_ack_lost_same_dsn(Plan& plan, Random& random) {
  link_ack_lost(plan, random);
  plan.traits.ack_join_same_dsn = true;
}
void ack_join_thrice(Plan& plan, Random&) {
  plan.traits.ack_join_max = 3;
  plan.traits.ack_join_always = true;
}
void ack_join_often(Plan& plan, Random&) {
  plan.traits.ack_join_max = 10;
  plan.traits.ack_join_always = true;
}
void unconfirmed_fails(Plan& plan, Random&) {
  early_boot(plan);
  plan.traits.joined_when = JoinedWhen::kLinkAck;
  plan.traits.ack_join_max = 4;
  plan.traits.unconfirmed = Unconfirmed::kFail;
  plan.traits.join_calls = 2;
  plan.losses.push_back(lose(AmType::kAckJoin, kMote, 1'000'000));
}
void unconfirmed_requests_again(Plan& plan, Random& random) {
  unconfirmed_fails(plan, random);
  plan.traits.unconfirmed = Unconfirmed::kRequestAgain;
  plan.traits.join_calls = 1;
  plan.traits.ack_join_max = 2;
}
void ghost(Plan& plan, Random&) { plan.losses.push_back(lose(AmType::kAckJoin, kMote, kAlways)); }
void orphan(Plan& plan, Random&) {
  early_boot(plan);
  plan.traits.joined_when = JoinedWhen::kLinkAck;
  plan.traits.ack_join_max = 2;
  plan.traits.join_calls = 2;
  plan.ack_losses.push_back(lose_link_acks(kAlways));
}
void listed_mote_reboots(Plan& plan, Random& random) {
  plan.end_us = 12'000'000;
  plan.traits.join_calls = 2;
  const auto time = random.between(4'000'000, 5'000'000);
  plan.at(time, [](World& world) { world.mote(0).switch_off(); });
  plan.at(time + 300'000, [](World& world) { world.mote(0).boot(); });
}
void interleaved_joins(Plan& plan, Random& random) {
  plan.motes.clear();
  for (std::uint16_t id = 2; id <= 6; ++id) {
    plan.motes.push_back(mote_plan(id, 0, 500'000 + random.between(0, 3'000)));
    plan.motes.back().descriptor.transducers = static_cast<std::uint16_t>(id * 9);
  }
  plan.traits.delay_min_us = 60'000;
  plan.traits.delay_max_us = 90'000;
}
void full_list(Plan& plan, Random& random) {
  plan.motes.clear();
  for (std::uint16_t id = 2; id <= 23; ++id) {
    plan.motes.push_back(mote_plan(id, 0, 200'000 + id * 100'000 + random.between(0, 20'000)));
    plan.motes.back().updates = id % 7 == 0;
  }
}
void full_list_answers(Plan& plan, Random& random) {
  full_list(plan, random);
  plan.traits.answers_when_full = true;
}
void two_sinks_first(Plan& plan, Random& random) {
  two_islands(plan, false, random);
  for (MotePlan& mote : plan.motes) mote.any_sink = true;
}
void two_sinks_preferred(Plan& plan, Random& random) { two_islands(plan, false, random); }
void wrong_sink_link_acks(Plan& plan, Random& random) {
  two_islands(plan, false, random);
  plan.traits.ack_join_max = 5;
  plan.losses.push_back([](World& world, const RadioFrame& frame, const Device& to) {
    return is_ack_join(frame, kMote) && &to == &world.sink(0);
  });
}
void same_devid(Plan& plan, Random& random) {
  two_islands(plan, true, random);
  plan.motes[0].id = 5;  // Mote 5 of island 11 beside mote 5 of island 12.
}
void set_island_first(Plan& plan, Random&) {
  for (MotePlan& mote : plan.motes) {
    mote.boot_us += 400'000;
    mote.any_sink = true;
  }
  plan.at(100'000, [](World& world) { world.base(0).set_island(12); });
}
void island_change_forgets(Plan& plan, Random&) {
  plan.end_us = 12'000'000;
  for (MotePlan& mote : plan.motes) mote.any_sink = true;
  plan.at(4'000'000, [](World& world) { world.base(0).set_island(13); });
  plan.at(6'000'000, [](World& world) { world.mote(0).switch_off(); });
  plan.at(6'200'000, [](World& world) { world.mote(0).boot(); });
}
void island_change_keeps(Plan& plan, Random& random) {
  island_change_forgets(plan, random);
  plan.traits.forgets_members = false;
}
void home(Plan& plan, Random& random) {
  plan.motes.clear();
  for (std::uint16_t id = 2; id <= 13; ++id) {
    plan.motes.push_back(mote_plan(id, 0, random.between(100'000, 5'000'000)));
    if (random.chance(30)) plan.motes.back().leave_us = random.between(6'000'000, 9'000'000);
  }
}
void mote_leaves(Plan& plan, Random& random) {
  plan.motes[1].leave_us = random.between(5'000'000, 6'000'000);
}

}  // namespace

std::vector<Variant> join_variants() {
  return {
      alone("four_requests", "FAIL at the fourth expiry, after four requests", {101},
            four_requests),
      alone("five_requests", "FAIL at the fifth expiry, after five requests", {101}, five_requests),
      alone("five_requests_new_seq", "five requests, each with a number of its own, then FAIL",
            {101, 104}, five_requests_new_seq),
      mixing("request_lost_same_seq", "requests are lost; retries keep the number", {104},
             request_lost_same_seq),
      mixing("request_lost_new_seq", "requests are lost; retries change the number", {104},
             request_lost_new_seq),
      mixing("reply_lost_same_seq", "replies are lost; retries keep the number", {104},
             reply_lost_same_seq),
      mixing("reply_lost_new_seq", "replies are lost; retries change the number", {104},
             reply_lost_new_seq),
      alone("joins_again_after_fail",
            "the application calls joinIsland again, some time after FAIL", {101, 103},
            joins_again_after_fail),
      alone("joins_again_at_once", "the application calls joinIsland again in the event of FAIL",
            {101}, joins_again_at_once),
      alone("joined_at_acceptance",
            "joined on accepting the reply; ack_join repeated until confirmed", {102},
            joined_at_acceptance),
      alone("joined_at_link_ack", "joined when the link layer confirmed ack_join", {102},
            joined_at_link_ack),
      alone("link_ack_lost", "link acks are lost; ack_join repeated five times, a new DSN each",
            {102}, link_ack_lost),
      alone("link_ack_lost_same_dsn",
            "link acks are lost; the link layer repeats ack_join, same DSN", {102},
            link_ack_lost_same_dsn),
      mixing("ack_join_thrice", "ack_join sent three times, confirmed or not", {102},
             ack_join_thrice),
      weak("ack_join_often", "ack_join repeated more than five times", {102}, ack_join_often),
      alone("unconfirmed_fails",
            "FAIL after acceptance, since ack_join stayed unconfirmed; then again", {102, 103},
            unconfirmed_fails),
      alone("unconfirmed_requests_again", "a new request, since ack_join stayed unconfirmed",
            {102, 103}, unconfirmed_requests_again),
      alone("ghost",
            "the only ack_join is lost; the mote counts itself a member, the sink does not", {103},
            ghost),
      alone("orphan", "the sink lists a mote that gave up, and ignores its next requests",
            {103, 105}, orphan),
      alone("listed_mote_reboots", "a listed mote reboots; the sink ignores its requests", {105},
            listed_mote_reboots),
      alone("interleaved_joins", "five motes join at once at a slow sink", {106},
            interleaved_joins),
      alone("full_list", "twenty members; the motes after them are not answered", {107}, full_list),
      weak("full_list_answers", "twenty members; the motes after them are answered, never listed",
           {107}, full_list_answers),
      alone("two_sinks_first", "two sinks in range; motes take the reply that comes first", {127},
            two_sinks_first),
      alone("two_sinks_preferred", "two sinks in range; motes wait for the island they want", {127},
            two_sinks_preferred),
      alone("wrong_sink_link_acks",
            "only the other sink heard ack_join, and confirms it by its address", {103, 127},
            wrong_sink_link_acks),
      alone("same_devid",
            "motes of two islands, out of each other's range, with the same TinyOS id", {},
            same_devid),
      alone("set_island_first", "SET_ISLAND_ID before anybody joins", {123}, set_island_first),
      alone("island_change_forgets", "SET_ISLAND_ID with members; the sink forgets them",
            {105, 123}, island_change_forgets),
      weak("island_change_keeps", "SET_ISLAND_ID with members; the sink keeps them listed",
           {105, 123}, island_change_keeps),
      alone("home", "twelve motes come, some fall silent", {}, home),
      mixing("mote_leaves", "a mote is switched off", {}, mote_leaves),
  };
}

}  // namespace rubric::lawful
