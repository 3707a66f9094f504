#include "conformance/machine/step.h"

#include <variant>

#include "conformance/machine/lines.h"
#include "conformance/machine/messages.h"
#include "conformance/machine/synaptic.h"
#include "conformance/machine/transport.h"

namespace rubric::machine {
namespace {

void join_timer_due(Node& node) {
  const JoinSend send = join_timer(node.state.join, join_context(node), node.actions);
  if (send == JoinSend::kRequest) return send_join_request(node, "J8-RETRY"_rule);
  forget_waiting(node.state, am::kJoin);  // The call is over; what waits for the radio is, too.
}

void timer_due(Node& node, Timer timer) {
  switch (timer.kind) {
    case TimerKind::kJoin: return join_timer_due(node);
    case TimerKind::kAck:
      // Without a timeout no such timer is ever set.
      if (node.profile().ack_timeout_ticks == 0) return node.actions.ignored("T3-ONCE"_rule);
      return ack_timeout(node.state.awaited, timer.index, node.actions);
    case TimerKind::kSynaptic: return tick(node);
    case TimerKind::kSilence: return end_silence(node);
  }
}

void app_busy(Node& node, bool busy) {
  node.state.app_busy = busy;
  if (!busy) handle_waiting(node);
}

// Clears the memory; other users of the lines are unaffected. Numbers continue, like those of a
// mote that draws them at random: a late reply must not fit its next request.
void lose_memory(State& state) {
  const bool radio_taken = state.radio.taken;
  const bool serial_taken = state.serial.taken;
  const Sequence sequence = state.sequence;
  state = start(Config(state.config));
  state.sequence = sequence;
  state.radio.taken = radio_taken;
  state.serial.taken = serial_taken;
}

void reboot(Node& node) {
  State& state = node.state;
  lose_memory(state);
  state.clock_offset_ms = 0 - ms_of(node);
  node.actions.followed(ReqId::kNone);
}

void power_off(Node& node) {
  lose_memory(node.state);
  node.state.off = true;
  //= N10-OFF: An interface that is switched off sends nothing and receives nothing.
  node.actions.followed("N10-OFF"_rule);
}

// Handles events of a line that need no power.
void without_power(Node& node, const Event& event) {
  if (const auto* busy = std::get_if<LinkBusy>(&event)) {
    if (busy->link == Link::kRadio) node.state.radio.taken = busy->busy;
    if (busy->link == Link::kSerial) node.state.serial.taken = busy->busy;
  }
  node.actions.ignored("N10-OFF"_rule);
}

void take(Node& node, const Event& event) {
  if (const auto* heard = std::get_if<Heard>(&event)) return hear(node, heard->frame);
  if (const auto* called = std::get_if<Called>(&event)) return call(node, called->call);
  if (const auto* timer = std::get_if<TimerDue>(&event)) return timer_due(node, timer->timer);
  if (const auto* done = std::get_if<SendDone>(&event)) return send_done(node, *done);
  if (const auto* busy = std::get_if<LinkBusy>(&event)) return line_busy(node, *busy);
  if (const auto* busy = std::get_if<AppBusy>(&event)) return app_busy(node, busy->busy);
  power_off(node);
}

}  // namespace

State start(const Config& config) {
  State state;
  state.config = config;
  state.island = config.role == Role::kMote ? std::uint16_t{0} : config.island;
  state.sequence.random = config.random_seq;
  state.sequence.last =
      config.random_seq ? config.first_seq : static_cast<std::uint16_t>(config.first_seq - 1);
  state.synaptic.period_ticks = config.profile.synaptic_period_ticks;
  return state;
}

void step(State& state, Ticks now, const Event& event, Actions& actions) {
  actions.clear();
  Node node{state, now, actions};
  if (std::holds_alternative<Reboot>(event)) return reboot(node);
  if (state.off) return without_power(node, event);
  take(node, event);
  report_owed(node);
}

DueTimers timers(const State& state) {
  DueTimers set;
  if (state.join.phase == JoinMote::Phase::kJoining) {
    set.push({state.join.due, {TimerKind::kJoin, 0}});
  }
  if (state.config.profile.ack_timeout_ticks != 0) {
    for (std::size_t i = 0; i < state.awaited.size(); ++i) {
      if (state.awaited[i].due == 0) continue;  // It has not left.
      set.push({state.awaited[i].due, {TimerKind::kAck, static_cast<std::uint8_t>(i)}});
    }
  }
  if (state.synaptic.due != 0) set.push({state.synaptic.due, {TimerKind::kSynaptic, 0}});
  if (!state.present.empty()) set.push({silence_due(state), {TimerKind::kSilence, 0}});
  return set;
}

Address own_address(const State& state) {
  switch (state.config.role) {
    case Role::kMote:
      if (state.join.phase == JoinMote::Phase::kMember) return state.join.address;
      return {0, state.config.id};
    case Role::kSink: return {state.island, state.config.id};
    case Role::kBaseStation: break;
  }
  return {state.island, kNullDevid};
}

}  // namespace rubric::machine
