// Variants of synaptic channels.
#include "conformance/selftest/lawful_traffic/variants.h"
#include "conformance/selftest/lawful_traffic/world.h"

namespace rubric::lawful {
namespace {

constexpr std::int64_t kStartUs = 2'600'000;
constexpr std::int64_t kWriteUs = 210'000;

/// Creates channels. Mote 2: one to the sink and one to mote 3; mote 3: one to itself and one to
/// the sink; the sink: one to mote 4. Values change now and then.
void channels(Plan& plan, bool power_save, int change_percent) {
  plan.chats = 6;
  plan.at(kStartUs, [power_save](World& world) {
    if (!world.mote(0).joined() || !world.mote(1).joined()) return;
    Mote& first = world.mote(0);
    Mote& second = world.mote(1);
    const Address sink = world.sink(0).address();
    first.start(first.create_out(sink, 3, power_save));
    first.start(first.create_out(second.address(), 10, power_save));
    second.start(second.create_out(second.address(), 2, power_save));
    second.start(second.create_out(sink, 1, power_save));
    world.sink(0).start(world.sink(0).create_out(world.mote(0).address(), 2, power_save));
  });
  for (std::int64_t time = kStartUs + kWriteUs; time < plan.end_us; time += kWriteUs) {
    plan.at(time, [change_percent](World& world) {
      if (!world.mote(0).joined() || !world.mote(1).joined()) return;
      const auto value = [&world] { return static_cast<float>(world.random().below(4096)) / 16; };
      const auto changes = [&] { return world.random().chance(change_percent); };
      const std::size_t pos = world.random().below(3);
      if (changes()) world.mote(0).write_value(0, pos, value());
      if (changes()) world.mote(0).write_value(1, 9, value());
      if (changes()) world.mote(1).write_value(1, 0, value());
      if (changes()) world.sink(0).write_value(0, 1, value());
    });
  }
}
/// Makes mote 2 stop its first channel for a while.
void stop_and_start(Plan& plan) {
  plan.at(5'000'000, [](World& world) {
    if (world.mote(0).joined() && world.mote(1).joined()) world.mote(0).stop(0);
  });
  plan.at(7'100'000, [](World& world) {
    if (world.mote(0).joined() && world.mote(1).joined()) world.mote(0).start(0);
  });
}

void esn_data(Plan& plan, Random&) { channels(plan, false, 60); }
void learning(Plan& plan, Random&) {
  channels(plan, false, 60);
  plan.traits.synaptic_app = static_cast<std::uint8_t>(rubicon::Component::kLearning);
}
void constant(Plan& plan, Random&) { channels(plan, false, 0); }
void power_save(Plan& plan, Random&) {
  channels(plan, true, 15);
  plan.net_loss_percent = 0;
}
void stop_restart(Plan& plan, Random&) {
  channels(plan, false, 60);
  stop_and_start(plan);
}
void restart_power_save(Plan& plan, Random&) {
  channels(plan, true, 10);
  stop_and_start(plan);
}
void restart_shifts(Plan& plan, Random&) {
  channels(plan, false, 60);
  stop_and_start(plan);
  plan.traits.restart_shifts_clock = true;
}
void no_phase_shift(Plan& plan, Random&) {
  channels(plan, false, 60);
  plan.traits.phase_shift = false;
}
void slower_clock(Plan& plan, Random&) {
  channels(plan, false, 60);
  plan.traits.synaptic_period_us = 976'563;  // set_time_step(1000).
}
void faster_clock(Plan& plan, Random&) {
  channels(plan, false, 60);
  plan.traits.synaptic_period_us = 244'141;  // set_time_step(250).
}

}  // namespace

std::vector<Variant> synaptic_variants() {
  return {
      mixing("syn_esn_data", "synaptic channels, APPID ESN_DATA", {120}, esn_data),
      alone("syn_learning", "synaptic channels, APPID LEARNING", {120}, learning),
      alone("syn_constant", "reliable mode: values that do not change are sent all the same", {120},
            constant),
      alone("syn_power_save", "power-save mode: ticks without a change send nothing", {120},
            power_save),
      alone("syn_stop_restart", "one channel stops and starts again; the others keep time", {121},
            stop_restart),
      alone("syn_restart_power_save", "power-save mode: the first tick after a start sends",
            {120, 121}, restart_power_save),
      weak("syn_restart_shifts", "starting a channel again begins the clock anew", {121},
           restart_shifts),
      weak("syn_no_phase_shift", "the clock starts without a phase shift", {}, no_phase_shift),
      alone("syn_slower_clock", "set_time_step(1000)", {}, slower_clock),
      alone("syn_faster_clock", "set_time_step(250)", {}, faster_clock),
  };
}

}  // namespace rubric::lawful
