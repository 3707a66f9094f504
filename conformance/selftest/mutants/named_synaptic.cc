// Mistakes with synaptic channels.
#include <algorithm>
#include <vector>

#include "conformance/machine/synaptic.h"
#include "conformance/selftest/mutants/fields.h"
#include "conformance/selftest/mutants/mutant.h"

namespace rubric::mutants {
namespace {

constexpr std::size_t kUnit = rubicon::SynapticDataLayout::ValuesAt::kUnitBytes;

using machine::Channel;
using machine::ChannelResult;
using machine::CreateChannel;
using machine::DataStatus;
using machine::InputValue;
using machine::SynDataReceived;
using machine::TimerKind;

template <class Call>
bool is_call(const Moment& moment) {
  return moment.called<Call>() != nullptr;
}
bool is_tick(const Moment& moment) { return moment.timer(TimerKind::kSynaptic); }

void add_operations(Mutants& out) {
  add(out, "channel_id_swapped", "A channel's id has its ends swapped.", {"S1-ID"_rule},
      edit_told<ChannelResult>(
          [](Moment&, ChannelResult& result) { result.id = result.id >> 16 | result.id << 16; }));
  add(out, "channel_id_of_bytes", "A channel's id holds devids cut to a byte.", {"S1-ID"_rule},
      edit_told<ChannelResult>([](Moment&, ChannelResult& result) { result.id &= 0x00FF'00FF; }));
  add(out, "enlarging_refused", "Creating a channel that exists is refused.", {"S1-ENLARGE"_rule},
      always([](Moment& moment) {
        const CreateChannel* const create = moment.called<CreateChannel>();
        if (create == nullptr) return moment.honest();
        const machine::Synaptic before = moment.state.synaptic;
        moment.honest();
        const bool more = moment.state.synaptic.out.size() > before.out.size() ||
                          moment.state.synaptic.in.size() > before.in.size();
        if (more) return;
        moment.state.synaptic = before;
        moment.answer(ChannelResult{0, false}, "S1-ENLARGE"_rule);
      }));
  add(out, "enlarging_replaces_the_size", "Creating a channel again sets its size.",
      {"S1-ENLARGE"_rule, "S1-LIMIT"_rule}, always([](Moment& moment) {
        const CreateChannel* const create = moment.called<CreateChannel>();
        moment.honest();
        if (create == nullptr) return;
        for (Channel& channel : moment.state.synaptic.out) {
          if (channel.peer == create->peer) channel.size = create->size;
        }
        for (Channel& channel : moment.state.synaptic.in) {
          if (channel.peer == create->peer) channel.size = create->size;
        }
      }));
  add(out, "channel_limit_ignored", "A fifth channel replaces the first.", {"S1-LIMIT"_rule},
      before_step([](Moment& moment) {
        const CreateChannel* const create = moment.called<CreateChannel>();
        if (create != nullptr) {
          const bool out_going = create->direction == machine::Direction::kOut;
          auto& list = out_going ? moment.state.synaptic.out : moment.state.synaptic.in;
          if (list.size() >= 4) list.erase(0);
        }
      }));
  add(out, "connection_limit_cut", "More than ten connections are created as ten.",
      {"S1-LIMIT"_rule}, always([](Moment& moment) {
        const CreateChannel* const create = moment.called<CreateChannel>();
        if (create == nullptr) return moment.honest();
        CreateChannel cut = *create;
        cut.size = std::min<std::uint8_t>(cut.size, 10);
        moment.honest(machine::Called{cut});
      }));
  add(out, "refusal_costs_the_size", "A refused enlargement makes the channel ten wide.",
      {"S1-LIMIT"_rule}, after_step([](Moment& moment) {
        const CreateChannel* const create = moment.called<CreateChannel>();
        if (create == nullptr || moment.actions.notices().empty()) return;
        const auto* result = std::get_if<ChannelResult>(&moment.actions.notices()[0]);
        if (result == nullptr || result->success) return;
        for (Channel& channel : moment.state.synaptic.out) {
          if (channel.peer == create->peer) channel.size = 10;
        }
        for (Channel& channel : moment.state.synaptic.in) {
          if (channel.peer == create->peer) channel.size = 10;
        }
      }));
  add(out, "write_at_the_next_place", "write_output_value writes at pos + 1.",
      {"S1-WRITE"_rule, "S2-CONTENT"_rule, "S2-SEND"_rule}, always([](Moment& moment) {
        const auto* write = moment.called<machine::WriteOutput>();
        if (write == nullptr) return moment.honest();
        machine::WriteOutput other = *write;
        ++other.pos;
        moment.honest(machine::Called{other});
      }));
  add(out, "write_lost", "write_output_value does nothing.",
      {"S1-WRITE"_rule, "S3-CHANGED"_rule, "S2-CONTENT"_rule}, always([](Moment& moment) {
        if (!is_call<machine::WriteOutput>(moment)) return moment.honest();
        moment.answer(machine::OperationResult{true}, "S1-WRITE"_rule);
      }));
  add(out, "read_at_place_0", "read_input_value reads the first place.",
      {"S1-READ"_rule, "S1-ENLARGE"_rule}, always([](Moment& moment) {
        const auto* read = moment.called<machine::ReadInput>();
        if (read == nullptr) return moment.honest();
        moment.honest(machine::Called{machine::ReadInput{read->id, 0}});
      }));
  add(out, "read_past_the_end", "read_input_value returns 0 after the end.",
      {"S1-READ"_rule, "S1-LIMIT"_rule},
      edit_told<InputValue>([](Moment&, InputValue& value) { value.success = true; }));
  add(out, "read_swapped", "Values are read in network order.", {"S1-READ"_rule, "S1-ENLARGE"_rule},
      edit_heard([](Moment&, Forged& forged) {
        const bool data =
            is_net(forged.frame) && forged.bytes[net::kTransId] == component::kSynChannel;
        if (!data) return;
        for (std::size_t i = net::kBody; i + kUnit <= forged.size(); i += kUnit) {
          std::reverse(forged.bytes.begin() + static_cast<std::ptrdiff_t>(i),
                       forged.bytes.begin() + static_cast<std::ptrdiff_t>(i + kUnit));
        }
      }));
  add(out, "time_step_ignored", "set_time_step changes nothing.", {"S1-CLOCK"_rule},
      always([](Moment& moment) {
        if (!is_call<machine::SetTimeStep>(moment)) return moment.honest();
        moment.answer(machine::OperationResult{true}, "S1-CLOCK"_rule);
      }));
  add(out, "default_step_of_a_second", "The clock's default period is 1000 ticks.",
      {"S1-CLOCK"_rule, "S2-SEND"_rule, "S2-SIGNAL"_rule}, before_step([](Moment& moment) {
        auto& period = moment.state.synaptic.period_ticks;
        if (period == 500) period = 1000;
      }));
}

void two_sends(Moment& moment) {
  moment.honest();
  moment.rewrite([&](const Action& action) {
    moment.keep(action);
    const bool data = action.what == Action::What::kTransmit && is_synaptic(moment.sent(action));
    if (data) moment.hold(action, 100);
  });
}

void new_on_arrival(Moment& moment) {
  moment.honest();
  bool came = false;
  machine::ChannelId id = 0;
  for (Channel& channel : moment.state.synaptic.in) {
    if (!channel.fresh || moment.heard() == nullptr) continue;
    channel.fresh = false;
    came = true;
    id = channel.id;
  }
  if (came) moment.actions.notify(SynDataReceived{id, DataStatus::kNew}, "S2-SIGNAL"_rule);
}

void add_ticks(Mutants& out) {
  add(out, "first_channel_only", "A tick sends the first channel only.",
      {"S2-SEND"_rule, "S1-LIMIT"_rule}, always([](Moment& moment) {
        auto& channels = moment.state.synaptic.out;
        if (!is_tick(moment) || channels.empty()) return moment.honest();
        std::vector<bool> started(channels.size());
        for (std::size_t i = 1; i < channels.size(); ++i) {
          started[i] = channels[i].started;
          channels[i].started = false;
        }
        moment.honest();
        for (std::size_t i = 1; i < channels.size(); ++i) channels[i].started = started[i];
      }));
  add(out, "reliable_sends_changes_only", "A reliable channel sends only what changed.",
      {"S1-MODE"_rule, "S2-SEND"_rule, "S2-CONTENT"_rule, "S1-LIMIT"_rule},
      before_step([](Moment& moment) {
        for (Channel& channel : moment.state.synaptic.out) channel.mode = machine::Mode::kPowerSave;
      }));
  add(out, "floats_in_network_order", "Synaptic data are big-endian.",
      {"S2-CONTENT"_rule, "S1-WRITE"_rule, "S1-ENLARGE"_rule},
      edit_sent(is_synaptic, [](Moment&, Transmit& frame) {
        for (std::size_t i = net::kBody; i + kUnit <= frame.size_bytes; i += kUnit) {
          std::reverse(frame.payload.begin() + i, frame.payload.begin() + i + kUnit);
        }
      }));
  add(out, "values_in_reverse", "The values of a channel are in reverse order.",
      {"S2-CONTENT"_rule, "S1-WRITE"_rule, "S1-ENLARGE"_rule, "S3-CHANGED"_rule},
      edit_sent(is_synaptic, [](Moment&, Transmit& frame) {
        std::reverse(frame.payload.begin() + net::kBody, frame.payload.begin() + frame.size_bytes);
        for (std::size_t i = net::kBody; i + kUnit <= frame.size_bytes; i += kUnit) {
          std::reverse(frame.payload.begin() + i, frame.payload.begin() + i + kUnit);
        }
      }));
  add(out, "synaptic_reliable", "Synaptic data ask to be acked.", {"S2-CONTENT"_rule},
      sent_field(is_synaptic, net::kReliable, 1));
  add(out, "synaptic_of_another_app", "Synaptic data have APPID MOCKUP.", {"S2-CONTENT"_rule},
      sent_field(is_synaptic, net::kAppId, 5));
  add(out, "sends_twice_a_tick", "Each channel sends again 100 ticks after the tick.",
      {"S2-TICK"_rule}, always(two_sends));
  add(out, "clock_too_fast", "The clock's period is 100 ticks short.",
      {"S2-TICK"_rule, "S1-CLOCK"_rule}, after_step([](Moment& moment) {
        if (is_tick(moment)) moment.state.synaptic.due -= 100;
      }));
  add(out, "phase_missing", "All motes tick in the same moment.", {"S2-PHASE"_rule},
      with_profile(&machine::Profile::synaptic_phase_ticks, 0));
  add(out, "signals_on_arrival", "Data are signalled when they come, and not at the tick.",
      {"S2-SIGNAL"_rule, "S2-TICK"_rule}, always(new_on_arrival));
  add(out, "silent_without_data", "A tick without new data is not signalled.",
      {"S2-SIGNAL"_rule, "S3-OLD"_rule},
      on_told_of<SynDataReceived>([](Moment&, SynDataReceived& data) {
        return data.status == DataStatus::kOld ? Fate::kDrop : Fate::kKeep;
      }));
  add(out, "always_new", "Every tick says that data are new.", {"S3-OLD"_rule, "S2-SIGNAL"_rule},
      edit_told<SynDataReceived>([](Moment&, SynDataReceived& data) {
        if (data.status == DataStatus::kOld) data.status = DataStatus::kNew;
      }));
  add(out, "old_values_forgotten", "A tick without new data clears the values.", {"S3-OLD"_rule},
      before_step([](Moment& moment) {
        if (is_tick(moment)) {
          for (Channel& channel : moment.state.synaptic.in) {
            if (!channel.fresh) channel.value_bits.fill(0);
          }
        }
      }));
  add(out, "power_save_sends_unchanged", "In power-save mode every tick sends.",
      {"S3-UNCHANGED"_rule}, before_step([](Moment& moment) {
        for (Channel& channel : moment.state.synaptic.out) channel.fresh = true;
      }));
  add(out, "rewritten_counts_as_changed", "A value that is written again counts as changed.",
      {"S3-UNCHANGED"_rule}, always([](Moment& moment) {
        const auto* write = moment.called<machine::WriteOutput>();
        moment.honest();
        if (write == nullptr) return;
        for (Channel& channel : moment.state.synaptic.out) {
          if (channel.id == write->id) channel.fresh = true;
        }
      }));
  add(out, "first_tick_silent", "In power-save mode the first tick sends nothing.",
      {"S3-FIRST"_rule, "S3-CHANGED"_rule}, after_step([](Moment& moment) {
        const bool starts =
            is_call<machine::StartChannel>(moment) || is_call<machine::StartAllChannels>(moment);
        if (!starts) return;
        for (Channel& channel : moment.state.synaptic.out) channel.fresh = false;
      }));
  add(out, "change_of_place_0_only", "In power-save mode only the first value is watched.",
      {"S3-CHANGED"_rule}, always([](Moment& moment) {
        const auto* write = moment.called<machine::WriteOutput>();
        const machine::Synaptic before = moment.state.synaptic;
        moment.honest();
        if (write == nullptr || write->pos == 0) return;
        for (std::size_t i = 0; i < before.out.size(); ++i) {
          moment.state.synaptic.out[i].fresh = before.out[i].fresh;
        }
      }));
}

}  // namespace

void synaptic_mutants(Mutants& out) {
  add_operations(out);
  add_ticks(out);
}

}  // namespace rubric::mutants
