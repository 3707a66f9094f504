#include "conformance/check/judge/context.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <optional>
#include <utility>

#include "codec/reflect/requirements.h"
#include "conformance/check/links.h"

namespace rubric::check {
namespace {

bool is_of(ReqId requirement, std::string_view group) {
  return std::string_view(reflect::requirement(requirement).id).starts_with(group);
}

}  // namespace

Context::Context(const Run& r, const Options& o, const Identity& w, Findings& f)
    : run(r), options(o), who(w), findings(f), unlogged_(terms_of(o)) {
  for (const LoggedNode& node : run.nodes) logged_.push_back(terms_of(options, node.stated));
}

void Context::look_up() {
  down_taps.resize(run.taps.size());
  std::vector<std::int64_t> file_from_us(run.files.size(), INT64_MAX);
  std::vector<std::int64_t> file_to_us(run.files.size(), INT64_MIN);
  for (const Observation& seen : run.seen) {
    if (seen.kind == Observation::Kind::kSerial && seen.to_mote) down_taps[seen.tap] = true;
    std::int64_t& from_us = file_from_us[seen.place.file];
    from_us = std::min(from_us, seen.place.time_us);
    std::int64_t& to_us = file_to_us[seen.place.file];
    to_us = std::max(to_us, seen.place.time_us);
    if (!seen.node.empty() || !seen.place.timed()) continue;
    if (!captured_) captured_ = {seen.place.time_us, seen.place.time_us};
    captured_->first = std::min(captured_->first, seen.place.time_us);
    captured_->second = std::max(captured_->second, seen.place.time_us);
  }
  tap_from_us.resize(run.taps.size());
  for (const Observation& seen : run.seen) tap_from_us[seen.tap] = file_from_us[seen.place.file];
  for (const LoggedNode& node : run.nodes) {
    logs_us_.emplace_back(node.whole ? INT64_MIN : file_from_us[node.file],
                          node.whole ? INT64_MAX : file_to_us[node.file]);
  }
  told_.resize(run.nodes.size());
  begun_us_.assign(run.nodes.size(), INT64_MAX);
  last_us.assign(who.devices.size(), -1);
  for (std::size_t i = 0; i < run.seen.size(); ++i) {
    const std::uint16_t sender = who.marks[i].device;
    const Observation& seen = run.seen[i];
    if (sender < told_.size() && seen.notice != nullptr) told_[sender].insert(seen.notice->index());
    // A mote that joins has sent no message before.
    const auto* joined = seen.notice ? std::get_if<machine::Joined>(seen.notice) : nullptr;
    if (sender < begun_us_.size() &&
        (seen.kind == Observation::Kind::kReboot || (joined != nullptr && joined->success))) {
      begun_us_[sender] = std::min(begun_us_[sender], seen.place.time_us);
    }
    if (sender != kNobody) last_us[sender] = run.seen[i].place.time_us;
  }
  sink_am = profile(kNobody).sink_id;  // Nobody states another.
  mote_of_am.assign(65536, kNobody);
  next_of_am.assign(who.devices.size(), kNobody);
  for (std::size_t i = 0; i < who.devices.size(); ++i) {
    const Device& device = who.devices[i];
    const auto index = static_cast<std::uint16_t>(i);
    if (!device.known) continue;
    if (device.role == machine::Role::kMote) {
      next_of_am[i] = mote_of_am[device.am];
      mote_of_am[device.am] = index;
    }
    if (device.role != machine::Role::kSink) continue;
    sink_am = device.am;
    only_sink = sinks.empty() ? index : kNobody;
    sinks.push_back(index);
  }
  const bool stranger = std::ranges::any_of(
      who.devices, [&](const Device& d) { return !d.known && d.am == sink_am && d.radio; });
  if (stranger) only_sink = kNobody;
  const Given given(options);
  const std::uint16_t said = given.sink_am().value_or(sink_am);
  if (mote_of_am[said] == kNobody) sink_am = said;
  for (const Contradiction& one : who.contradictions) {
    std::uint16_t node = who.marks[one.index].device;
    if (node != kNobody && device(node).role == machine::Role::kBaseStation) {
      node = device(node).partner;
    }
    report(one.requirement, Severity::kInconclusive, run.seen[one.index].place, node,
           {one.text, one.expected, {}});
  }
  doubt_lone_replies();
  find_restarts();
  Losses losses = find_losses(run, who, options);
  line_losses = std::move(losses.lines);
  lossy_air = who.hears_radio && losses.many_of_air;
  copies_missed = losses.copies;
  untimed_taps = run.unordered_taps;
  untimed_taps.resize(run.taps.size());
  unordered = std::find(untimed_taps.begin(), untimed_taps.end(), true) != untimed_taps.end();
  if (run.has_time) return;
  std::optional<std::int64_t> order;  // A file without stamps, or all that have some.
  for (const Observation& seen : run.seen) {
    const std::int64_t its = seen.place.in_order() ? -1 : std::int64_t{seen.place.file};
    unordered = unordered || (order && *order != its);
    order = its;
    if (its >= 0) untimed_taps[seen.tap] = true;
  }
}

bool Context::comes(std::uint16_t node, const Observation& sent, machine::Address src,
                    std::uint16_t seq_num) const {
  if (device(node).whole || !sent.place.timed()) return false;
  const auto is_cause = [&](const Observation& seen) {
    const std::uint16_t sender =
        who.marks[static_cast<std::size_t>(&seen - run.seen.data())].device;
    const bool down = seen.kind == Observation::Kind::kSerial && sender != kNobody &&
                      device(sender).partner == node;
    const bool air = seen.kind == Observation::Kind::kRadio && sender != node;
    Net net;
    // A frame of the same time that is before it in the run has come already.
    return &seen > &sent && (down || air) && seen.tap != sent.tap && seen.frame.type == am::kNet &&
           parse_net(seen.frame.payload, net) && net.src == src && net.seq_num == seq_num;
  };
  return soon(sent.place.time_us, is_cause) != nullptr;
}

const TapsCross& Context::taps_cross() const {
  if (!taps_cross_) taps_cross_ = find_taps_cross();
  return *taps_cross_;
}

// A lone reply, of whose sink nothing else is seen, may be that of a known sink which offers a
// wrong island: then this sink misses a frame.
void Context::doubt_lone_replies() {
  for (std::size_t i = 0; i < run.seen.size(); ++i) {
    const Observation& seen = run.seen[i];
    const std::uint16_t sender = who.marks[i].device;
    if (seen.kind != Observation::Kind::kRadio || seen.frame.type != am::kJoinReply) continue;
    if (sender == kNobody || device(sender).frames != 1 || !device(sender).taps.empty()) continue;
    const bool given = std::ranges::any_of(options.nodes, [&](const KnownNode& node) {
      return node.role == machine::Role::kSink && node.island == device(sender).island;
    });
    for (const std::uint16_t sink : sinks) {
      const bool misses = std::ranges::any_of(device(sink).holes, [&](const auto& hole) {
        return hole.first <= seen.place.time_us && seen.place.time_us <= hole.second;
      });
      if (given || sink == sender || device(sink).am != seen.frame.src || !misses) continue;
      report("J3-ADDRESS"_rule, Severity::kInconclusive, seen.place, sink,
             {"join_reply offers island " + number(device(sender).island) +
                  ", of whose sink nothing else is seen, while this one misses a frame.",
              "Island " + number(device(sink).island) + ", if this sink sent it.",
              {}});
    }
  }
}

void Context::find_restarts() {
  struct Heard {
    std::map<std::uint16_t, std::pair<std::uint8_t, std::int64_t>> last;  // By device: DSN, time.
    std::array<int, 256> at_dsn = {};  // How many devices sent that DSN last.
  };
  std::map<std::uint16_t, Heard> heard;  // By AM address.
  for (const std::uint16_t sink : sinks) heard[device(sink).am];
  for (std::size_t i = run.past.senders.size(); i < run.seen.size(); ++i) {
    const Observation& seen = run.seen[i];
    const std::uint16_t sender = who.marks[i].device;
    const bool sent = seen.kind == Observation::Kind::kRadio && !who.marks[i].repeat;
    if (!sent || !seen.has_dsn || sender == kNobody) continue;
    const auto at = heard.find(seen.frame.src);
    if (at == heard.end()) continue;
    Heard& its = at->second;
    // Which of them it is of may be wrong; a DSN that goes on with none has begun anew.
    bool goes_on = false;
    for (int gap = 1; gap <= kGapMax; ++gap) {
      goes_on |= its.at_dsn[static_cast<std::uint8_t>(seen.dsn - gap)] > 0;
    }
    const std::int64_t now_us = seen.place.time_us;
    for (const std::uint16_t sink : sinks) {
      const auto last = its.last.find(sink);
      if (goes_on || last == its.last.end()) continue;
      const bool stranger = !device(sender).known && device(sink).last_us < now_us;
      if (sink != sender && !stranger) continue;
      auto& begun = restarts_[sink];
      const std::int64_t since_us = last->second.second;
      if (!begun.empty() && begun.back().first == since_us) begun.pop_back();
      begun.emplace_back(since_us, now_us);
    }
    const auto [last, first] = its.last.try_emplace(sender, seen.dsn, now_us);
    if (!first) --its.at_dsn[last->second.first];
    last->second = {seen.dsn, now_us};
    ++its.at_dsn[seen.dsn];
  }
}

bool Context::may_have_restarted(std::uint16_t sink, std::int64_t from_us,
                                 std::int64_t to_us) const {
  const auto begun = restarts_.find(sink);
  if (begun == restarts_.end() || device(sink).hearing) return false;
  return std::ranges::any_of(begun->second, [&](const auto& between) {
    return between.first < to_us && between.second > from_us;
  });
}

bool Context::rests_on_order(ReqId requirement, const Place& at, std::uint16_t node) const {
  // A frame that breaks a rule of the format breaks it at any time.
  if (!unordered || is_of(requirement, "WIRE-")) return false;
  if (!at.in_order()) return true;
  if (node == kNobody) return false;
  // Replies to requests are on the air alone; reports of joins on a line are not.
  const bool air = is_of(requirement, "J3-") || is_of(requirement, "J10-");
  if (air && (run.unordered_taps.empty() || requirement == "J3-TIME"_rule)) return false;
  const Device& d = device(node);
  const Device& lines =
      d.role == machine::Role::kBaseStation && d.partner != kNobody ? device(d.partner) : d;
  for (const std::uint32_t tap : lines.taps) {
    if (untimed_taps[tap]) return true;
  }
  return false;
}

bool Context::half_heard(std::uint16_t node) const {
  const Device& d = device(node);
  const bool down = std::any_of(d.taps.begin(), d.taps.end(),
                                [this](std::uint32_t tap) { return down_taps[tap]; });
  return !d.hearing && !d.taps.empty() && !down;
}

const std::vector<std::uint32_t>& Context::lines_of(std::uint16_t node) const {
  const Device& d = device(node);
  const bool base = d.role == machine::Role::kBaseStation && d.partner != kNobody;
  return base ? device(d.partner).taps : d.taps;
}

Severity Context::on_line(std::uint16_t node, Severity severity) const {
  const bool lossy = std::ranges::any_of(
      lines_of(node), [this](std::uint32_t tap) { return line_losses[tap].any; });
  // A frame that came damaged may be the one that is missing.
  const bool damaged = who.damaged(at_us - response_us(node), at_us);
  // Where files are in no order, a frame of another line may be taken for this node's.
  return lossy || unordered || damaged ? std::min(severity, Severity::kInconclusive) : severity;
}

Severity Context::unless_given(std::uint16_t sink, std::int64_t since_us, Severity severity) const {
  if (options.start_cold) since_us = std::max(since_us, run.start_us);
  const bool given =
      device(sink).whole || (has_lines(sink) && !half_heard(sink) && line_recorded(sink, since_us));
  return given ? on_line(sink, severity) : std::min(severity, Severity::kInconclusive);
}

Severity Context::absent_on_line(std::uint16_t node, Severity severity) {
  severity = on_line(node, severity);
  if (severity <= Severity::kInconclusive) return severity;
  for (const std::uint32_t tap : lines_of(node)) {
    if (line_losses[tap].most == 0) continue;
    --line_losses[tap].most;
    return Severity::kInconclusive;
  }
  return severity;
}

Severity Context::own_absent_on_line(std::uint16_t node, Severity severity) {
  const Device& d = device(node);
  const std::uint16_t sink = d.role == machine::Role::kBaseStation ? d.partner : node;
  const auto [known, is_new] = misses_passed_.try_emplace(sink);
  if (is_new) known->second = !d.whole && sink != kNobody && misses_passed(run, who, sink);
  return absent_on_line(node,
                        known->second ? std::min(severity, Severity::kInconclusive) : severity);
}

bool Context::has_lines(std::uint16_t node) const {
  const Device& d = device(node);
  if (d.role == machine::Role::kMote || d.whole || !d.taps.empty()) return true;
  return d.role == machine::Role::kBaseStation &&
         (d.hearing || (d.partner != kNobody && !device(d.partner).taps.empty()));
}

bool Context::line_recorded(std::uint16_t sink, std::int64_t time_us) const {
  return run.past.until_us >= 0 || std::ranges::all_of(device(sink).taps, [&](std::uint32_t tap) {
           return tap_from_us[tap] <= time_us;
         });
}

void Context::needs_host(std::uint16_t sink, const Place& at) {
  Gathered& gathered = unseen_[sink];
  if (gathered.count++ == 0) gathered.first.place = at;
  gathered.first.last = at;
}

// Returns whether the finding is one of many that finish() reports as one.
bool Context::gather(const Finding& finding, std::uint16_t node) {
  const Device& d = device(node);
  if (finding.severity != Severity::kInconclusive || d.application || d.hearing) return false;
  if (d.role == machine::Role::kBaseStation && d.partner != kNobody && half_heard(d.partner)) {
    needs_host(d.partner, finding.place);
    return true;
  }
  if (!finding.place.in_order() || finding.place.time_us <= last_us[node]) return false;
  Gathered& gathered = silent_[node];
  if (gathered.count++ == 0) gathered.first = finding;
  gathered.first.last = finding.place;
  return true;
}

void Context::finish() {
  for (auto& [node, gathered] : silent_) {
    gathered.first.count = gathered.count;
    if (gathered.count > 1) {
      gathered.first.text = "Nothing of " + device(node).name + " is seen from here on, and " +
                            number(gathered.count) +
                            " things that it may owe stay open. The first: " + gathered.first.text;
    }
    findings.add(std::move(gathered.first));
  }
  for (auto& [sink, gathered] : unseen_) {
    gathered.first.severity = Severity::kInconclusive;
    gathered.first.count = gathered.count;
    gathered.first.node = device(sink).name;
    gathered.first.text =
        "What hosts send down its serial line is not in the run, as on a line of a "
        "forwarder that others write to: " +
        number(gathered.count) +
        (gathered.count == 1 ? " thing that depends" : " things that depend") +
        " on it cannot be judged.";
    gathered.first.expected = "A capture of both directions of the line.";
    findings.add(std::move(gathered.first));
  }
  silent_.clear();
  unseen_.clear();
}

std::uint16_t Context::slowest_mote(std::uint16_t am) const {
  std::uint16_t out = kNobody;
  for_motes(am, [&](std::uint16_t mote) {
    if (out == kNobody || join_call_us(mote) > join_call_us(out)) out = mote;
  });
  return out;
}

const std::vector<BusyTime>& Context::busy_times(std::uint16_t node) const {
  static const std::vector<BusyTime> kNone;
  return node < run.nodes.size() ? run.nodes[node].busy : kNone;  // A log's are the first devices.
}

std::int64_t Context::due_us(std::uint16_t node, std::int64_t whole_us,
                             std::optional<machine::Link> line) const {
  // While a line is free for so long one at least of what waits is served, and a buffer holds few.
  std::size_t served = 0;
  std::int64_t free_us = whole_us;
  std::int64_t due = whole_us + response_us(node);
  for (const BusyTime& busy : busy_times(node)) {
    const bool other = line && busy.line && busy.line != line;
    if (other || busy.from_us > due || busy.to_us < whole_us) continue;
    if (busy.to_us == INT64_MAX) return INT64_MAX;
    if (busy.from_us - free_us >= response_us(node) && ++served > machine::kRadioRoom) break;
    free_us = std::max(free_us, busy.to_us);
    due = std::max(due, busy.to_us + 2 * response_us(node));
  }
  return due;
}

std::int64_t Context::handled_us(std::uint16_t node, std::int64_t whole_us,
                                 std::int64_t now_us) const {
  std::int64_t soon_us = whole_us + response_us(node);
  if (!device(node).whole) return std::max(soon_us, now_us);
  // What waits for the application is accepted for a line when that takes it, before it leaves now.
  for (const BusyTime& busy : busy_times(node)) {
    if (busy.line || busy.from_us > soon_us || busy.to_us < whole_us) continue;
    soon_us = std::max(soon_us, std::min(busy.to_us, now_us) + response_us(node));
  }
  return soon_us;
}

bool Context::busy(std::uint16_t node, std::int64_t from_us, std::int64_t to_us,
                   std::optional<machine::Link> line) const {
  return std::ranges::any_of(busy_times(node), [&](const BusyTime& busy) {
    const bool other = line && busy.line && busy.line != line;
    return !other && busy.from_us <= to_us && busy.to_us >= from_us;
  });
}

// Returns by how many this changes what a node has still to handle of what it was given, by a log
// that has all of it: messages that are handed over or sent on, and acked where that is owed, and
// join messages that are answered.
int Context::backlog_of(std::uint16_t node, std::size_t index) const {
  const Observation& seen = run.seen[index];
  const Mark& mark = who.marks[index];
  if (seen.kind == Observation::Kind::kNotice) {
    const bool handed = std::holds_alternative<machine::Received>(*seen.notice) ||
                        std::holds_alternative<machine::AckReceived>(*seen.notice);
    return mark.device == node && handed ? -1 : 0;
  }
  const bool frame = seen.kind == Observation::Kind::kRadio ||
                     seen.kind == Observation::Kind::kSerial ||
                     seen.kind == Observation::Kind::kPeis;
  if (!frame || (seen.received ? mark.receiver : mark.device) != node) return 0;
  Net net;
  const bool message = seen.frame.type == am::kNet && parse_net(seen.frame.payload, net);
  const bool base = device(node).role == machine::Role::kBaseStation;
  const std::uint16_t own = base ? machine::kNullDevid : device(node).am;
  if (seen.received) return message && net.reliable == 1 && net.dest.devid == own ? 2 : 1;
  return message && net.src.devid == own && !net.is_ack() ? 0 : -1;
}

std::int64_t Context::held_since_us(std::uint16_t node, std::int64_t time_us) const {
  std::int64_t since_us = time_us;
  for (const BusyTime& busy : busy_times(node)) {
    if (!busy.line && busy.to_us >= time_us) since_us = std::min(since_us, busy.from_us);
  }
  return since_us;
}

// Returns how many things at most a node had still to handle at once while a message that came at
// `time_us` was among them, beside that one.
int Context::backlog(std::uint16_t node, std::int64_t time_us) const {
  const std::int64_t since_us = held_since_us(node, time_us);
  const auto begin =
      std::ranges::lower_bound(run.seen, since_us - 2 * response_us(node), {},
                               [](const Observation& seen) { return seen.place.time_us; });
  int waiting = 0;
  int most = 0;
  for (auto it = begin; it != run.seen.end() && it->place.time_us < time_us + response_us(node);
       ++it) {
    const int change = backlog_of(node, static_cast<std::size_t>(it - run.seen.begin()));
    waiting = std::max(0, waiting + change);
    if (it->place.time_us >= time_us) most = std::max(most, waiting - 1);
  }
  return most;
}

bool Context::full(std::uint16_t node, std::int64_t time_us) const {
  constexpr machine::Link kNone = machine::Link::kPeis;  // Only the application counts.
  return busy(node, time_us, time_us, kNone) && crowded(node, time_us);
}

bool Context::passed_on(std::uint16_t node, std::vector<Observation>::const_iterator came,
                        std::int64_t until_us) const {
  Net net;
  if (!parse_net(came->frame.payload, net)) return false;
  for (auto it = came + 1; it != run.seen.end() && it->place.time_us < until_us; ++it) {
    const Mark& mark = who.marks[static_cast<std::size_t>(it - run.seen.begin())];
    if (mark.device != node || it->received || it->frame.type != am::kNet) continue;
    Net out;
    if (parse_net(it->frame.payload, out) && out.src == net.src && out.seq_num == net.seq_num) {
      return true;
    }
  }
  return false;
}

bool Context::crowded(std::uint16_t node, std::int64_t time_us) const {
  constexpr std::size_t kCrowd = 2;
  constexpr std::int64_t kAroundUs = 100'000;
  const Device& its = device(node);
  if (its.whole) {
    const bool mote = its.role == machine::Role::kMote;
    const machine::Link line = mote ? machine::Link::kRadio : machine::Link::kSerial;
    return backlog(node, time_us) >= static_cast<int>(room(node, line));
  }
  // A message that came at most the response time before may still be in a buffer.
  const auto from =
      std::ranges::upper_bound(run.seen, time_us - std::max(kAroundUs, response_us(node)), {},
                               [](const Observation& seen) { return seen.place.time_us; });
  std::size_t around = 0;
  for (auto it = from; it != run.seen.end() && it->place.time_us < time_us + kAroundUs; ++it) {
    const Mark& mark = who.marks[static_cast<std::size_t>(it - run.seen.begin())];
    const bool line = it->kind == Observation::Kind::kSerial && mark.device != kNobody;
    const bool air = it->kind == Observation::Kind::kRadio && !it->received && mark.device != node;
    if (it->frame.type != am::kNet) continue;
    if (its.hearing) {
      around += mark.receiver == node ? 1 : 0;
      continue;
    }
    const bool by_air =
        air && (it->frame.dest == its.am || it->frame.dest == machine::kAmBroadcast);
    const bool came = by_air || (line && device(mark.device).partner == node);
    if (came && !passed_on(node, it, time_us)) ++around;
  }
  return around > kCrowd;
}

void Context::left(std::uint16_t node, machine::Link line, const Place& at, std::int64_t from_us,
                   std::int64_t to_us, const std::string& what) {
  if (!device(node).hearing || !run.has_time) return;
  Accepted& last = left_[{node, line}];
  const bool late = at.time_us > due_us(node, to_us, line);  // That is said of it elsewhere.
  if (!late && to_us < last.from_us) {
    report("N2-ORDER"_rule, Severity::kFail, at, node,
           {"On its line " + what + " leaves after " + last.what + ", which was accepted later.",
            "The order in which they were accepted.",
            {}});
  }
  if (from_us > last.from_us) last = {from_us, what};
}

void Context::begin_life(std::uint16_t node) {
  for (const machine::Link line : {machine::Link::kRadio, machine::Link::kSerial}) {
    left_.erase({node, line});
  }
}

Severity Context::without(std::uint16_t cause, std::int64_t from_us, std::int64_t to_us,
                          std::uint16_t node) const {
  const bool ended = node != kNobody && to_us > captures_end_us(node);
  return ended || who.maybe_unseen(cause, from_us, to_us, options) ? Severity::kInconclusive
                                                                   : Severity::kFail;
}

Severity Context::without_copy(std::uint16_t sender, const Place& first,
                               std::int64_t now_us) const {
  const bool late = now_us > due_us(sender, first.time_us) + kLinkRepeatUs;
  Severity severity = without(sender, first.time_us, now_us);
  // The one that is taken for the first may be the copy.
  if (who.damaged(first.time_us - kLinkRepeatUs, first.time_us) || after_begin(first.time_us)) {
    severity = Severity::kInconclusive;
  }
  // A copy has the DSN of the first, so that none seems to be missing.
  const bool told = options.sniffer_complete || (sender != kNobody && device(sender).hearing);
  return (late || told) && !lossy_air ? severity : std::min(severity, Severity::kInconclusive);
}

Severity Context::without_mote(std::uint16_t am, std::int64_t from_us, std::int64_t to_us,
                               std::uint16_t node) const {
  const bool nobody = mote_of_am[am] == kNobody;
  Severity out = nobody ? without(kNobody, from_us, to_us, node) : Severity::kFail;
  for_motes(am,
            [&](std::uint16_t mote) { out = std::min(out, without(mote, from_us, to_us, node)); });
  return out;
}

Severity Context::without_ever(std::uint16_t cause, std::int64_t to_us) const {
  if (!options.start_cold) return Severity::kInconclusive;
  return without(cause, run.start_us - 1, to_us);  // Before its first frame one may have escaped.
}

void Context::report(ReqId requirement, Severity severity, const Place& at, std::uint16_t node,
                     Said said) {
  Finding finding;
  finding.requirement = requirement;
  finding.severity = severity;
  finding.place = at;
  finding.text = std::move(said.text);
  finding.expected = std::move(said.expected);
  // Hypotheses may differ in what their sentences do not say.
  std::vector<Hypothesis>& told = finding.hypotheses;
  for (Hypothesis& one : said.hypotheses) {
    if (std::find(told.begin(), told.end(), one) == told.end()) told.push_back(std::move(one));
  }
  finding.beyond = said.beyond;
  if (node != kNobody) {
    const Device& d = device(node);
    if (!d.judged) return;
    finding.node = d.name;
    finding.device = node;
    if (!d.known && severity > Severity::kNote) finding.severity = Severity::kStray;
  }
  const bool blames = finding.severity == Severity::kFail || finding.severity == Severity::kWeak;
  // What another node's log shows of it may have its cause, or its event, where its own has ended.
  const bool unseen = node < run.nodes.size() && at.timed() && !run.nodes[node].shown(at.time_us);
  if (blames && (unseen || rests_on_order(requirement, at, node))) {
    finding.severity = Severity::kInconclusive;
  }
  if (node != kNobody && gather(finding, node)) return;
  findings.add(std::move(finding));
}

void Context::report_stranger(const Observation& seen, std::uint16_t node) {
  report(ReqId::kNone, Severity::kStray, seen.place, node,
         {"A frame from AM address " + number(seen.frame.src) +
              " whose DSN follows none of that address's.",
          "Frames of nodes that the run shows.",
          {}});
}

std::string text_of(machine::Address address) {
  const auto part = [](std::uint16_t n, bool pid) -> std::string {
    if (n == 0xFFFF) return "all";
    if (pid && n == machine::kLocalPid) return "local";
    if (!pid && n == machine::kNullDevid) return "null";
    return std::to_string(n);
  };
  return "<" + part(address.pid, true) + ", " + part(address.devid, false) + ">";
}

std::string name_of(const Net& net) {
  return "the message " + text_of(net.src) + " to " + text_of(net.dest) + " with number " +
         number(net.seq_num);
}

std::string ms_text(std::int64_t us) {
  char text[40];
  std::snprintf(text, sizeof text, "%.2f ms", static_cast<double>(us) / 1000);
  return text;
}

std::string number(std::uint64_t n) { return std::to_string(n); }

}  // namespace rubric::check
