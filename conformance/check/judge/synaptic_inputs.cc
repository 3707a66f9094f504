// Judges input channels: the data that come for them, and synData_received.
#include <algorithm>
#include <optional>
#include <utility>

#include "conformance/check/judge/synaptic_watch.h"

namespace rubric::check {
namespace {

// Returns whether a call succeeded, by what it returned; nothing of another notice.
std::optional<bool> succeeds(const machine::Notice& notice) {
  if (const auto* made = std::get_if<machine::ChannelResult>(&notice)) return made->success;
  if (const auto* done = std::get_if<machine::OperationResult>(&notice)) return done->success;
  if (const auto* value = std::get_if<machine::InputValue>(&notice)) return value->success;
  return {};
}

}  // namespace

SynapticWatch::In* SynapticWatch::find_in(Node& node, machine::ChannelId id) {
  for (In& in : node.ins) {
    if (in.id == id) return &in;
  }
  return nullptr;
}

// The value that read_input_value tells is not judged: data may have been lost or be on their way.
void SynapticWatch::told(std::uint16_t device, const Observation& seen,
                         const machine::Notice& result) {
  Node& node = nodes_[device];
  if (!node.result || node.result->index() != result.index()) return;
  const machine::Notice want = *std::exchange(node.result, std::nullopt);
  const ReqId rule = node.result_rule;
  // What else a call does is seen by the data; a channel that is not there may be unknown here.
  const bool judged = rule == "S1-ID"_rule || rule == "S1-ENLARGE"_rule ||
                      rule == "S1-LIMIT"_rule || rule == "S1-WRITE"_rule || rule == "S1-READ"_rule;
  if (!judged || !context_.device(device).whole || !succeeds(want)) return;
  const auto* const made = std::get_if<machine::ChannelResult>(&result);
  const auto* const right = std::get_if<machine::ChannelResult>(&want);
  // Who refuses a channel, as one that is no member may, refuses the calls for it, too.
  const bool both = *succeeds(want) && *succeeds(result);
  const bool other = both && made != nullptr && made->id != right->id;
  const bool refusable = !*succeeds(want) && *succeeds(result);
  if (!other && !refusable) return;
  const auto name = [](machine::ChannelId id) {
    return number(id >> 16) + "->" + number(id & 0xFFFF);
  };
  const std::string what =
      made != nullptr ? "The call that creates a channel" : "A call that writes or reads a value";
  context_.report(rule, Severity::kFail, seen.place, device,
                  {what + (other ? " returns the id " + name(made->id) + "." : " succeeds."),
                   other ? "The id " + name(right->id) + "." : "It is refused.",
                   {}});
}

// Notes which inputs a call began or ended.
void SynapticWatch::note_inputs(Node& node, const machine::Synaptic& before, std::int64_t now_us) {
  const auto started = [](const machine::Synaptic& channels, machine::ChannelId id) {
    for (const machine::Channel& channel : channels.in) {
      if (channel.id == id) return channel.started;
    }
    return false;
  };
  for (const machine::Channel& channel : node.channels.in) {
    In* in = find_in(node, channel.id);
    if (in == nullptr && node.ins.size() < kChannelsMax) {
      in = &node.ins.emplace_back();
      in->id = channel.id;
      in->ended_us = now_us;
    }
    if (in == nullptr) continue;
    in->peer = channel.peer;
    in->local = is_local(node, channel);
  }
  for (In& in : node.ins) {
    const bool ran = started(before, in.id);
    const bool runs = started(node.channels, in.id);
    if (runs == ran) continue;
    in.begun_us = in.waits_us = runs ? now_us : -1;
    in.ended_us = runs ? -1 : now_us;
    in.told_us = -1;
    in.ticks = {};
  }
}

// Returns the channel that data to the node, or to all, are for.
machine::ChannelId SynapticWatch::input_id(std::uint16_t device, const Net& net) const {
  const Device& its = context_.device(device);
  const bool base = its.role == machine::Role::kBaseStation;
  const std::uint16_t own = base ? machine::kNullDevid : its.am;
  return machine::channel_id(net.src.devid,
                             net.dest.devid == machine::kBroadcastDevid ? own : net.dest.devid);
}

void SynapticWatch::given(std::uint16_t device, const Observation& seen, const Net& net,
                          bool sure) {
  Node& node = nodes_[device];
  if (!node.logged || !net.sound || net.trans_id != component::kSynChannel) return;
  In* const in = find_in(node, input_id(device, net));
  if (in == nullptr) return;
  in->before = in->before || in->begun_us < 0;
  if (in->begun_us < 0) return;
  const std::size_t at = in->data_next++ % in->data_us.size();
  in->data_us[at] = seen.place.time_us;
  // Data of a mote of another island is not its peer's; a sink may have peers there.
  const bool its = net.src.pid == net.dest.pid || net.src.devid == context_.sink_am;
  in->data_sure[at] = sure && (in->peer.pid == machine::kLocalPid ? its : net.src == in->peer);
}

void SynapticWatch::owed(std::uint16_t device, const Observation& seen, const Net& net) {
  Node& node = nodes_[device];
  if (!net.sound || net.trans_id != component::kSynChannel || net.body().empty()) return;
  if (net.body().size() % sizeof(float) != 0 || node.unknowns.size() == kOldsMax) return;
  const machine::ChannelId id = input_id(device, net);
  const auto is = [&](const machine::Channel& channel) { return channel.id == id; };
  if (std::ranges::any_of(node.channels.in, is)) return;
  if (std::ranges::find(node.perhaps, id) != node.perhaps.end()) return;
  // What its application has just disposed may end at the next tick; a copy may be left out.
  const In* const in = find_in(node, id);
  if (in != nullptr && seen.place.time_us - in->ended_us <= context_.early_us()) return;
  const auto copy = [&](const Unknown& one) { return one.id == id && one.seq_num == net.seq_num; };
  if (std::ranges::any_of(node.unknowns, copy)) return;
  node.unknowns.push_back({id, seen.place, net.seq_num});
}

// Reports data for channels that do not exist, of which the application was not told by the tick
// after the next. Only a node whose log has its calls of channels surely shows such events.
void SynapticWatch::settle_unknowns(std::uint16_t device, std::int64_t now_us) {
  Node& node = nodes_[device];
  const std::int64_t able_us = able_since(device, now_us, {});
  if (!node.logged || able_us < 0) return;
  const Device& its = context_.device(device);
  if (!its.application || !its.hearing) return;
  for (Unknown& one : node.unknowns) {
    const std::int64_t since = std::max({one.place.time_us, node.step_us, able_us});
    if (one.told || now_us - since <= patience_us(device, false, one.place.time_us)) continue;
    one.told = true;                                      // Said once.
    const bool open = node.unknowns.size() > kTickCrowd;  // A buffer may have been full.
    context_.report("S5-UNKNOWN"_rule, open ? Severity::kInconclusive : Severity::kFail, one.place,
                    device,
                    {"Data from " + number(one.id >> 16) + " to " + number(one.id & 0xFFFF) +
                         ", for which no channel exists, and no synData_received with status "
                         "unknown in " +
                         ms_text(now_us - one.place.time_us) + ".",
                     "synData_received with status unknown.",
                     {}});
  }
}

void SynapticWatch::told(std::uint16_t device, const Observation& seen,
                         const machine::SynDataReceived& data) {
  Node& node = nodes_[device];
  if (data.status == machine::DataStatus::kUnknownChannel) {
    settle_unknowns(device, seen.place.time_us);
    for (Unknown& one : node.unknowns) one.told = one.told || one.id == data.id;
  }
  In* const in = find_in(node, data.id);
  if (in == nullptr || data.status == machine::DataStatus::kUnknownChannel) return;
  const std::int64_t now = seen.place.time_us;
  if (!context_.run.has_time) return;
  if (in->ended_us >= 0) {
    if (now - in->ended_us <= context_.early_us()) return;  // It was on its way.
    context_.report("S6-STOPPED"_rule, Severity::kFail, seen.place, device,
                    {"synData_received of a channel " + ms_text(now - in->ended_us) +
                         " after it was stopped or disposed, or created and not started.",
                     "Silence.",
                     {}});
    return;
  }
  settle(device, now);
  const std::int64_t response = context_.response_us();
  const bool fresh = data.status == machine::DataStatus::kNew;
  const bool knows = context_.device(device).hearing && !in->local;
  const std::int64_t since = std::max(in->told_us, in->begun_us);
  // Data that came close to a tick may count for this one or the next; a whole log has the order.
  const std::int64_t apart = context_.device(device).whole ? 1 : context_.early_us();
  const auto came = [&](std::int64_t from, std::int64_t to) {
    for (std::size_t i = 0; i < in->data_us.size(); ++i) {
      const std::int64_t at = in->data_us[i];
      if (at >= 0 && at >= from && at <= to && (fresh || in->data_sure[i])) return true;
    }
    return false;
  };
  if (fresh && in->local && news_of_nothing(node, *in)) {
    context_.report("S3-OLD"_rule, Severity::kFail, seen.place, device,
                    {"synData_received of a power-save channel from the node to itself has status "
                     "new, though nothing was written since the last.",
                     "Status old without new data.",
                     {}});
  }
  // The first signal may be about data that came before the start.
  const bool early = in->before && in->told_us < in->begun_us;
  if (knows && fresh && !early && !came(since - response, now)) {
    context_.report("S3-OLD"_rule, Severity::kFail, seen.place, device,
                    {"synData_received has status new, though no data came for " +
                         ms_text(now - since + response) + ".",
                     "Status old without new data.",
                     {}});
  } else if (knows && !fresh && came(since + apart, now - response)) {
    context_.report(
        "S2-SIGNAL"_rule, Severity::kFail, seen.place, device,
        {"synData_received has status old, though data came since the last.", "Status new.", {}});
  } else {
    context_.findings.kept(fresh ? "S2-SIGNAL"_rule : "S3-OLD"_rule);
  }
  if (!fresh && in->local && always_news(node, *in)) {
    context_.report("S4-LOCAL"_rule, Severity::kFail, seen.place, device,
                    {"synData_received of a reliable channel from the node to itself has status "
                     "old, though its output runs.",
                     "Status new at each tick.",
                     {}});
  }
  // One tick may be late and the next one prompt (decision 125); in a whole log each counts from
  // the one before (decision 24).
  const std::int64_t late = context_.device(device).whole ? context_.run.slack_us : response;
  const std::int64_t least =
      machine::us_of(node.channels.period_ticks) - late - context_.early_us();
  const bool steady = in->told_us >= in->begun_us && node.step_us < in->told_us;
  if (in->told_us >= 0 && steady && now - in->told_us < least) {
    context_.report(
        "S2-SIGNAL"_rule, Severity::kFail, seen.place, device,
        {"synData_received of one channel " + ms_text(now - in->told_us) + " apart.",
         "One at each tick, " + ms_text(machine::us_of(node.channels.period_ticks)) + " apart.",
         {}});
  }
  in->told_us = in->waits_us = now;
  in->before = false;
  in->ticks.add(now);
  judge_grid(device, seen, in->ticks);
}

}  // namespace rubric::check
