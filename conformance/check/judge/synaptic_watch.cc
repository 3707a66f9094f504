#include "conformance/check/judge/synaptic_watch.h"

#include <algorithm>

namespace rubric::check {
namespace {

const machine::Channel* find(const machine::Synaptic& channels, machine::ChannelId id) {
  for (const machine::Channel& channel : channels.out) {
    if (channel.id == id) return &channel;
  }
  return nullptr;
}

}  // namespace

SynapticWatch::SynapticWatch(Context& context, std::size_t devices)
    : context_(context), nodes_(devices) {}

void SynapticWatch::begin_life(std::uint16_t node) { nodes_[node] = Node{}; }

SynapticWatch::Out* SynapticWatch::find(Node& node, machine::ChannelId id) {
  for (Out& out : node.outs) {
    if (out.id == id) return &out;
  }
  return nullptr;
}

void SynapticWatch::called(std::uint16_t device, const Observation& seen, machine::Address own) {
  Node& node = nodes_[device];
  const bool creates = std::holds_alternative<machine::CreateChannel>(*seen.call);
  if (creates && !node.logged) {
    node.logged = true;
    node.channels.period_ticks = context_.profile().synaptic_period_ticks;
  }
  if (!node.logged) return;
  if (std::holds_alternative<machine::SetTimeStep>(*seen.call)) {
    node.step_us = seen.place.time_us;
  }
  machine::Config config;
  config.role = context_.device(device).role;
  config.id = context_.device(device).am;
  config.profile = context_.profile();
  settle(device, seen.place.time_us);
  const machine::Synaptic before = node.channels;
  context_.actions.clear();
  machine::call_synaptic(node.channels, config, own, machine::ticks_of(seen.place.time_us),
                         *seen.call, context_.actions);
  note(node, before, seen.place.time_us);
  note_inputs(node, before, seen.place.time_us);
}

// Notes what a call changed: channels that began, ended, or got another value.
void SynapticWatch::note(Node& node, const machine::Synaptic& before, std::int64_t now_us) {
  for (const machine::Channel& channel : node.channels.out) {
    Out* out = find(node, channel.id);
    if (out == nullptr && node.outs.size() < kChannelsMax) {
      out = &node.outs.emplace_back();
      out->id = channel.id;
    }
    if (out == nullptr) continue;
    out->disposed = false;
    const machine::Channel* const old = check::find(before, channel.id);
    const bool ran = old != nullptr && old->started;
    const bool others = std::any_of(node.outs.begin(), node.outs.end(), [&](const Out& other) {
      return other.id != channel.id && other.begun_us >= 0;
    });
    if (channel.started && !ran && others) {
      node.restart_us = now_us;
      node.shifted = false;
    }
    if (channel.started && !ran) {
      out->begun_us = out->waits_us = now_us;
      out->ticks = {};
      out->silent_us = out->sent_us = -1;
      out->written_us = now_us;  // The first tick sends in either mode.
    }
    if (!channel.started && (ran || old == nullptr)) {
      out->silent_us = now_us;
      out->begun_us = -1;
    }
    if (old == nullptr || old->value_bits == channel.value_bits) continue;
    out->written_us = out->wrote_us = now_us;
  }
  for (const machine::Channel& old : before.out) {
    if (check::find(node.channels, old.id) != nullptr) continue;
    if (Out* const out = find(node, old.id)) {
      out->silent_us = now_us;
      out->begun_us = out->wrote_us = -1;
      out->disposed = true;
    }
  }
}

void SynapticWatch::sent(std::uint16_t device, const Observation& seen, const Net& net) {
  Node& node = nodes_[device];
  if (!node.logged || !seen.place.timed()) return;
  const std::int64_t now = seen.place.time_us;
  Out* const out = find(node, machine::channel_id(net.src.devid, net.dest.devid));
  if (out == nullptr) return;  // Created before the log began.
  settle(device, now);
  out->ticks.add(now);
  if (net.src != net.dest) judge_grid(device, seen, out->ticks);
  out->waits_us = now;
  const machine::Channel* const channel = check::find(node.channels, out->id);
  // A write just before the data may have missed its tick; then they have the values before it.
  bool current = true;
  using Values = rubicon::SynapticDataLayout::ValuesAt;
  for (std::size_t i = 0; channel != nullptr && i < channel->size; ++i) {
    current = current && (i + 1) * Values::kUnitBytes <= net.body().size() &&
              bits_of_float(Values::load(net.body().data(), i)) == channel->value_bits[i];
  }
  if (current || out->wrote_us < now - context_.response_us()) out->wrote_us = -1;
  // Data in the outgoing buffer may still leave.
  if (out->silent_us >= 0 && now - out->silent_us > context_.response_us()) {
    context_.report(out->disposed ? "S6-DISPOSED"_rule : "S6-STOPPED"_rule, Severity::kFail,
                    seen.place, device,
                    {"Data of the channel to " + text_of(net.dest) + ", " +
                         ms_text(now - out->silent_us) + " after it was " +
                         (out->disposed ? "disposed." : "stopped, or created and not started."),
                     "Silence.",
                     {}});
    return;
  }
  if (channel == nullptr) return;
  if (net.body().size() != channel->size * std::size_t{4}) {
    context_.report("S2-CONTENT"_rule, Severity::kFail, seen.place, device,
                    {"Data of " + number(net.body().size() / 4) + " values for a channel of " +
                         number(channel->size) + ".",
                     "One value for each connection.",
                     {}});
  }
  const std::int64_t least = machine::us_of(node.channels.period_ticks) - context_.early_us();
  const bool steady = out->sent_us >= 0 && node.step_us < out->sent_us;
  if (steady && now - out->sent_us < least) {
    context_.report(
        "S2-TICK"_rule, Severity::kFail, seen.place, device,
        {"Data of one channel " + ms_text(now - out->sent_us) + " apart.",
         "At least a period, " + ms_text(machine::us_of(node.channels.period_ticks)) + ".",
         {}});
  } else if (out->sent_us >= 0) {
    context_.findings.kept("S2-TICK"_rule);
  }
  const bool saves = channel->mode == machine::Mode::kPowerSave;
  // A write just before the last data may have missed its tick.
  const bool changed = out->written_us >= out->sent_us - context_.response_us();
  if (saves && out->sent_us >= 0 && !changed) {
    context_.report("S3-UNCHANGED"_rule, Severity::kFail, seen.place, device,
                    {"A power-save channel sends although nothing was written for " +
                         ms_text(now - out->written_us) + ".",
                     "Silence until a value changes.",
                     {}});
  } else if (saves) {
    context_.findings.kept("S3-UNCHANGED"_rule);
  }
  out->sent_us = now;
}

}  // namespace rubric::check
