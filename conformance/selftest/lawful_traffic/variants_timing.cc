// Variants of clocks and speed.
#include "conformance/selftest/lawful_traffic/variants.h"

namespace rubric::lawful {
namespace {

void lose_first_requests(Plan& plan) {
  plan.motes[0].boot_us = 200'000;
  plan.losses.push_back(lose(rubicon::AmType::kJoin, 2, 2'000'000));
}
void slow(Plan& plan, Random&) {
  plan.traits.delay_min_us = 110'000;
  plan.traits.delay_max_us = 235'000;
  plan.traits.ack_timeout_us = 2'000'000;
  plan.foreign_chats = false;
}
void timers_slow(Plan& plan, Random&) {
  lose_first_requests(plan);
  plan.traits.clock_ppm_min = 17'000;
  plan.traits.clock_ppm_max = 20'000;
}
void timers_fast(Plan& plan, Random&) {
  lose_first_requests(plan);
  plan.traits.clock_ppm_min = -35'000;
  plan.traits.clock_ppm_max = -30'000;
  plan.traits.access_max_us = 5'000;
}
void timers_real_ms(Plan& plan, Random&) {
  lose_first_requests(plan);
  plan.traits.join_period_us = 500'000;
}
void clock_skew(Plan& plan, Random& random) {
  plan.traits.clock_ppm_min = -2'000;
  plan.traits.clock_ppm_max = 2'000;
  plan.traits.time_offset_ms = static_cast<std::uint32_t>(random.between(1, 1'000'000'000));
}
void spread_boots(Plan& plan, Random& random) {
  for (std::size_t i = 0; i < plan.motes.size(); ++i) {
    const auto turn = static_cast<std::int64_t>(i);
    plan.motes[i].boot_us = 500'000 + turn * 3'000'000 + random.between(0, 300'000);
  }
}
void cur_time_binary(Plan& plan, Random& random) {
  spread_boots(plan, random);
  plan.traits.binary_time = true;
}
void cur_time_wraps(Plan& plan, Random& random) {
  spread_boots(plan, random);
  plan.traits.time_offset_ms = UINT32_MAX - 2'000;
}
void cur_time_uptime(Plan& plan, Random& random) {
  spread_boots(plan, random);
  plan.traits.time_offset_ms = static_cast<std::uint32_t>(random.between(1, 2'000'000'000));
}
void busy_channel(Plan& plan, Random&) {
  lose_first_requests(plan);
  plan.traits.access_max_us = 28'000;
  plan.foreign_chats = false;
}
void stated_join_timer(Plan& plan, Random&) {
  lose_first_requests(plan);
  plan.traits.join_period_us = 292'969;  // 300 ticks.
}
void stated_slow_join_timer(Plan& plan, Random&) {
  lose_first_requests(plan);
  plan.losses[0] = lose(rubicon::AmType::kJoin, 2, 3'500'000);
  plan.traits.join_period_us = 1'000'000;
}
void stated_requests(Plan& plan, Random&) {
  plan.motes[0].boot_us = 200'000;
  plan.losses.push_back(lose(rubicon::AmType::kJoin, 2, 3'000'000));
  plan.traits.requests_max = 8;
}
void stated_slow(Plan& plan, Random&) {
  plan.traits.delay_min_us = 340'000;
  plan.traits.delay_max_us = 380'000;
  plan.traits.join_period_us = 1'000'000;
  plan.traits.ack_timeout_us = 3'000'000;
  plan.foreign_chats = false;
}
void stated_busy_channel(Plan& plan, Random&) {
  lose_first_requests(plan);
  plan.traits.access_max_us = 90'000;
  plan.traits.ack_timeout_us = 2'000'000;
  plan.foreign_chats = false;
}

// Returns a variant that is lawful only with these parameters stated.
Variant stated(std::string_view name, std::string_view summary, std::vector<int> decisions,
               Configure configure, std::string_view parameters) {
  return {name, summary, std::move(decisions), configure, false, Worst::kPass, parameters};
}

}  // namespace

std::vector<Variant> timing_variants() {
  return {
      alone("slow", "nodes take up to 240 ms to react", {125}, slow),
      alone("timers_slow", "clocks that are slow by two percent", {128}, timers_slow),
      alone("timers_fast", "clocks that are fast by up to 3.5 percent", {128}, timers_fast),
      mixing("timers_real_ms", "the join timer counts real milliseconds", {128}, timers_real_ms),
      mixing("clock_skew", "clocks differ by up to 0.4 percent", {119}, clock_skew),
      mixing("cur_time_binary", "cur_time counts binary milliseconds", {119}, cur_time_binary),
      alone("cur_time_wraps", "cur_time steps over its 32 bits", {119}, cur_time_wraps),
      mixing("cur_time_uptime", "the sink has been up for long", {119}, cur_time_uptime),
      mixing("busy_channel", "channel access takes up to 28 ms", {128}, busy_channel),
      stated("stated_join_timer", "a join timer of 300 ticks, as stated", {133}, stated_join_timer,
             "join_period=300"),
      stated("stated_slow_join_timer", "a join timer of 1024 ticks, as stated", {133},
             stated_slow_join_timer, "join_period=1024"),
      stated("stated_requests", "eight requests of one call, as stated", {101}, stated_requests,
             "join_requests=8"),
      stated("stated_slow", "nodes take 340 to 380 ms to react, as stated", {125, 133}, stated_slow,
             "response=450 join_period=1024 ack_timeout=3072"),
      stated("stated_busy_channel", "channel access takes up to 90 ms, as stated", {128},
             stated_busy_channel, "channel_access=95"),
  };
}

}  // namespace rubric::lawful
