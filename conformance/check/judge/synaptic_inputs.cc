// Judges input channels: the data that come for them, and synData_received.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
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

// Returns whether there may be two channels of that id, to peers in two islands.
bool SynapticWatch::is_twin(const Node& node, machine::ChannelId id) {
  return std::ranges::find(node.twins, id) != node.twins.end();
}

// Returns whether a channel of that id may be one from the node to itself, by either name.
bool SynapticWatch::may_be_local(machine::ChannelId id) {
  const auto from = static_cast<std::uint16_t>(id >> 16);
  const auto to = static_cast<std::uint16_t>(id & 0xFFFF);
  return from == to || from == machine::kLocalDevid || to == machine::kLocalDevid;
}

// Takes back a call that the model took and the node refused. A mote that is no member may do so;
// who has room for a channel, or has the channel, may not.
void SynapticWatch::refused(std::uint16_t device, const Observation& seen, const Wanted& wanted) {
  Node& node = nodes_[device];
  const Device& its = context_.device(device);
  const bool outside = its.role == machine::Role::kMote && node.member_us < 0;
  const auto* const made = std::get_if<machine::ChannelResult>(&wanted.result);
  const auto odd = [&](const machine::Channel& channel) {
    return channel.id == made->id &&
           (machine::is_reserved(channel.peer.pid) || machine::is_reserved(channel.peer.devid));
  };
  const bool wrong = made != nullptr && its.whole && node.own.pid != kNoIsland &&
                     std::ranges::none_of(node.channels.in, odd) &&
                     std::ranges::none_of(node.channels.out, odd);
  // The channel is there, unless a call that made it may have been refused.
  const bool runs = wanted.rule == "S1-START"_rule || wanted.rule == "S1-ALL"_rule ||
                    wanted.rule == "S1-CLOCK"_rule;
  const bool there = runs && its.whole && node.twins.empty() && node.perhaps.empty();
  if (!outside && !wrong && !there) return;
  if (node.wanted.empty()) {  // It was the last call.
    node.channels = node.former->channels;
    node.ins = node.former->ins;
    node.outs = node.former->outs;
    node.restart_us = node.former->restart_us;
    node.shifted = node.former->shifted;
  }
  if (outside && made != nullptr) node.perhaps.push_back(made->id);  // Other calls lay between.
  if (outside) return;
  context_.report(
      wanted.rule, Severity::kFail, seen.place, device,
      {made != nullptr ? "The call that creates a channel is refused, though there is room."
                       : "An operation that is to succeed is refused.",
       made != nullptr ? "Success, and the id of the channel." : "Success.",
       {}});
}

// Reports calls that returned nothing until `now_us`. Only a whole log surely has each result.
void SynapticWatch::judge_untold(std::uint16_t device, std::int64_t now_us) {
  std::erase_if(nodes_[device].wanted, [&](const Wanted& one) {
    if (!context_.device(device).whole || !context_.run.has_time) return true;
    if (now_us <= context_.due_us(device, one.called.time_us)) return false;
    context_.report(one.rule, Severity::kFail, one.called, device,
                    {"The application called an operation on a channel, and was told no result "
                     "within " +
                         ms_text(context_.response_us(device)) + ".",
                     "The result, at once.",
                     {}});
    return true;
  });
}

// Returns whether a value of `time_us` at `pos` was surely overwritten by data that came later, and
// that were taken before `until_us`.
bool SynapticWatch::overwritten(std::uint16_t device, const In& in, std::int64_t time_us,
                                std::size_t pos, std::int64_t until_us) const {
  return std::ranges::any_of(in.came, [&](const In::Came& later) {
    return later.sure && pos < later.bits.size() &&
           later.time_us > context_.due_us(device, time_us) &&
           context_.due_us(device, later.time_us) < until_us;
  });
}

// Keeps the values of data that came for a channel that runs.
void SynapticWatch::keep_values(std::uint16_t device, In& in, const Observation& seen,
                                const Net& net, bool sure) {
  using Values = rubicon::SynapticDataLayout::ValuesAt;
  const std::int64_t now = seen.place.time_us;
  const std::vector<Wanted>& wanted = nodes_[device].wanted;
  const std::int64_t called_us = wanted.empty() ? now : wanted.front().called.time_us;
  while (!in.came.empty() && overwritten(device, in, in.came.front().time_us,
                                         in.came.front().bits.size() - 1, called_us)) {
    in.came.erase(in.came.begin());
  }
  if (in.came.size() == kOldsMax) in.forget(now);
  const std::size_t count = std::min<std::size_t>(in.size, net.body().size() / Values::kUnitBytes);
  if (count == 0) return;
  // A copy of what came before, or what was overtaken, may be left out.
  const bool next =
      in.came.empty() || static_cast<std::int16_t>(net.seq_num - in.came.back().seq_num) > 0;
  In::Came& came = in.came.emplace_back();
  came = {now, net.seq_num, sure && next && !context_.crowded(device, now), {}};
  for (std::size_t i = 0; i < count; ++i) {
    came.bits.push_back(bits_of_float(Values::load(net.body().data(), i)));
  }
}

// Judges the value that read_input_value tells: one that came, and that no later one overwrote.
void SynapticWatch::judge_value(std::uint16_t device, const Observation& seen, const Wanted& wanted,
                                float value) {
  Node& node = nodes_[device];
  const In* const in = find_in(node, wanted.read->id);
  const std::size_t pos = wanted.read->pos;
  const std::int64_t called_us = wanted.called.time_us;
  if (in == nullptr || in->local || is_twin(node, in->id)) return;
  if (!overwritten(device, *in, in->unknown_us, pos, called_us)) return;
  const In::Came* last = nullptr;
  for (const In::Came& came : in->came) {
    if (pos >= came.bits.size() || overwritten(device, *in, came.time_us, pos, called_us)) continue;
    const float held = float_of_bits(came.bits[pos]);
    if (held == value || std::isnan(held)) return context_.findings.kept("S1-READ"_rule);
    last = &came;
  }
  if (last == nullptr) return;
  const auto text = [](float one) { return fmt::format("{}", one); };
  context_.report(
      "S1-READ"_rule, Severity::kFail, seen.place, device,
      {"read_input_value tells " + text(value) + " for connection " + number(pos) +
           " of the channel from " + number(in->id >> 16) + " to " + number(in->id & 0xFFFF) +
           ". The data that came " + ms_text(called_us - last->time_us) + " before the call hold " +
           text(float_of_bits(last->bits[pos])) + ".",
       "The value that was received last.",
       {}});
}

void SynapticWatch::told(std::uint16_t device, const Observation& seen,
                         const machine::Notice& result) {
  Node& node = nodes_[device];
  // The results of calls before it may never come.
  const auto its = std::ranges::find_if(
      node.wanted, [&](const Wanted& one) { return one.result.index() == result.index(); });
  if (its == node.wanted.end()) return;
  const Wanted wanted = *its;
  node.wanted.erase(its);
  const machine::Notice& want = wanted.result;
  const ReqId rule = wanted.rule;
  if (!succeeds(want)) return;
  if (*succeeds(want) && !*succeeds(result)) return refused(device, seen, wanted);
  const auto* const made = std::get_if<machine::ChannelResult>(&result);
  if (made != nullptr && made->success && !*succeeds(want)) node.perhaps.push_back(made->id);
  // Who keeps two channels of one id may: the calls do not say which of them they mean.
  const auto* const right = std::get_if<machine::ChannelResult>(&want);
  if (rule == "S1-ID"_rule && right != nullptr && !right->success) {
    if (*succeeds(result)) node.twins.push_back(right->id);
    return;
  }
  // What else a call does is seen by the data; a channel that is not there may be unknown here.
  const bool judged = rule == "S1-ID"_rule || rule == "S1-ENLARGE"_rule ||
                      rule == "S1-LIMIT"_rule || rule == "S1-WRITE"_rule || rule == "S1-READ"_rule;
  if (!judged || !context_.device(device).whole) return;
  const bool both = *succeeds(want) && *succeeds(result);
  const bool other = both && made != nullptr && made->id != right->id;
  const bool refusable = !*succeeds(want) && *succeeds(result);
  if (const auto* read = std::get_if<machine::InputValue>(&result); both && read != nullptr) {
    return judge_value(device, seen, wanted, read->value);
  }
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
    if (in->size != channel.size) in->forget(now_us);
    in->size = channel.size;
  }
  for (In& in : node.ins) {
    const bool ran = started(before, in.id);
    const bool runs = started(node.channels, in.id);
    if (runs == ran) continue;
    in.begun_us = in.waits_us = runs ? now_us : -1;
    in.ended_us = runs ? -1 : now_us;
    in.told_us = -1;
    in.ticks = {};
    in.forget(now_us);
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
  const bool from_peer = in->peer.pid == machine::kLocalPid ? its : net.src == in->peer;
  in->data_sure[at] = sure && from_peer;
  in->data_its[at] = from_peer || is_twin(node, in->id);
  if (context_.device(device).whole) keep_values(device, *in, seen, net, in->data_sure[at]);
}

void SynapticWatch::heard(std::uint16_t device, const Observation& seen, const Net& net) {
  Node& node = nodes_[device];
  if (!context_.device(device).whole || net.trans_id != component::kSynChannel) return;
  const std::int64_t now = seen.place.time_us;
  const machine::ChannelId id = input_id(device, net);
  const In* const in = find_in(node, id);
  // What came for a channel that runs, and from its peer, is soon of no use to anything else.
  if (in != nullptr && in->begun_us >= 0 && !is_twin(node, id) &&
      (in->peer.pid == machine::kLocalPid || net.src == in->peer)) {
    std::erase_if(node.heard, [&](const Heard& one) {
      return one.id == id && in->begun_us < one.at_us && context_.due_us(device, one.at_us) < now;
    });
  }
  node.forgot_heard = node.forgot_heard || node.heard.size() == kOldsMax;
  if (!node.forgot_heard) node.heard.push_back({id, now});
}

// Judges synData_received that says that no channel exists, by a log that has all of the node.
void SynapticWatch::told_of_unknown(std::uint16_t device, const Observation& seen,
                                    machine::ChannelId id) {
  Node& node = nodes_[device];
  const Device& its = context_.device(device);
  if (!its.whole || its.role == machine::Role::kBaseStation || node.forgot_heard) return;
  if (may_be_local(id)) return;
  const auto one =
      std::ranges::find_if(node.heard, [&](const Heard& heard) { return heard.id == id; });
  if (one != node.heard.end()) {
    node.heard.erase(one);
    return;
  }
  context_.report(
      "S5-UNKNOWN"_rule, Severity::kFail, seen.place, device,
      {"synData_received with status unknown, though no data came from " + number(id >> 16) +
           " to " + number(id & 0xFFFF) + " of which it was not told.",
       "One for the data of a channel that does not exist.",
       {}});
}

// Judges synData_received of a channel that the application did not create.
void SynapticWatch::told_of_nothing(std::uint16_t device, const Observation& seen,
                                    machine::ChannelId id) {
  const Device& its = context_.device(device);
  const Node& node = nodes_[device];
  if (!its.whole || its.role == machine::Role::kBaseStation || may_be_local(id)) return;
  if (node.ins.size() == kChannelsMax || std::ranges::count(node.perhaps, id) != 0) return;
  context_.report("S6-STOPPED"_rule, Severity::kFail, seen.place, device,
                  {"synData_received of a channel from " + number(id >> 16) + " to " +
                       number(id & 0xFFFF) + ", which was not created.",
                   "Silence.",
                   {}});
}

// Returns whether messages that waited with these data may have filled the buffer: those that came
// by the same interface since a line or the application was busy (decision 122).
bool SynapticWatch::flooded(std::uint16_t device, const Unknown& one) const {
  const std::int64_t came_us = one.place.time_us;
  if (context_.crowded(device, came_us)) return true;
  const std::vector<Observation>& seen = context_.run.seen;
  const std::size_t room = context_.room(device, one.link);
  return std::ranges::any_of(context_.busy_times(device), [&](const BusyTime& busy) {
    if (busy.from_us > came_us || came_us > busy.to_us + context_.response_us(device)) return false;
    std::size_t others = 0;
    const auto first =
        std::ranges::lower_bound(seen, busy.from_us - context_.response_us(device), {},
                                 [](const Observation& other) { return other.place.time_us; });
    for (auto i = static_cast<std::size_t>(first - seen.begin());
         i < seen.size() && seen[i].place.time_us <= came_us; ++i) {
      const bool its = context_.who.marks[i].receiver == device && seen[i].received;
      if (its && seen[i].frame.link == one.link) ++others;
    }
    return others > room;  // These data are one of them.
  });
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
  if (in != nullptr && seen.place.time_us - in->ended_us <= context_.early_us(device)) return;
  const auto copy = [&](const Unknown& one) { return one.id == id && one.seq_num == net.seq_num; };
  if (std::ranges::any_of(node.unknowns, copy)) return;
  node.unknowns.push_back({id, seen.place, net.seq_num, seen.frame.link});
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
    one.told = true;  // Said once.
    // A buffer may have been full.
    const bool open = node.unknowns.size() > kTickCrowd || flooded(device, one);
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
    return told_of_unknown(device, seen, data.id);
  }
  In* const in = find_in(node, data.id);
  if (in == nullptr) return told_of_nothing(device, seen, data.id);
  const std::int64_t now = seen.place.time_us;
  if (!context_.run.has_time) return;
  if (is_twin(node, data.id)) {  // Which of the two it is about is not known.
    in->told_us = in->waits_us = in->known_us = now;
    return;
  }
  if (in->ended_us >= 0) {
    if (now - in->ended_us <= context_.early_us(device)) return;  // It was on its way.
    context_.report("S6-STOPPED"_rule, Severity::kFail, seen.place, device,
                    {"synData_received of a channel " + ms_text(now - in->ended_us) +
                         " after it was stopped or disposed, or created and not started.",
                     "Silence.",
                     {}});
    return;
  }
  settle(device, now);
  const std::int64_t response = context_.response_us(device);
  const bool fresh = data.status == machine::DataStatus::kNew;
  const bool knows = context_.device(device).hearing && !in->local;
  const std::int64_t since = std::max(in->told_us, in->begun_us);
  // Data that came close to a tick may count for this one or the next; a whole log has the order.
  const std::int64_t apart = context_.device(device).whole ? 1 : context_.early_us(device);
  // Returns the first of the data that came between two times, and takes them for told if they are.
  const auto came = [&](std::int64_t from, std::int64_t to) {
    std::int64_t* first = nullptr;
    for (std::size_t i = 0; i < in->data_us.size(); ++i) {
      std::int64_t& at = in->data_us[i];
      const bool counts = fresh ? in->data_its[i] : in->data_sure[i];
      const bool within = at >= 0 && at >= from && at <= to && counts;
      if (within && (first == nullptr || at < *first)) first = &at;
    }
    if (first != nullptr && fresh) *first = -1;
    return first != nullptr;
  };
  if (fresh && in->local && news_of_nothing(device, *in)) {
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
  } else if (knows && !fresh &&
             came(std::max(in->known_us, in->begun_us) + apart, now - response)) {
    context_.report("S2-SIGNAL"_rule, Severity::kFail, seen.place, device,
                    {"synData_received has status old, though data came since the last.",
                     "Status new.",
                     {},
                     true});
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
      machine::us_of(node.channels.period_ticks) - late - context_.early_us(device);
  const bool steady = in->told_us >= in->begun_us && node.step_us < in->told_us;
  if (in->told_us >= 0 && steady && now - in->told_us < least) {
    context_.report(
        "S2-SIGNAL"_rule, Severity::kFail, seen.place, device,
        {"synData_received of one channel " + ms_text(now - in->told_us) + " apart.",
         "One at each tick, " + ms_text(machine::us_of(node.channels.period_ticks)) + " apart.",
         {}});
  }
  in->told_us = in->waits_us = now;
  // The next signal tells data that came just before one of status old.
  in->known_us = fresh ? now : std::max(in->known_us, now - response);
  in->before = false;
  in->ticks.add(now);
  judge_grid(device, seen, in->ticks);
  const std::int64_t able_us = able_since(device, now, {}, in->local);
  const std::int64_t runs_us =
      std::min(able_us, in->begun_us) < 0 ? -1 : std::max({able_us, in->begun_us, node.restart_us});
  if (!left_out(device, in->ticks, runs_us)) return;
  context_.report(
      "S2-SIGNAL"_rule, Severity::kFail, seen.place, device,
      {"synData_received of one channel only 4 times within " +
           ms_text(now - in->ticks.at_us.front()) + ".",
       "One at each tick, " + ms_text(machine::us_of(node.channels.period_ticks)) + " apart.",
       {}});
  in->ticks = {};
}

}  // namespace rubric::check
