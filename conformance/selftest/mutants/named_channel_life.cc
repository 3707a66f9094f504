// Mistakes with channels that are local, unknown, stopped or disposed; and all named mutants.
#include <algorithm>
#include <utility>

#include "conformance/machine/flaws/flaws.h"
#include "conformance/machine/synaptic.h"
#include "conformance/selftest/mutants/fields.h"
#include "conformance/selftest/mutants/mutant.h"

namespace rubric::mutants {
namespace {

using machine::Channel;
using machine::ChannelId;
using machine::DisposeChannel;
using machine::StartChannel;
using machine::StopAllChannels;
using machine::StopChannel;
using machine::SynDataReceived;
using machine::TimerKind;

bool has(const machine::Synaptic& synaptic, ChannelId id) {
  const auto is = [id](const Channel& channel) { return channel.id == id; };
  return std::any_of(synaptic.in.begin(), synaptic.in.end(), is) ||
         std::any_of(synaptic.out.begin(), synaptic.out.end(), is);
}

void sends_local(Moment& moment) {
  moment.honest();
  if (!moment.timer(TimerKind::kSynaptic) || moment.state.radio.sending) return;
  for (const Channel& channel : moment.state.synaptic.out) {
    if (!channel.started || channel.peer != own(moment)) continue;
    Transmit& frame = moment.send(Link::kRadio, am::kNet, channel.peer.devid, "S4-LOCAL"_rule);
    const std::size_t nbytes =
        rubicon::AppMsgLayout::PayloadAt::kAt + rubicon::SynapticDataLayout::ValuesAt::kUnitBytes;
    frame.size_bytes = static_cast<std::uint8_t>(net::kTransId + nbytes);
    put(frame, net::kDestPid, channel.peer.pid);
    put(frame, net::kDestDevid, channel.peer.devid);
    frame.payload[net::kNbytes] = nbytes;
    frame.payload[net::kTransId] = component::kSynChannel;
    frame.payload[net::kAppId] = component::kEsnData;
    return;
  }
}

void drops_local(Moment& moment) {
  const machine::Synaptic before = moment.state.synaptic;
  moment.honest();
  if (!moment.timer(TimerKind::kSynaptic)) return;
  for (const Channel& out : before.out) {
    for (std::size_t i = 0; i < before.in.size(); ++i) {
      if (before.in[i].id == out.id) {
        moment.state.synaptic.in[i].value_bits = before.in[i].value_bits;
      }
    }
  }
}

// Puts data of an unknown channel into the first one.
void stores_unknown(Moment& moment) {
  using Values = rubicon::SynapticDataLayout::ValuesAt;
  const Frame* const frame = moment.heard(am::kNet);
  auto& inputs = moment.state.synaptic.in;
  const bool data = frame != nullptr && is_net(*frame) && !inputs.empty() &&
                    frame->payload[net::kTransId] == component::kSynChannel;
  const std::uint16_t devid = data ? get(*frame, net::kSrcDevid) : std::uint16_t{0};
  const bool known =
      data && has(moment.state.synaptic, machine::channel_id(devid, own(moment).devid));
  moment.honest();
  if (!data || known || frame->payload.size() < net::kBody + Values::kUnitBytes) return;
  inputs[0].value_bits[0] = bits_of_float(Values::load(frame->payload.data() + net::kBody, 0));
  inputs[0].fresh = true;
}

void add_local_and_unknown(Mutants& out) {
  add(out, "local_data_on_the_air", "A channel from a node to itself sends a frame.",
      {"S4-LOCAL"_rule}, always(sends_local));
  add(out, "local_data_lost", "A channel from a node to itself hands nothing over.",
      {"S4-LOCAL"_rule}, always(drops_local));
  add(out, "unknown_channel_stored", "Data of an unknown channel go to the first one.",
      {"S5-UNKNOWN"_rule}, always(stores_unknown));
  add(out, "unknown_channel_silent", "Data of an unknown channel are not reported.",
      {"S5-UNKNOWN"_rule}, on_told_of<SynDataReceived>([](Moment&, SynDataReceived& data) {
        const bool unknown = data.status == machine::DataStatus::kUnknownChannel;
        return unknown ? Fate::kDrop : Fate::kKeep;
      }));
  add(out, "unknown_channel_new", "Data of an unknown channel are reported as new.",
      {"S5-UNKNOWN"_rule}, edit_told<SynDataReceived>([](Moment&, SynDataReceived& data) {
        if (data.status == machine::DataStatus::kUnknownChannel) {
          data.status = machine::DataStatus::kNew;
        }
      }));
}

template <class Call>
StepMaker refuses_silently(ReqId requirement) {
  return [requirement]() -> Step {
    return [requirement](Moment& moment) {
      if (moment.called<Call>() == nullptr) return moment.honest();
      moment.answer(machine::OperationResult{true}, requirement);
    };
  };
}

void starts_at_creation(Moment& moment) {
  const auto* create = moment.called<machine::CreateChannel>();
  moment.honest();
  if (create == nullptr) return;
  const std::uint16_t devid = own(moment).devid;
  const bool out = create->direction == machine::Direction::kOut;
  const ChannelId id = out ? machine::channel_id(devid, create->peer.devid)
                           : machine::channel_id(create->peer.devid, devid);
  if (!has(moment.state.synaptic, id)) return;
  Actions silent;
  machine::step(moment.state, moment.now, machine::Called{StartChannel{id}}, silent);
}

void add_ends(Mutants& out) {
  add(out, "stopped_channel_goes_on", "stop_syn_channel changes nothing.", {"S6-STOPPED"_rule},
      refuses_silently<StopChannel>("S6-STOPPED"_rule));
  add(out, "stop_all_goes_on", "stop_all_syn_channels changes nothing.", {"S1-ALL"_rule},
      refuses_silently<StopAllChannels>("S6-STOPPED"_rule));
  add(out, "starts_at_creation", "A channel runs from its creation on.", {"S6-STOPPED"_rule},
      always(starts_at_creation));
  add(out, "stop_stops_all", "stop_syn_channel stops every channel.", {"S6-OTHERS"_rule},
      always([](Moment& moment) {
        if (moment.called<StopChannel>() == nullptr) return moment.honest();
        moment.honest(machine::Called{StopAllChannels{}});
      }));
  add(out, "disposed_channel_goes_on", "Disposing a channel changes nothing (release 1.0).",
      {"S6-DISPOSED"_rule}, refuses_silently<DisposeChannel>("S6-DISPOSED"_rule));
  add(out, "disposed_channel_keeps_its_place", "Disposing a channel stops it, and keeps its place.",
      {"S6-DISPOSED"_rule}, always([](Moment& moment) {
        const DisposeChannel* const dispose = moment.called<DisposeChannel>();
        if (dispose == nullptr) return moment.honest();
        moment.honest(machine::Called{StopChannel{dispose->id}});
      }));
  add(out, "dispose_takes_all", "Disposing a channel disposes of every one.",
      {"S6-DISPOSED"_rule, "S6-OTHERS"_rule, "S2-SEND"_rule}, always([](Moment& moment) {
        const bool disposes = moment.called<DisposeChannel>() != nullptr;
        moment.honest();
        if (!disposes) return;
        moment.state.synaptic.out.clear();
        moment.state.synaptic.in.clear();
      }));
  add(out, "start_does_nothing", "start_syn_channel says yes and starts nothing.",
      {"S1-START"_rule, "S2-SEND"_rule, "S2-SIGNAL"_rule},
      refuses_silently<StartChannel>("S1-START"_rule));
  add(out, "start_all_does_nothing", "start_all_syn_channels says yes and starts nothing.",
      {"S1-ALL"_rule, "S2-SEND"_rule, "S2-SIGNAL"_rule},
      refuses_silently<machine::StartAllChannels>("S1-ALL"_rule));
  add(out, "start_shifts_the_clock", "Starting a channel begins the clock anew for all.",
      {"S6-CLOCK"_rule, "S2-SEND"_rule, "S2-PHASE"_rule}, after_step([](Moment& moment) {
        auto& synaptic = moment.state.synaptic;
        if (moment.called<StartChannel>() != nullptr && synaptic.due != 0) {
          synaptic.due = moment.now + synaptic.period_ticks + (own(moment).devid - 1U) * 30U;
        }
      }));
  add(out, "start_all_starts_outputs", "start_all_syn_channels starts no input.",
      {"S2-SIGNAL"_rule}, always([](Moment& moment) {
        const machine::Synaptic before = moment.state.synaptic;
        moment.honest();
        if (moment.called<machine::StartAllChannels>() == nullptr) return;
        for (std::size_t i = 0; i < before.in.size(); ++i) {
          moment.state.synaptic.in[i].started = before.in[i].started;
        }
      }));
}

// Those of release 1.0, which are steps without a memory.
void release_mutants(Mutants& out) {
  for (const flaws::Flaw& flaw : flaws::all()) {
    Mutant mutant{flaw.name, flaw.description, {}, [step = flaw.step]() -> Step {
                    return [step](Moment& moment) {
                      step(moment.state, moment.now, moment.event, moment.actions);
                    };
                  }};
    for (const ReqId requirement : flaw.requirements) {
      if (requirement != ReqId::kNone) mutant.requirements.push_back(requirement);
    }
    out.push_back(std::move(mutant));
  }
}

}  // namespace

void channel_life_mutants(Mutants& out) {
  add_local_and_unknown(out);
  add_ends(out);
}

Mutants named_mutants() {
  Mutants out;
  for (const auto add_family :
       {release_mutants, mote_join_mutants, mote_accept_mutants, sink_join_mutants, network_mutants,
        island_mutants, control_mutants, delivery_mutants, transport_mutants, synaptic_mutants,
        channel_life_mutants}) {
    add_family(out);
  }
  return out;
}

}  // namespace rubric::mutants
