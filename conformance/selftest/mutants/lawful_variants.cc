#include <algorithm>
#include <random>

#include "conformance/machine/transport.h"
#include "conformance/selftest/mutants/fields.h"
#include "conformance/selftest/mutants/mutant.h"

namespace rubric::mutants {
namespace {

using Variants = std::vector<LawfulVariant>;
using machine::Joined;
using machine::Received;
using trace::ParameterId;

// Holds back what follows from the frames that `waits` chooses.
template <class Waits>
StepMaker late(Ticks ticks, Waits waits) {
  return [=]() -> Step {
    return [=](Moment& moment) {
      moment.honest();
      if (moment.heard() == nullptr || !waits(*moment.heard())) return;
      moment.rewrite([&](const Action& action) {
        const bool visible =
            action.what == Action::What::kTransmit || action.what == Action::What::kNotify;
        return visible ? moment.hold(action, ticks) : moment.keep(action);
      });
    };
  };
}

// Delays all answers to received frames by the same time, so that their order stays.
StepMaker late(Ticks ticks) {
  return late(ticks, [](const Frame&) { return true; });
}

void slow_acks(Moment& moment) {
  moment.honest();
  moment.rewrite([&](const Action& action) {
    const bool sent = action.what == Action::What::kTransmit;
    if (!sent || !is_ack(moment.sent(action))) return moment.keep(action);
    moment.hold(action, 200);
  });
}

// Lets a sink or base station need its time after power on: frames of before leave then.
void starts_slowly(Moment& moment) {
  constexpr Ticks kReady = 250;
  moment.honest();
  if (moment.now >= kReady || moment.is(Role::kMote)) return;
  moment.rewrite([&](const Action& action) {
    const bool frame = action.what == Action::What::kTransmit;
    return frame ? moment.hold(action, kReady - moment.now) : moment.keep(action);
  });
}

// Lets a mote need its time after power on: the first request leaves then, and its timer runs from
// it.
void mote_starts_slowly(Moment& moment) {
  constexpr Ticks kReady = 250;
  moment.honest();
  if (moment.now >= kReady || !moment.is(Role::kMote)) return;
  const Ticks wait = kReady - moment.now;
  moment.rewrite([&](const Action& action) {
    const bool request =
        action.what == Action::What::kTransmit && moment.sent(action).type == am::kJoin;
    if (request && moment.state.join.due > moment.now) moment.state.join.due += wait;
    return request ? moment.hold(action, wait) : moment.keep(action);
  });
}

void add_times(Variants& out) {
  out.push_back({"starts_slowly",
                 "Sinks and base stations send nothing in their first 250 ticks (125).",
                 always(starts_slowly)});
  out.push_back({"mote_starts_slowly", "Motes ask for nothing in their first 250 ticks (125).",
                 always(mote_starts_slowly)});
  out.push_back(
      {"slow_100", "Everything that follows from a frame takes 100 ticks (125).", late(100), true});
  out.push_back(
      {"slow_250", "Everything that follows from a frame takes 250 ticks (125).", late(250), true});
  out.push_back(
      {"slow_acks", "Acks take 200 ticks, deliveries none (125).", always(slow_acks), true});
  out.push_back({"join_timer_2_percent_slow", "The join timer takes 510 ticks (128).",
                 with_profile(&machine::Profile::join_period_ticks, 510)});
  out.push_back({"ack_timer_2_percent_slow", "The ack timeout takes 1020 ticks (110, 128).",
                 with_profile(&machine::Profile::ack_timeout_ticks, 1020)});
  out.push_back({"clock_2_percent_slow", "The synaptic clock's default period is 510 ticks (128).",
                 before_step([](Moment& moment) {
                   auto& period = moment.state.synaptic.period_ticks;
                   if (period == 500) period = 510;
                 })});
}

struct Renumbered {
  std::uint16_t before = 0;
};

// Gives the request that is sent last a number of its own, which is the one that counts.
void number_for_each_request(Moment& moment, Renumbered& memory) {
  moment.honest();
  moment.rewrite([&](const Action& action) {
    if (action.what != Action::What::kTransmit) return moment.keep(action);
    Transmit frame = moment.sent(action);
    if (frame.type == am::kJoin) {
      memory.before =
          static_cast<std::uint16_t>(get(frame, join_request::kSeqNum) * 31U + memory.before + 7U);
      put(frame, join_request::kSeqNum, memory.before);
      moment.state.join.seq_num = memory.before;
    }
    moment.keep(action, frame);
  });
}

// Delays joined(SUCCESS) until the link ack of ack_join, or until it does not repeat it any more.
void joined_on_confirmation(Moment& moment, bool& told) {
  const auto* done = std::get_if<machine::SendDone>(&moment.event);
  bool given_up = done != nullptr && !done->acked && is_member(moment);
  moment.honest();
  if (!is_member(moment)) told = false;
  moment.rewrite([&](const Action& action) {
    if (action.what == Action::What::kTransmit) given_up = false;
    if (action.what == Action::What::kNotify) {
      const auto* joined = std::get_if<Joined>(&moment.notice_of(action));
      if (joined != nullptr && joined->success) return;
    }
    moment.keep(action);
  });
  const bool over = moment.state.join.acked || given_up;
  if (!moment.is(Role::kMote) || !is_member(moment) || !over || told) return;
  told = true;
  moment.actions.notify(Joined{own(moment), true}, "J5-SUCCESS"_rule);
}

void add_joins(Variants& out) {
  out.push_back({"fail_at_the_fourth_expiry", "Four requests, then joined(FAIL) (101).",
                 with_profile([](machine::Profile& profile) {
                   if (profile.join_requests_max == 5) profile.join_requests_max = 4;
                 })});
  out.push_back({"number_for_each_request", "Each request has a number of its own (104).",
                 remembering<Renumbered>(number_for_each_request)});
  out.push_back({"joined_on_confirmation", "joined(SUCCESS) comes with the link ack (102).",
                 remembering<bool>(joined_on_confirmation)});
  out.push_back({"ack_join_once", "ack_join is never repeated (102).",
                 with_profile(&machine::Profile::ack_join_max, 1)});
  out.push_back({"clock_of_another_origin", "A sink's clock began a day ago (119).",
                 edit_sent(am::kJoinReply, [](Moment&, Transmit& frame) {
                   put(frame, join_reply::kTime, get(frame, join_reply::kTime) + 86'400'000U);
                 })});
}

void stale_on_serial(Moment& moment, Transmit& frame) {
  const bool up = frame.link == Link::kSerial && moment.is(Role::kSink) && is_net(frame) &&
                  !is_synaptic(frame);  // Its nbytes says how many values there are.
  const bool own_ack = is_ack(frame) && get(frame, net::kSrcPid) == own(moment).pid &&
                       get(frame, net::kSrcDevid) == own(moment).devid;
  if (!up || own_ack) return;  // An ack's nbytes is 4 or 6 (decision 108).
  const std::size_t end = 12U + frame.payload[net::kNbytes];
  for (std::size_t i = end; i < frame.payload.size(); ++i) {
    frame.payload[i] = static_cast<std::uint8_t>(0xA5 ^ i);
  }
  frame.payload[net::kNbytes] = net::kNbytes.kMax;
}

// Acks each copy, delivers the first.
void delivers_once(Moment& moment, std::vector<std::vector<std::uint8_t>>& seen) {
  const Frame* const frame = moment.heard(am::kNet);
  const bool reliable = frame != nullptr && is_net(*frame) && frame->payload[net::kReliable] == 1;
  moment.honest();
  if (!reliable) return;
  const std::vector<std::uint8_t> bytes(frame->payload.begin(), frame->payload.end());
  const bool copy = std::find(seen.begin(), seen.end(), bytes) != seen.end();
  seen.push_back(bytes);
  if (!copy) return;
  moment.rewrite([&](const Action& action) {
    const bool told = action.what == Action::What::kNotify;
    if (!told || !std::holds_alternative<Received>(moment.notice_of(action))) moment.keep(action);
  });
}

// Lets a sink send on, once, what one of its motes sent it for another (115).
void relays(Moment& moment) {
  moment.honest();
  const Frame* const frame = moment.heard(am::kNet);
  const bool radio = frame != nullptr && frame->link == Link::kRadio && moment.is(Role::kSink);
  if (!radio || !moment.state.radio.on || frame->dest == machine::kAmBroadcast) return;
  if (!ignores(moment.actions, "N6-OTHER"_rule) || moment.state.radio.sending ||
      moment.state.radio.taken)
    return;
  moment.state.radio.sending = true;
  Transmit& sent =
      moment.send(Link::kRadio, am::kNet, get(*frame, net::kDestDevid), "N6-OTHER"_rule);
  const std::size_t size = 12U + frame->payload[net::kNbytes];
  std::copy_n(frame->payload.begin(), size, sent.payload.begin());
  sent.size_bytes = static_cast<std::uint8_t>(size);
}

// Acks a reliable message for an unknown application all the same (111).
void acks_unknown_apps(Moment& moment) {
  moment.honest();
  const Frame* const frame = moment.heard(am::kNet);
  const bool asked = frame != nullptr && is_net(*frame) && moment.is(Role::kMote) &&
                     is_member(moment) && frame->payload[net::kReliable] == 1 &&
                     frame->payload[net::kTransId] == component::kConnless &&
                     !machine::is_known_app(frame->payload[net::kAppId]) &&
                     get(*frame, net::kDestPid) == own(moment).pid &&
                     get(*frame, net::kDestDevid) == own(moment).devid;
  if (!asked || !moment.actions.transmits().empty() || moment.state.radio.sending) return;
  moment.state.radio.sending = true;
  Transmit& ack = moment.send(Link::kRadio, am::kNet, get(*frame, net::kSrcDevid), "T2-ACK"_rule);
  copy_address(*frame, net::kSrcPid, ack, net::kDestPid);
  copy_address(*frame, net::kDestPid, ack, net::kSrcPid);
  put(ack, net::kSeqNum, 4711);
  ack.payload[net::kNbytes] = net::kPaperAckNbytes;
  ack.payload[net::kTransId] = component::kRubiconAck;
  ack.payload[net::kAppId] = frame->payload[net::kAppId];
  put(ack, net::kPaperSeq, get(*frame, net::kSeqNum));
  ack.size_bytes = net::kPaperSeq.kEnd;
}

// Reorders frames of different lines and notices, which have no order among themselves.
void other_order(Moment& moment) {
  moment.honest();
  std::vector<Action> rest;
  moment.rewrite([&](const Action& action) {
    if (action.what == Action::What::kNotify) return moment.keep(action);
    rest.push_back(action);
  });
  for (const Action& action : rest) moment.keep(action);
}

// On the serial line, too, a net_msg ends after its payload.
void cut_on_serial(Moment&, Transmit& frame) {
  if (frame.link != Link::kSerial || !is_net(frame)) return;
  frame.size_bytes = static_cast<std::uint8_t>(12 + frame.payload[net::kNbytes]);
}

// Lets the connections of a new channel hold what was in the memory before.
void free_values(Moment& moment) {
  auto& channels = moment.state.synaptic;
  const std::size_t outputs = channels.out.size();
  const std::size_t inputs = channels.in.size();
  moment.honest();
  constexpr std::uint32_t kStale = 0xD1A7'05EE;
  if (channels.out.size() > outputs) (channels.out.end() - 1)->value_bits.fill(kStale);
  if (channels.in.size() > inputs) (channels.in.end() - 1)->value_bits.fill(kStale);
}

// Says something of its own by radio whenever anything happens.
void beacons(Moment& moment) {
  const auto& radio = moment.state.radio;
  const bool idle = radio.on && !radio.sending && !radio.taken && !moment.state.off &&
                    moment.actions.transmits().empty();
  const bool ended = std::holds_alternative<machine::SendDone>(moment.event);
  if (!idle || ended || moment.is(Role::kBaseStation)) return;
  moment.state.radio.sending = true;
  moment.send(Link::kRadio, 200, machine::kAmBroadcast, ReqId::kNone).size_bytes = 4;
}

void add_messages(Variants& out) {
  out.push_back({"acks_with_a_code", "Acks are learning_notifications, as in release 1.0 (108).",
                 with_profile(&machine::Profile::short_acks, false)});
  out.push_back({"stale_bytes_on_serial", "A sink hands up with nbytes 102 (N6-CONTENT).",
                 edit_sent(stale_on_serial)});
  out.push_back({"cut_on_serial", "On the serial line messages end after their nbytes (140).",
                 edit_sent(cut_on_serial), true});
  out.push_back({"whole_on_serial_only", "What is cut short on the serial line is dropped (140).",
                 hear_only([](const Moment&, const Frame& frame) {
                   return frame.link != Link::kSerial || !is_net(frame) ||
                          frame.payload.size() == machine::kAmPayloadMax;
                 }),
                 true});
  out.push_back({"delivers_copies_once", "A repeated message is acked, and delivered once (111).",
                 remembering<std::vector<std::vector<std::uint8_t>>>(delivers_once)});
  out.push_back({"acks_unknown_apps", "What is for an unknown APPID is acked (111).",
                 always(acks_unknown_apps)});
  out.push_back(
      {"relays", "A sink sends on what is for another of its motes (115).", always(relays)});
  out.push_back({"every_island_ignored", "pid 0xFFFF is not taken (114).",
                 hear_only([](const Moment&, const Frame& frame) {
                   return !is_net(frame) || get(frame, net::kDestPid) != machine::kBroadcastPid;
                 })});
  out.push_back({"app_id_learning", "Synaptic data have APPID LEARNING (120).",
                 sent_field(is_synaptic, net::kAppId, 6)});
  out.push_back({"free_values", "A connection that was never written holds anything (120).",
                 always(free_values)});
  out.push_back({"told_first", "In a step, events for the application come before frames.",
                 always(other_order)});
  out.push_back({"own_frames_besides", "A node beacons with a type of its own all the time (124).",
                 after_step(beacons)});
}

// The machine keeps what its configuration states.
void as_stated(Moment& moment) { moment.honest(); }

struct LateValues {
  Ticks due = 0;
  machine::ChannelId id = 0;
  decltype(machine::Channel::value_bits) bits;
};

// Handles the data of channels 440 ticks after they came.
void values_late(Moment& moment, std::vector<LateValues>& waiting) {
  auto& inputs = moment.state.synaptic.in;
  while (!waiting.empty() && waiting.front().due <= moment.now) {
    for (machine::Channel& input : inputs) {
      if (input.id != waiting.front().id || !input.started) continue;
      input.value_bits = waiting.front().bits;
      input.fresh = true;
    }
    waiting.erase(waiting.begin());
  }
  const auto before = inputs;
  moment.honest();
  if (moment.heard() == nullptr) return;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (inputs[i] == before[i]) continue;
    waiting.push_back({moment.now + 440, inputs[i].id, inputs[i].value_bits});
  }
  inputs = before;
}

struct Bursts {
  Ticks last = 0;
  bool waits = false;
};

// Needs the channel for as long as stated for each frame of a burst, and not at all for the next.
void waits_every_second_time(Moment& moment, Bursts& bursts) {
  constexpr Ticks kPause = 200;
  moment.honest();
  moment.rewrite([&](const Action& action) {
    const bool radio =
        action.what == Action::What::kTransmit && moment.sent(action).link == Link::kRadio;
    if (!radio) return moment.keep(action);
    if (moment.now > bursts.last + kPause) bursts.waits = !bursts.waits;
    bursts.last = moment.now;
    return bursts.waits ? moment.hold(action, 30) : moment.keep(action);
  });
}

// Two wrappers, the frames of the first held back by the second.
StepMaker late_and_backing_off(Ticks ticks, Ticks most) {
  return [=]() -> Step {
    std::minstd_rand random(static_cast<std::uint32_t>(ticks));
    return [=](Moment& moment) mutable {
      moment.honest();
      const Ticks wait = moment.heard() == nullptr ? 0 : ticks;
      moment.rewrite([&](const Action& action) {
        if (action.what == Action::What::kNotify && wait > 0) return moment.hold(action, wait);
        if (action.what != Action::What::kTransmit) return moment.keep(action);
        const bool radio = moment.sent(action).link == Link::kRadio;
        moment.hold(action, wait + (radio ? static_cast<Ticks>(random() % (most + 1)) : 0));
      });
    };
  };
}

}  // namespace

std::vector<LawfulVariant> lawful_variants() {
  Variants out;
  add_times(out);
  add_joins(out);
  add_messages(out);
  out.push_back(
      {"random_numbers", "Sequence numbers are random (117).", before_step([](Moment& moment) {
         moment.state.sequence.random = true;
         moment.state.config.random_seq = true;
       })});
  return out;
}

StepMaker backing_off(std::uint32_t seed, Ticks most) {
  return [=]() -> Step {
    std::minstd_rand random(seed + 1);
    return [=](Moment& moment) mutable {
      moment.honest();
      moment.rewrite([&](const Action& action) {
        const bool radio =
            action.what == Action::What::kTransmit && moment.sent(action).link == Link::kRadio;
        const Ticks wait = radio ? static_cast<Ticks>(random() % (most + 1)) : 0;
        return wait > 0 ? moment.hold(action, wait) : moment.keep(action);
      });
    };
  };
}

std::vector<LawfulVariant> stated_variants() {
  const auto is_reply = [](const Frame& frame) { return frame.type == am::kJoinReply; };
  std::vector<LawfulVariant> out;
  const auto add = [&](std::string name, std::string reading, StepMaker step,
                       trace::Statement stated, bool weak = false) {
    out.push_back({std::move(name), std::move(reading), std::move(step), weak, std::move(stated)});
  };
  add("ack_timeout_2000", "The ack timeout takes 2000 ticks (110).", always(as_stated),
      {{ParameterId::kAckTimeout, 2000}});
  add("ack_timeout_700", "The ack timeout takes 700 ticks (110).", always(as_stated),
      {{ParameterId::kAckTimeout, 700}});
  add("join_period_1024", "A second from one join_request to the next (133).", always(as_stated),
      {{ParameterId::kJoinPeriod, 1024}});
  add("join_period_400", "A shorter join timer (133).", always(as_stated),
      {{ParameterId::kJoinPeriod, 400}});
  add("chooses_for_350", "Chooses among offers for 350 ticks (125).", late(350, is_reply),
      {{ParameterId::kResponse, 350}});
  add("response_450", "All answers take 440 ticks (125).", late(440),
      {{ParameterId::kResponse, 450}}, true);
  add("response_100", "All answers take 90 ticks (125).", late(90), {{ParameterId::kResponse, 100}},
      true);
  add("values_late", "Synaptic data count 440 ticks after they came (125).",
      remembering<std::vector<LateValues>>(values_late), {{ParameterId::kResponse, 450}});
  add("synaptic_period_1000", "A synaptic clock of a second (133).", always(as_stated),
      {{ParameterId::kSynapticPeriod, 1000}});
  add("synaptic_period_400", "A faster synaptic clock (133).", always(as_stated),
      {{ParameterId::kSynapticPeriod, 400}});
  add("synaptic_phase_150", "Motes tick further apart (121).", always(as_stated),
      {{ParameterId::kSynapticPhase, 150}});
  add("backs_off", "TinyOS's random back-off of up to 10 ms before a frame (128).",
      backing_off(1, 10), {{ParameterId::kChannelAccess, 30}});
  add("backs_off_as_long_as_stated",
      "Each frame of a burst needs 30 ticks for the channel, those of the next none (128).",
      remembering<Bursts>(waits_every_second_time), {{ParameterId::kChannelAccess, 30}});
  add("all_stated", "Everything at once (110, 121, 125, 128, 133).", late_and_backing_off(330, 20),
      {{ParameterId::kResponse, 350},
       {ParameterId::kJoinPeriod, 1024},
       {ParameterId::kAckTimeout, 2500},
       {ParameterId::kChannelAccess, 60},
       {ParameterId::kSynapticPeriod, 800},
       {ParameterId::kSynapticPhase, 40}},
      true);
  return out;
}

}  // namespace rubric::mutants
