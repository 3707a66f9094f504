#include "conformance/check/judge/synaptic_watch.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "conformance/check/links.h"

namespace rubric::check {
namespace {

const machine::Channel* find(const machine::Synaptic& channels, machine::ChannelId id) {
  for (const machine::Channel& channel : channels.out) {
    if (channel.id == id) return &channel;
  }
  return nullptr;
}

// Returns whether a node may take two values for the same: 0 and -0 are other bits, but equal.
bool may_be_same(std::uint32_t a, std::uint32_t b) { return a == b || ((a | b) << 1) == 0; }

constexpr std::int64_t kOnAirUs = 5'000;  // The longest frame on the air, and its link ack.
constexpr std::size_t kBufferMax = 4;     // And so many channels (decision 122).

}  // namespace

SynapticWatch::SynapticWatch(Context& context, std::size_t devices)
    : context_(context), nodes_(devices) {
  for (std::size_t device = 0; device < devices; ++device) {
    if (context.device(static_cast<std::uint16_t>(device)).whole) {
      begin(static_cast<std::uint16_t>(device));
    }
  }
}

void SynapticWatch::begin_life(std::uint16_t device) {
  nodes_[device] = Node{};
  if (context_.device(device).whole) begin(device);
}

void SynapticWatch::begin(std::uint16_t device) {
  nodes_[device].logged = true;
  nodes_[device].channels.period_ticks = context_.profile(device).synaptic_period_ticks;
}

// Returns whether a channel is from the node to itself; one of a namesake in another island is not.
bool SynapticWatch::is_local(const Node& node, const machine::Channel& channel) {
  const bool here = node.own.pid == kNoIsland || channel.peer.pid == node.own.pid ||
                    channel.peer.pid == machine::kLocalPid;
  return channel.id >> 16 == (channel.id & 0xFFFF) && here;
}

SynapticWatch::Out* SynapticWatch::find(Node& node, machine::ChannelId id) {
  for (Out& out : node.outs) {
    if (out.id == id) return &out;
  }
  return nullptr;
}

void SynapticWatch::called(std::uint16_t device, const Observation& seen, machine::Address own) {
  Node& node = nodes_[device];
  const std::int64_t now_us = seen.place.time_us;
  judge_untold(device, now_us);
  const bool creates = std::holds_alternative<machine::CreateChannel>(*seen.call);
  // The clock may be set before there is a channel.
  const bool steps = std::holds_alternative<machine::SetTimeStep>(*seen.call);
  if (node.channels.period_ticks == 0) {
    node.channels.period_ticks = context_.profile(device).synaptic_period_ticks;
  }
  node.logged = node.logged || creates;
  if (!node.logged && !steps) return;
  node.own = own;
  if (steps) {
    node.step_us = now_us;
    node.former_ticks = node.channels.period_ticks;
  }
  machine::Config config;
  config.role = context_.device(device).role;
  config.id = context_.device(device).am;
  config.profile = context_.profile(device);
  settle(device, now_us);
  node.former = std::make_unique<Former>(
      Former{node.channels, node.ins, node.outs, node.restart_us, node.shifted});
  const machine::Synaptic& before = node.former->channels;
  context_.actions.clear();
  machine::call_synaptic(node.channels, config, own, machine::ticks_of(now_us), *seen.call,
                         context_.actions);
  for (const machine::Action& action : context_.actions.all()) {
    if (action.what != machine::Action::What::kNotify) continue;
    node.wanted.push_back({context_.actions.notice_of(action), action.requirement, seen.place});
    if (const auto* read = std::get_if<machine::ReadInput>(seen.call)) {
      node.wanted.back().read = *read;
    }
  }
  if (const auto* create = std::get_if<machine::CreateChannel>(seen.call)) {
    const machine::ChannelId id = machine::channel_id(create->peer.devid, config.id);
    std::erase_if(node.unknowns, [&](const Unknown& one) { return one.id == id; });
    const auto is = [&](const machine::Channel& channel) { return channel.id == id; };
    const bool input = create->direction == machine::Direction::kIn;
    if (input && std::ranges::none_of(node.channels.in, is)) node.perhaps.push_back(id);
  }
  note(node, before, now_us);
  if (const auto* write = std::get_if<machine::WriteOutput>(seen.call)) {
    Out* const out = find(node, write->id);
    if (out != nullptr && write->pos < machine::kConnectionsMax) {
      note_old(*out, before, write->pos, now_us);
      out->written |= 1U << write->pos;
    }
  }
  note_inputs(node, before, now_us);
}

// Keeps the value before a write, which data that missed their tick may still have.
void SynapticWatch::note_old(Out& out, const machine::Synaptic& before, std::size_t pos,
                             std::int64_t now_us) {
  const machine::Channel* const channel = check::find(before, out.id);
  if (channel == nullptr || pos >= channel->size) return;
  if (out.olds.size() == kOldsMax) {
    out.forgot_us = out.olds.front().until_us;
    out.olds.erase(out.olds.begin());
  }
  out.olds.push_back({now_us, pos, channel->value_bits[pos], (out.written >> pos & 1) == 0});
}

// Notes what a call changed: channels that began, ended, or got another value.
void SynapticWatch::note(Node& node, const machine::Synaptic& before, std::int64_t now_us) {
  for (const machine::Channel& channel : node.channels.out) {
    Out* out = find(node, channel.id);
    if (out == nullptr && node.outs.size() < kChannelsMax) {
      out = &node.outs.emplace_back();
      out->id = channel.id;
    }
    if (out != nullptr && check::find(before, channel.id) == nullptr) {
      out->local = is_local(node, channel);
      const bool away = channel.peer.pid != node.own.pid && channel.peer.pid != machine::kLocalPid;
      const bool sink = node.own.devid == context_.sink_am;
      out->line = sink && away ? machine::Link::kSerial : machine::Link::kRadio;
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
      out->owes = false;
      out->written_us = now_us;  // The first tick sends in either mode.
    }
    if (!channel.started && (ran || old == nullptr)) {
      out->silent_us = now_us;
      out->begun_us = -1;
    }
    if (old == nullptr || old->value_bits == channel.value_bits) continue;
    out->written_us = out->wrote_us = now_us;
    // What went and came back between two ticks may be no change (decision 120).
    if (out->sent_us >= 0 && std::ranges::equal(out->sent_bits, channel.value_bits, may_be_same)) {
      out->wrote_us = -1;
    }
  }
  for (const machine::Channel& old : before.out) {
    if (check::find(node.channels, old.id) != nullptr) continue;
    if (Out* const out = find(node, old.id)) {
      out->silent_us = now_us;
      out->begun_us = out->wrote_us = -1;
      out->disposed = true;
      out->written = 0;
    }
  }
}

void SynapticWatch::judge_content(std::uint16_t node, const Observation& seen, const Net& net) {
  Said said;
  said.expected =
      "SYN_CHANNEL, LEARNING or ESN_DATA, unreliable, one float for each of at most "
      "ten connections.";
  const bool app = net.app_id == static_cast<std::uint8_t>(rubicon::Component::kLearning) ||
                   net.app_id == static_cast<std::uint8_t>(rubicon::Component::kEsnData);
  const std::size_t bytes = net.body().size();
  constexpr std::size_t kUnit = rubicon::SynapticDataLayout::ValuesAt::kUnitBytes;
  if (net.reliable != 0) {
    said.text = "Synaptic data is sent reliable.";
  } else if (!app) {
    said.text = "Synaptic data has the APPID " + number(net.app_id) + ".";
  } else if (bytes == 0 || bytes % kUnit != 0 || bytes / kUnit > machine::kConnectionsMax) {
    said.text = "Synaptic data has " + number(bytes) + " bytes of values.";
  }
  if (!said.text.empty()) {
    context_.report("S2-CONTENT"_rule, Severity::kFail, seen.place, node, std::move(said));
  } else {
    context_.findings.kept("S2-CONTENT"_rule);
  }
  if (net.src == net.dest) {
    context_.report("S4-LOCAL"_rule, Severity::kFail, seen.place, node,
                    {"Data of a channel from the node to itself is sent.",
                     "A local channel hands its values over without sending.",
                     {}});
  }
}

void SynapticWatch::sent(std::uint16_t device, const Observation& seen, const Net& net) {
  judge_content(device, seen, net);
  Node& node = nodes_[device];
  if (!node.logged || !seen.place.timed()) return;
  const std::int64_t now = seen.place.time_us;
  Out* const out = find(node, machine::channel_id(net.src.devid, net.dest.devid));
  if (out == nullptr) return sent_of_nothing(device, seen, net);
  // The calls do not say which of two channels with one id they mean.
  const machine::Channel* const channel = check::find(node.channels, out->id);
  const bool twin = is_twin(node, out->id);
  if (twin && (channel == nullptr || net.dest.pid != channel->peer.pid)) return;
  settle(device, now);
  out->ticks.add(now);
  if (net.src != net.dest) {
    judge_grid(device, seen, out->ticks);
    judge_share(device, seen, *out);
  }
  out->waits_us = now;
  // A write just before the data may have missed its tick; then they have the values before it.
  bool current = true;
  bool as_written = true;  // A value that nobody wrote is free.
  // Older data may hold the same.
  bool again = now <= context_.due_us(device, out->begun_us);
  using Values = rubicon::SynapticDataLayout::ValuesAt;
  for (std::size_t i = 0; channel != nullptr && i < channel->size; ++i) {
    const bool holds = (i + 1) * Values::kUnitBytes <= net.body().size();
    const std::uint32_t bits =
        holds ? bits_of_float(Values::load(net.body().data(), i)) : std::uint32_t{0};
    const bool same = holds && bits == channel->value_bits[i];
    current = current && same;
    const bool before = std::any_of(out->olds.begin(), out->olds.end(), [&](const Out::Old& old) {
      return old.pos == i && now <= context_.due_us(device, old.until_us) &&
             (old.unwritten || old.bits == bits);
    });
    again = again || before;
    as_written = as_written && (same || before || (out->written >> i & 1) == 0);
    out->sent_bits[i] = bits;
  }
  if (current || out->wrote_us < now - context_.response_us(device)) out->wrote_us = -1;
  // Data in the outgoing buffer may still leave.
  if (twin && out->silent_us >= 0) return;
  if (out->silent_us >= 0 && now - out->silent_us > context_.response_us(device)) {
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
  if (channel->peer.pid != machine::kLocalPid && net.dest.pid != channel->peer.pid) {
    context_.report(
        "S2-SEND"_rule, Severity::kFail, seen.place, device,
        {"Data of the channel to " + text_of(channel->peer) + " go to " + text_of(net.dest) + ".",
         "The channel's destination.",
         {}});
  }
  if (net.body().size() != channel->size * std::size_t{4}) {
    context_.report("S2-CONTENT"_rule, Severity::kFail, seen.place, device,
                    {"Data of " + number(net.body().size() / 4) + " values for a channel of " +
                         number(channel->size) + ".",
                     "One value for each connection.",
                     {}});
  } else if (!as_written && !twin && now > context_.due_us(device, out->forgot_us)) {
    context_.report("S2-CONTENT"_rule, Severity::kFail, seen.place, device,
                    {"Data of the channel to " + text_of(net.dest) +
                         " whose values are not those that were written, the last of them " +
                         ms_text(now - out->written_us) + " before.",
                     "The value of each connection, in order.",
                     {}});
  }
  const std::int64_t least = machine::us_of(node.channels.period_ticks) - context_.early_us(device);
  // The data of one tick leave one after the other, and the tick was before the first.
  const std::int64_t gap_us = kOnAirUs + context_.early_us(device);
  if (node.data_us < 0 || now - node.data_us > gap_us) node.tick_us = now;
  node.data_us = now;
  const std::int64_t last_tick_us = std::exchange(out->tick_us, node.tick_us);
  // What had to wait for the channel is nearer to the next.
  const std::int64_t on_us = out->line == machine::Link::kSerial ? node.serial_on_us : node.on_us;
  const bool steady =
      out->sent_us >= 0 && node.step_us < out->sent_us &&
      (on_us == 0 || on_us < out->sent_us - context_.response_us(device)) &&
      !context_.busy(device, out->sent_us - context_.response_us(device), out->sent_us);
  if (steady && now - last_tick_us < least) {
    context_.report(
        "S2-TICK"_rule, Severity::kFail, seen.place, device,
        {"Data of one channel " + ms_text(now - out->sent_us) + " apart.",
         "At least a period, " + ms_text(machine::us_of(node.channels.period_ticks)) + ".",
         {}});
  } else if (out->sent_us >= 0) {
    context_.findings.kept("S2-TICK"_rule);
  }
  // The first tick is not long after the start, another a period after data that did not wait.
  const std::int64_t off_us = context_.response_us(device) + context_.early_us(device);
  const std::int64_t next_us = out->sent_us + machine::us_of(node.channels.period_ticks);
  if (out->sent_us < out->begun_us) {
    const std::int64_t begun_us = std::max(out->begun_us, node.step_us);
    context_.left(device, out->line, seen.place, begun_us,
                  begun_us + patience_us(device, true, begun_us) - context_.response_us(device),
                  "the data to " + text_of(net.dest));
  } else if (steady) {
    context_.left(device, out->line, seen.place, next_us - off_us, next_us + off_us,
                  "the data to " + text_of(net.dest));
  }
  const bool saves = channel->mode == machine::Mode::kPowerSave;
  // A write just before the last data may have missed its tick, unless they have it.
  const std::int64_t missed_us = out->newest ? 0 : context_.response_us(device);
  const bool changed =
      std::exchange(out->owes, false) || out->written_us >= out->sent_us - missed_us;
  if (saves && steady && !twin && !changed) {
    context_.report("S3-UNCHANGED"_rule, Severity::kFail, seen.place, device,
                    {"A power-save channel sends although nothing was written for " +
                         ms_text(now - out->written_us) + ".",
                     "Silence until a value changes.",
                     {}});
  } else if (saves) {
    context_.findings.kept("S3-UNCHANGED"_rule);
  }
  out->sent_us = now;
  out->newest = current && !again;
}

void SynapticWatch::repeated(std::uint16_t device, std::int64_t now_us) {
  std::int64_t& data_us = nodes_[device].data_us;
  if (data_us >= 0 && now_us - data_us <= kLinkRepeatUs) data_us = now_us;
}

// Judges data of a channel that the application did not create.
void SynapticWatch::sent_of_nothing(std::uint16_t device, const Observation& seen, const Net& net) {
  const Device& its = context_.device(device);
  const Node& node = nodes_[device];
  if (!its.whole || node.outs.size() == kChannelsMax) return;  // Created before the log began.
  if (its.role == machine::Role::kBaseStation || net.src.devid != its.am) return;
  context_.report(
      "S6-STOPPED"_rule, Severity::kFail, seen.place, device,
      {"Data to " + text_of(net.dest) + ", to which no channel was created.", "Silence.", {}});
}

void SynapticWatch::Ticks::add(std::int64_t now_us) {
  std::rotate(at_us.begin(), at_us.begin() + 1, at_us.end());
  at_us.back() = now_us;
  if (count < at_us.size()) ++count;
}

void SynapticWatch::member(std::uint16_t device, std::int64_t now_us) {
  nodes_[device].member_us = now_us;
}

void SynapticWatch::able(std::uint16_t device, const machine::SetInterface& set,
                         std::int64_t now_us) {
  settle(device, now_us);
  Node& node = nodes_[device];
  std::erase_if(node.unknowns, [&](const Unknown& one) { return one.link == set.link; });
  const bool serial = set.link == machine::Link::kSerial;
  (serial ? node.serial_on_us : node.on_us) = set.on ? now_us : -1;
}

// Returns since when the node has been able to send by `line` or, if there is none, to tell its
// application; -1 if it cannot now, or if nobody knows. Data of a `local` channel need no radio.
std::int64_t SynapticWatch::able_since(std::uint16_t device, std::int64_t now_us,
                                       std::optional<machine::Link> line, bool local) const {
  const Node& node = nodes_[device];
  const bool sink = context_.device(device).role == machine::Role::kSink;
  const bool serial = line == machine::Link::kSerial;
  const std::int64_t on_us = local ? 0 : serial ? node.serial_on_us : node.on_us;
  if (!node.logged || !context_.run.has_time || on_us < 0) return -1;
  if (!sink && node.member_us < 0) return -1;
  std::int64_t since = std::max(on_us, sink ? 0 : node.member_us);
  for (const BusyTime& busy : context_.busy_times(device)) {
    if (busy.line && busy.line != line) continue;
    if (busy.from_us < now_us && now_us <= busy.to_us) return -1;
    if (busy.to_us < now_us) since = std::max(since, busy.to_us);
  }
  return since;
}

// Returns how long a channel may be silent that did something at `last_us`. Before its first tick a
// node's clock may be shifted, and a new period may begin with the tick after it was set.
std::int64_t SynapticWatch::patience_us(std::uint16_t device, bool first,
                                        std::int64_t last_us) const {
  const std::uint32_t shift = context_.profile(device).synaptic_phase_ticks *
                              static_cast<std::uint32_t>(context_.device(device).am);
  const Node& node = nodes_[device];
  std::uint32_t period = node.channels.period_ticks;
  if (last_us <= node.step_us) period = std::max(period, node.former_ticks);
  return machine::us_of(period + (first ? shift : 0)) + context_.response_us(device) +
         context_.early_us(device);
}

// Returns whether the node's own output has nothing new for this input since its last signal.
bool SynapticWatch::news_of_nothing(std::uint16_t device, const In& in) {
  Node& node = nodes_[device];
  const Out* const out = find(node, in.id);
  const machine::Channel* const channel = check::find(node.channels, in.id);
  if (out == nullptr || channel == nullptr || channel->mode != machine::Mode::kPowerSave) {
    return false;
  }
  const std::int64_t period_us = machine::us_of(node.channels.period_ticks);
  return in.told_us - period_us > std::max(in.begun_us, out->begun_us) &&
         in.told_us - context_.response_us(device) > out->written_us;
}

// Returns whether the node's own output has news for this input at each tick.
bool SynapticWatch::always_news(Node& node, const In& in) {
  const Out* const out = find(node, in.id);
  const machine::Channel* const channel = check::find(node.channels, in.id);
  return out != nullptr && out->local && channel != nullptr &&
         channel->mode == machine::Mode::kReliable && out->begun_us >= 0 &&
         in.told_us > std::max(in.begun_us, out->begun_us);
}

//= S6-CLOCK: Starting a channel again does not shift the clock of the others.
void SynapticWatch::judge_grid(std::uint16_t device, const Observation& seen, const Ticks& ticks) {
  Node& node = nodes_[device];
  const std::int64_t period = machine::us_of(node.channels.period_ticks);
  const auto& at = ticks.at_us;
  if (node.restart_us < 0 || node.shifted || ticks.count < at.size() || period == 0) return;
  if (at[1] > node.restart_us || at[2] <= node.restart_us || node.step_us > at[0]) return;
  // Two ticks before and two after, each a period apart: two grids.
  const std::int64_t off = context_.early_us(device);
  const auto steady = [&](std::int64_t from, std::int64_t to) {
    return std::abs(to - from - period) <= off / 2;
  };
  if (!steady(at[0], at[1]) || !steady(at[2], at[3])) return;
  const std::int64_t rest = (at[2] - at[1]) % period;
  const std::int64_t shift = std::min(rest, period - rest);
  node.shifted = true;
  if (shift <= off) return context_.findings.kept("S6-CLOCK"_rule);
  context_.report("S6-CLOCK"_rule, Severity::kWeak, seen.place, device,
                  {"Behind the start of another channel the ticks of this one lie " +
                       ms_text(shift) + " off those before.",
                   "The same clock as before.",
                   {}});
}

// Returns whether a channel that was able to do something since `runs_us` left ticks out: each of
// them may be late by the response time, but not more the later they are.
bool SynapticWatch::left_out(std::uint16_t device, const Ticks& ticks, std::int64_t runs_us) const {
  const Node& node = nodes_[device];
  const std::int64_t since_us = ticks.at_us.front();
  if (ticks.count < ticks.at_us.size() || runs_us < 0 || since_us <= runs_us) return false;
  const auto periods = static_cast<std::int64_t>(ticks.at_us.size() - 1);
  const std::int64_t most_us = periods * machine::us_of(node.channels.period_ticks) +
                               context_.response_us(device) + context_.early_us(device);
  return since_us > node.step_us && ticks.at_us.back() - since_us > most_us;
}

void SynapticWatch::judge_share(std::uint16_t device, const Observation& seen, Out& out) {
  Node& node = nodes_[device];
  const machine::Channel* const channel = check::find(node.channels, out.id);
  if (channel == nullptr || channel->mode != machine::Mode::kReliable) return;
  const std::int64_t now = seen.place.time_us;
  const std::int64_t able_us = able_since(device, now, out.line);
  const std::int64_t runs_us = std::min(able_us, out.begun_us) < 0 || is_twin(node, out.id)
                                   ? -1
                                   : std::max({able_us, out.begun_us, node.restart_us});
  if (!left_out(device, out.ticks, runs_us)) return;
  const std::int64_t since_us = out.ticks.at_us.front();
  out.ticks = {};
  context_.report(
      "S2-SEND"_rule, unsent(device, since_us, now), seen.place, device,
      {"Data of the channel to " + text_of(channel->peer) + " only 4 times within " +
           ms_text(now - since_us) + ".",
       "Data at each tick, " + ms_text(machine::us_of(node.channels.period_ticks)) + " apart.",
       {}});
}

// Returns how grave it is that data of a tick were not sent between two times.
Severity SynapticWatch::unsent(std::uint16_t device, std::int64_t since_us,
                               std::int64_t now_us) const {
  if (crowded(device, since_us, now_us)) return Severity::kInconclusive;
  return context_.device(device).hearing ? Severity::kFail
                                         : context_.without(device, since_us, now_us);
}

// Returns whether other frames may have filled the outgoing buffer; then a tick's data are refused.
bool SynapticWatch::crowded(std::uint16_t device, std::int64_t from_us, std::int64_t to_us) const {
  const std::vector<Observation>& seen = context_.run.seen;
  const auto from = std::lower_bound(
      seen.begin(), seen.end(), from_us,
      [](const Observation& a, std::int64_t time_us) { return a.place.time_us < time_us; });
  std::size_t others = 0;
  for (auto it = from; it != seen.end() && it->place.time_us <= to_us; ++it) {
    const auto i = static_cast<std::size_t>(it - seen.begin());
    if (it->kind != Observation::Kind::kRadio || it->received) continue;
    Net net;
    const bool data = it->frame.type == am::kNet && parse_net(it->frame.payload, net) &&
                      net.sound && net.trans_id == component::kSynChannel;
    if (context_.who.marks[i].device == device && !data) ++others;
  }
  const std::size_t room = context_.room(device, machine::Link::kRadio);
  return others > std::min(kTickCrowd, room - 1) ||
         nodes_[device].outs.size() > std::min(kBufferMax, room);
}

void SynapticWatch::settle_outputs(std::uint16_t device, std::int64_t now_us) {
  Node& node = nodes_[device];
  for (Out& out : node.outs) {
    const std::int64_t able_us = able_since(device, now_us, out.line);
    // Nothing is sent to the node itself, by whichever name (N4-SELF).
    const bool self = out.local || (out.id & 0xFFFF) == machine::kLocalDevid;
    if (out.begun_us < 0 || self || able_us < 0) continue;
    const auto channel = std::find_if(node.channels.out.begin(), node.channels.out.end(),
                                      [&](const machine::Channel& c) { return c.id == out.id; });
    if (channel == node.channels.out.end()) continue;
    const bool saves = channel->mode == machine::Mode::kPowerSave;
    const bool first = out.sent_us < out.begun_us;
    if (saves && !first && (out.wrote_us < 0 || is_twin(node, out.id))) continue;
    const std::int64_t cause = saves && !first ? out.wrote_us : out.waits_us;
    const std::int64_t since = std::max({cause, able_us, node.step_us, out.begun_us});
    if (now_us - since <= patience_us(device, first, out.sent_us)) continue;
    // A started channel that was never written is only expected to send (decision 120).
    const bool expected = saves && first && out.wrote_us < 0;
    const bool shifted = !first && node.restart_us > since;  // Perhaps the clock alone.
    const ReqId rule = shifted    ? "S6-CLOCK"_rule
                       : expected ? "S3-FIRST"_rule
                       : saves    ? "S3-CHANGED"_rule
                                  : "S2-SEND"_rule;
    Severity severity = unsent(device, since, now_us);
    if ((expected || shifted) && severity == Severity::kFail) severity = Severity::kWeak;
    Place at;
    at.time_us = since;
    context_.report(
        rule, severity, at, device,
        {"No data of the channel from " + number(out.id >> 16) + " to " + number(out.id & 0xFFFF) +
             " for " + ms_text(now_us - since) +
             (saves ? ", though its values are to be sent." : "."),
         "Data at each tick, " + ms_text(machine::us_of(node.channels.period_ticks)) + " apart.",
         {}});
    out.waits_us = now_us;
    out.wrote_us = -1;
    out.ticks = {};
    if (saves) out.sent_us = now_us;  // Said once.
    out.newest = false;
    out.owes = saves;
  }
}

// What was due before a line or the application was taken is judged as of then.
void SynapticWatch::settle(std::uint16_t device, std::int64_t now_us) {
  const std::int64_t before_us = nodes_[device].settled_us;
  for (const BusyTime& busy : context_.busy_times(device)) {
    if (before_us < busy.from_us && busy.from_us < now_us) settle_at(device, busy.from_us);
  }
  settle_at(device, now_us);
  nodes_[device].settled_us = now_us;
}

void SynapticWatch::settle_at(std::uint16_t device, std::int64_t now_us) {
  now_us = std::min(now_us, context_.log_end_us(device));  // Later calls are not known.
  settle_outputs(device, std::min(now_us, context_.captures_end_us(device)));
  settle_unknowns(device, now_us);
  Node& node = nodes_[device];
  if (!context_.device(device).application) return;
  for (In& in : node.ins) {
    const std::int64_t able_us = able_since(device, now_us, {}, in.local);
    if (in.begun_us < 0 || able_us < 0) continue;
    const std::int64_t since = std::max({in.waits_us, able_us, node.step_us});
    if (now_us - since <= patience_us(device, in.told_us < 0, in.told_us)) continue;
    Place at;
    at.time_us = since;
    const std::int64_t response = context_.response_us(device);
    bool came = false;  // Data surely did: then no profile accepts the silence.
    for (std::size_t i = 0; i < in.data_us.size(); ++i) {
      const std::int64_t data_us = in.data_us[i];
      came = came || (in.data_sure[i] && data_us > since && data_us <= now_us - response);
    }
    came = came && context_.device(device).hearing;
    const bool shifted = in.told_us >= 0 && node.restart_us > since;  // Perhaps the clock alone.
    context_.report(
        shifted ? "S6-CLOCK"_rule : "S2-SIGNAL"_rule, shifted ? Severity::kWeak : Severity::kFail,
        at, device,
        {"No synData_received of the channel from " + number(in.id >> 16) + " to " +
             number(in.id & 0xFFFF) + " for " + ms_text(now_us - since) + ".",
         "One at each tick, " + ms_text(machine::us_of(node.channels.period_ticks)) + " apart.",
         {},
         came});
    in.waits_us = now_us;
    in.ticks = {};
  }
}

void SynapticWatch::finish() {
  for (std::uint16_t i = 0; i < nodes_.size(); ++i) {
    settle(i, context_.end_us(i));
    judge_untold(i, context_.end_us(i));
  }
}

}  // namespace rubric::check
