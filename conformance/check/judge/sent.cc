#include "conformance/check/judge/sent.h"

#include "conformance/machine/route.h"

namespace rubric::check {
namespace {

using machine::Link;
using machine::Role;
using machine::Route;

constexpr std::int64_t kAtOnceUs = 50'000;
constexpr std::int64_t kCallUs = 50'000;  // What send accepted is in its buffer then.

// Returns the number that by the log a call of send returns; nothing if that is not plain.
std::optional<std::uint16_t> returned(const Run& run, const Observation& call) {
  const auto from = run.seen.begin() + (&call - run.seen.data()) + 1;
  const auto next = std::find_if(from, run.seen.end(), [&](const Observation& seen) {
    if (seen.node != call.node) return false;
    if (seen.call != nullptr) return std::holds_alternative<machine::Send>(*seen.call);
    return seen.notice != nullptr && std::holds_alternative<machine::SendResult>(*seen.notice);
  });
  if (next == run.seen.end() || next->notice == nullptr) return std::nullopt;
  return std::get<machine::SendResult>(*next->notice).seq_num;
}

// How a message fits a call of send.
struct AskedFor {
  bool elsewhere = false;  // Its destination is that devid in another island.
  bool goes = false;       // Its destination and its reliable are those of the call,
  bool says = false;       // and its TRANSID, APPID and data.
};

// `more`: bytes may follow the data.
AskedFor asked_for(const machine::Send& call, const Net& net, bool more) {
  const bool at_home = call.dest.pid == machine::kLocalPid;
  const machine::Address dest{at_home ? net.src.pid : call.dest.pid, call.dest.devid};
  const bool reliable = call.reliable == (net.reliable == 1);
  const Bytes body = net.body();
  const Bytes data = more ? body.first(std::min(call.data.size(), body.size())) : body;
  return {
      at_home && reliable && dest.pid != net.dest.pid && dest.devid == net.dest.devid,
      reliable && dest == net.dest,
      net.trans_id == component::kConnless && call.app_id == net.app_id && equal(call.data, data)};
}

}  // namespace

Originals::Originals(Context& context, std::size_t devices)
    : context_(context),
      sent_(devices),
      orders_(devices, 0),
      stale_(devices),
      acks_(devices),
      calls_(devices),
      forgot_(devices),
      strays_us_(devices, -1),
      begun_(devices),
      moved_(devices) {}

void Originals::begin_life(std::uint16_t node) {
  sent_[node].clear();
  acks_[node].clear();
  calls_[node].clear();
  forgot_[node] = false;
  begun_[node] = true;
}

void Originals::called(std::uint16_t node, const Observation& seen, const machine::Send& call,
                       machine::Address own) {
  const Device& device = context_.device(node);
  const bool here = call.dest.pid == machine::kLocalPid || call.dest.pid == own.pid;
  // What goes to every island, or to the node itself, may stay (decisions 114, 131).
  const bool self = own.pid != kNoIsland && here &&
                    (call.dest.devid == own.devid || call.dest.devid == machine::kLocalDevid);
  const bool free = own.pid == kNoIsland || call.dest.pid == machine::kBroadcastPid || self;
  const bool base = device.role == Role::kBaseStation;
  const std::uint16_t sink = base ? device.partner : node;
  const bool line = device.whole || (sink != kNobody && context_.device(sink).shows_line());
  bool shown = device.role == Role::kMote || line;
  if (base && !here) shown = context_.logs_peis(node);
  const Link down = base ? Link::kSerial : Link::kRadio;  // To its motes.
  const Link up = base ? Link::kPeis : device.role == Role::kSink ? Link::kSerial : Link::kRadio;
  const bool to_mote = here && call.dest.devid != machine::kNullDevid;
  const bool may_stay = free || !shown || moved_[node];
  const auto may_leave = [&](const Call& before) {
    const bool may_stay_for_ever = before.free || before.held;
    const bool late = seen.place.time_us - before.place.time_us > Context::kHeldLongUs;
    return !before.left && before.result != machine::kNoSeq && !(may_stay_for_ever && late);
  };
  calls_[node].make_room(may_leave, [&](const Call& before) {
    if (may_leave(before)) forgot_[node] = true;
  });
  Call& one = calls_[node].push(
      {&call, {}, {}, seen.place, may_stay, to_mote ? down : up, may_stay, seen.place.time_us});
  one.self = self;
  one.returns = returned(context_.run, seen);
}

void Originals::used(std::uint16_t node, std::uint16_t number) {
  auto& calls = calls_[node];
  for (std::size_t i = 0; i < calls.size(); ++i) {
    Call& one = calls.newest(i);
    if (one.result == number || !one.result) one.free = true;
    if (one.result == number) return;
  }
}

void Originals::switched(std::uint16_t node, const machine::SetInterface& set,
                         std::int64_t now_us) {
  // By a whole log what send accepted waits until the interface is on again.
  const bool whole = context_.device(node).whole;
  for (std::size_t i = 0; i < calls_[node].size(); ++i) {
    Call& one = calls_[node].newest(i);
    if (!whole) {
      one.free = one.free || !set.on;
    } else if (one.line == set.link && !set.on) {
      if (!waits(node, one.since_us, now_us)) judge_missing(node, one, now_us);
      one.held = true;
    } else if (one.line == set.link && one.held && !one.free) {
      one.held = false;
      one.since_us = now_us;
    }
  }
}

void Originals::asks_to_join(std::uint16_t node) {
  if (context_.device(node).application) return;  // Its log tells reboots.
  for (std::size_t i = 0; i < sent_[node].size(); ++i) sent_[node].newest(i).wait = Wait::kOver;
}

void Originals::ends(std::uint16_t node, std::int64_t end_us, const InterfaceWatch& interfaces) {
  judge_unsent(node, end_us, interfaces);
  for (std::size_t i = sent_[node].size(); i-- > 0;) close(node, i, end_us);
}

// Only a log that has all that the node sends shows that a message never left.
void Originals::judge_unsent(std::uint16_t node, std::int64_t end_us,
                             const InterfaceWatch& interfaces) {
  const Device& device = context_.device(node);
  const bool air = context_.options.sniffer_complete && context_.who.sees_air;
  if (!(device.hearing || air) || !context_.run.has_time) return;
  auto& calls = calls_[node];
  for (std::size_t i = 0; i < calls.size(); ++i) {
    Call& one = calls.oldest(i);
    if (!device.hearing && one.line != Link::kRadio) continue;
    if (!one.result && device.whole && end_us > context_.due_us(node, one.place.time_us)) {
      context_.report("N1-SEQ"_rule, Severity::kFail, one.place, node,
                      {"The call of send to " + text_of(one.send->dest) + " got no result.",
                       "The number of the message, or 0xFFFF.",
                       {}});
    }
    const std::int64_t on_us = interfaces.on_since(node, one.line);
    if (on_us < 0 || interfaces.awaits(node) == one.result) continue;  // N10-ON says the latter.
    one.since_us = std::max(one.since_us, on_us);
    judge_missing(node, one, end_us);
  }
}

// Says that a message which may leave since a while never did.
void Originals::judge_missing(std::uint16_t node, Call& call, std::int64_t now_us) {
  if (call.free || call.held || call.left || !call.result || call.result == machine::kNoSeq) return;
  const std::int64_t due_us = context_.due_us(node, call.since_us, call.line);
  if (now_us <= due_us) return;
  const bool base = context_.device(node).role == Role::kBaseStation;
  const std::int64_t called_us = call.place.time_us;
  const bool waited = !base && context_.busy(node, called_us, called_us, call.line);
  ReqId rule = waited ? "N2-QUEUE"_rule : "N2-ONCE"_rule;
  if (base) rule = call.line == Link::kSerial ? "N8-SERIAL"_rule : "N8-PEIS"_rule;
  // Captures that end before its log do not show what was due later.
  const bool ended = due_us > context_.captures_end_us(node);
  context_.report(rule, ended ? Severity::kInconclusive : Severity::kFail, call.place, node,
                  {"send accepted the message to " + text_of(call.send->dest) + " with number " +
                       number(*call.result) + (waited ? " while the line was busy" : "") +
                       ", and it never left.",
                   waited ? "That message, when the line is free." : "That message, once.",
                   {}});
  call.free = true;
}

// Judges whether a message overtook one that send accepted before it, for the same line; that one
// may never leave.
void Originals::judge_order(std::uint16_t node, const Observation& seen, const Call& later) {
  const Device& device = context_.device(node);
  if (device.role == Role::kBaseStation || !device.hearing) return;
  auto& calls = calls_[node];
  for (std::size_t i = 0; i < calls.size(); ++i) {
    const Call& one = calls.newest(i);
    if (&one == &later || one.place.frame >= later.place.frame || one.line != later.line) continue;
    if (one.free || one.left || !one.result || one.result == machine::kNoSeq) continue;
    context_.report("N2-ORDER"_rule, Severity::kFail, seen.place, node,
                    {"The message to " + text_of(later.send->dest) + " leaves before the one to " +
                         text_of(one.send->dest) + " with number " + number(*one.result) +
                         ", which send accepted earlier for the same line.",
                     "The order of the calls.",
                     {}});
    return;
  }
}

// Returns whether what was accepted then may still wait behind other messages.
bool Originals::waits(std::uint16_t node, std::int64_t since_us, std::int64_t now_us) {
  const auto& sent = sent_[node];
  return context_.crowded(node, since_us) ||
         (sent.size() > 0 && now_us - sent.newest(0).place.time_us <= context_.response_us(node));
}

// Says that by a whole log a message left later than an answer may, with nothing else to wait for.
void Originals::judge_late(std::uint16_t node, const Observation& seen, const Call& call,
                           Link link) {
  const std::int64_t called_us = call.since_us;
  if (!context_.device(node).whole || call.held || call.result != call.left) return;
  if (seen.place.time_us <= context_.due_us(node, called_us, link)) return;
  const bool may_wait = waits(node, called_us, seen.place.time_us);
  context_.report(
      "N2-ONCE"_rule, may_wait ? Severity::kInconclusive : Severity::kFail, seen.place, node,
      {"The message that send accepted leaves " + ms_text(seen.place.time_us - called_us) +
           " after " + (called_us == call.place.time_us ? "the call." : "its interface is on."),
       "Within " + ms_text(context_.response_us(node)) + ".",
       {}});
}

bool Originals::accepted(std::uint16_t node, std::uint16_t number) const {
  const Ring<Call, kRoom>& calls = calls_[node];
  for (std::size_t i = 0; i < calls.size(); ++i) {
    if (calls.newest(i).result == number) return !calls.newest(i).left;
  }
  return false;
}

bool Originals::asked(std::uint16_t node, const Net& net) const {
  const Ring<Call, kRoom>& calls = calls_[node];
  for (std::size_t i = 0; i < calls.size(); ++i) {
    const Call& one = calls.newest(i);
    const std::size_t size = std::min(one.send->data.size(), net.body().size());
    const bool same = one.send->app_id == net.app_id && one.send->dest.devid == net.dest.devid &&
                      equal(one.send->data, net.body().first(size));  // Old bytes may follow.
    if (same && !one.left) return true;
  }
  return false;
}

// Judges what a message wraps by the calls of its application, which a log shows.
Originals::Asked Originals::judge_wrap(std::uint16_t node, const Observation& seen, const Net& net,
                                       Link link) {
  if (!net.sound || net.is_ack() || net.trans_id == component::kSynChannel) return Asked::kUnknown;
  // Up its line a sink may send old bytes behind the data, and count them, as release 1.0 does.
  const bool more = link == Link::kSerial && context_.device(node).role == Role::kSink;
  auto& calls = calls_[node];
  bool asked = false;
  ReqId rule = "N2-ONCE"_rule;  // If no call asked for it.
  Call* numbered = nullptr;     // The call that returns its number.
  Call* same = nullptr;         // The last that says so, of another number or of this.
  for (std::size_t i = 0; i < calls.size(); ++i) {
    Call& one = calls.newest(i);
    const machine::Send& call = *one.send;
    const AskedFor fit = asked_for(call, net, more);
    if (fit.elsewhere) rule = "N3-LOCAL"_rule;
    if (one.returns == net.seq_num && !one.left) numbered = &one;
    if (!fit.goes) continue;
    asked = true;
    // What is cut is said by N1-SIZE.
    const bool cut = call.data.size() > machine::kAppDataMax && same == nullptr &&
                     (!one.result || *one.result == net.seq_num);
    if (cut && net.body().size() <= call.data.size() && call.app_id == net.app_id) {
      same = &one;
      break;
    }
    if (!fit.says) continue;
    const bool its = one.result == net.seq_num;
    const bool waits = same != nullptr && !same->result && !same->left;  // For its first message.
    if (its && one.left && waits) break;
    if (!one.result || its || same == nullptr) same = &one;
    if (its) break;
  }
  if (same != nullptr) {
    // A link may repeat a frame, but not with another number.
    const bool left = same->left && same->left == same->result;
    if (left && (context_.device(node).whole || same->left != net.seq_num) && !forgot_[node]) {
      context_.report(
          net.reliable == 1 ? "T3-RESEND"_rule : "N2-ONCE"_rule, Severity::kFail, seen.place, node,
          {name_of(net) + " is sent again, " + ms_text(seen.place.time_us - same->left_us) +
               " after the first time, and no call of its application asked for that.",
           "Each message once; resending is the application's decision.",
           {}});
      return Asked::kNo;
    }
    const bool again = same->left.has_value();
    same->left_us = seen.place.time_us;
    same->left = net.seq_num;
    // What is for every island may take either line (decision 114).
    if (net.dest.pid == machine::kBroadcastPid) same->line = link;
    judge_late(node, seen, *same, link);
    const std::int64_t called_us = same->place.time_us;
    const bool during = !same->result;  // It leaves before the call returns.
    if (during || same->result == net.seq_num) judge_order(node, seen, *same);
    if (same->result == net.seq_num) {
      context_.left(node, link, seen.place, called_us, same->told_us + kCallUs, name_of(net));
    }
    if (same->result && !forgot_[node]) judge_result(node, seen, *same);
    return again ? Asked::kUnknown : Asked::kYes;
  }
  // By a capture a message may come before its call, by less than two clocks may differ.
  const auto its_call = [&](const Observation& other) {
    return other.node == context_.run.nodes[node].name && other.call != nullptr &&
           std::holds_alternative<machine::Send>(*other.call) &&
           returned(context_.run, other) == net.seq_num;
  };
  const bool beside_log = seen.node.empty() && context_.device(node).application;
  const Observation* const later =
      numbered == nullptr && beside_log ? context_.soon(seen.place.time_us, its_call) : nullptr;
  const machine::Send* const wanted = numbered != nullptr ? numbered->send
                                      : later != nullptr  ? &std::get<machine::Send>(*later->call)
                                                          : nullptr;
  const AskedFor fit = wanted != nullptr ? asked_for(*wanted, net, more) : AskedFor{};
  if (fit.goes && fit.says) return Asked::kUnknown;
  const bool none = calls.size() == 0 && wanted == nullptr && !context_.device(node).whole;
  if (none || forgot_[node]) return Asked::kUnknown;
  // A message from before the log may have waited. Nobody knows what a log leaves out unless it is
  // whole or has what the node was given (decision 13).
  const bool whole = context_.device(node).hearing && (context_.options.start_cold || begun_[node]);
  const Severity severity = whole || wanted != nullptr ? Severity::kFail : Severity::kInconclusive;
  if (numbered != nullptr) {
    numbered->left = net.seq_num;
    numbered->left_us = seen.place.time_us;
  }
  if (wanted != nullptr ? !fit.goes : !asked) {
    const std::string call = wanted == nullptr ? ""
                                               : " The call that returns this number is to " +
                                                     text_of(wanted->dest) + ", reliable " +
                                                     number(wanted->reliable ? 1 : 0) + ".";
    context_.report(rule, severity, seen.place, node,
                    {"No call of its application asked for " + name_of(net) + ", reliable " +
                         number(net.reliable) + "." + call,
                     "What send was given, unchanged.",
                     {}});
    return Asked::kUnknown;
  }
  context_.report("T1-WRAP"_rule, severity, seen.place, node,
                  {"TRANSID " + number(net.trans_id) + ", APPID " + number(net.app_id) + " and " +
                       number(net.body().size()) + " bytes of data in " + name_of(net) +
                       ": no call of its application says so.",
                   "TRANSID CONNLESS, and the APPID and the data of the call of send.",
                   {}});
  return Asked::kUnknown;
}

void Originals::sent(std::uint16_t node, const Observation& seen, const Net& net, Link link,
                     machine::Address own) {
  ++orders_[node];
  judge_content(node, seen, net);
  const Asked asked = judge_wrap(node, seen, net, link);
  judge_address(node, seen, net, link, own);
  Sent* const same = latest(node, net.seq_num);
  if (same != nullptr) {
    judge_number(node, seen, net, asked, *same);
  } else {
    context_.findings.kept("N12-REUSE"_rule);
  }
  Sent sent;
  sent.net = net;
  sent.place = seen.place;
  sent.order = orders_[node];
  sent.called_us = seen.place.time_us;
  sent.reused = same != nullptr && same->reused;
  if (asked == Asked::kNo) sent.told = take_events(node, net.seq_num);
  for (std::size_t i = 0; i < calls_[node].size(); ++i) {
    const Call& call = calls_[node].newest(i);
    if (call.left != net.seq_num) continue;
    sent.called_us = call.place.time_us;
    if (call.failed) sent.told = 1;
    break;
  }
  Ring<Sent, kRoom>& ring = sent_[node];
  ring.make_room([&](const Sent& before) { return awaits(node, before, seen.place.time_us); },
                 [&](const Sent&) { close(node, ring.size() - 1, seen.place.time_us); });
  ring.push(sent, net.seq_num);
}

void Originals::judge_content(std::uint16_t node, const Observation& seen, const Net& net) {
  if (!net.sound) return report_nbytes(context_, node, seen.place, net);
  const std::size_t came = seen.frame.payload.size() - kNetHeaderBytes;
  if (seen.kind == Observation::Kind::kRadio && came > net.nbytes) {
    stale_[node].add(seen.place, net.nbytes, came);
  }
  if (!NetAt::ReliableAt::allows(net.reliable)) {
    context_.report("WIRE-NET-RELIABLE"_rule, Severity::kFail, seen.place, node,
                    {"reliable is " + number(net.reliable) + ".", "0 or 1.", {}});
  }
  if (net.dest.pid == machine::kLocalPid) {
    context_.report("N3-LOCAL"_rule, Severity::kFail, seen.place, node,
                    {"A message to " + text_of(net.dest) + " leaves the node.",
                     "The own island's id in place of the local island.",
                     {}});
  }
  if (net.seq_num == machine::kNoSeq) {
    context_.report(
        "N12-ERROR"_rule, Severity::kWeak, seen.place, node,
        {"A message has the number 0xFFFF, the error value of send.", "Another number.", {}});
  }
  if (!known_trans(net.trans_id)) {
    context_.report("T1-WRAP"_rule, Severity::kNote, seen.place, node,
                    {"A message has the unknown TRANSID " + number(net.trans_id) + ".",
                     "CONNLESS, SYN_CHANNEL or RUBICON_ACK.",
                     {}});
  } else {
    context_.findings.kept("T1-WRAP"_rule);
  }
}

//= N4-MOTE: On the radio a net_msg for a mote of the sender's own island is sent to that mote's AM
//= address, a broadcast to AM address 0xFFFF.
//= N4-SINK: A mote sends a net_msg for another island, or with devid NULL, to the AM address of its
//= sink.
void Originals::judge_address(std::uint16_t node, const Observation& seen, const Net& net,
                              Link link, machine::Address own) {
  const Device& device = context_.device(node);
  // A message to the broadcast island may go anywhere (decision 114).
  if (net.dest.pid == machine::kBroadcastPid || net.dest.pid == machine::kLocalPid) return;
  const Route route = machine::route_own({device.role, own, true, context_.sink_am}, net.dest);
  if (route.requirement == "N4-SELF"_rule && net.trans_id != component::kSynChannel) {
    context_.report(route.requirement, Severity::kWeak, seen.place, node,
                    {"It sends " + name_of(net) + ", to itself.", "send refuses it.", {}});
    return;
  }
  const bool up = route.onward == Route::Onward::kSerial;
  if (device.role == Role::kSink && link == Link::kRadio && up) {
    // Its base station may have handed it down (decision 126).
    const std::int64_t since_us = seen.place.time_us - context_.response_us(node);
    const bool comes = context_.comes(node, seen, net.src, net.seq_num);
    const Severity most = comes ? Severity::kInconclusive : Severity::kFail;
    context_.report("N6-OWN"_rule, context_.unless_given(node, since_us, most), seen.place, node,
                    {"The sink sends " + name_of(net) + " by radio.", "Over serial.", {}});
    return;
  }
  // Of a host in a capture it is weak (N8-LOOP): who writes there may not be the base station.
  if (device.whole && link == Link::kSerial && route.onward == Route::Onward::kPeis) {
    context_.report("N8-PEIS"_rule, Severity::kFail, seen.place, node,
                    {"The base station sends " + name_of(net) + " down its serial line.",
                     "Through PEIS to island " + number(net.dest.pid) + ".",
                     {}});
    return;
  }
  if (device.role == Role::kSink && link == Link::kSerial &&
      route.onward == Route::Onward::kRadio) {
    context_.report(route.requirement, context_.on_line(node, Severity::kFail), seen.place, node,
                    {"The sink sends " + name_of(net) + " up its serial line.",
                     "By radio to AM address " + number(route.am_dest) + ".",
                     {}});
    return;
  }
  if (link != Link::kRadio || route.onward != Route::Onward::kRadio) return;
  if (seen.frame.dest == route.am_dest) {
    context_.findings.kept(route.requirement);
    return;
  }
  context_.report(
      route.requirement, Severity::kFail, seen.place, node,
      {"A message to " + text_of(net.dest) + " goes to AM address " + number(seen.frame.dest) + ".",
       "AM address " + number(route.am_dest) + ".",
       {}});
}

// Returns the last message with that number; null: none is known.
Sent* Originals::latest(std::uint16_t node, std::uint16_t number) {
  Ring<Sent, kRoom>& ring = sent_[node];
  for (std::size_t i = ring.newer_than(number); i < ring.size(); ++i) {
    if (ring.newest(i).net.seq_num == number) return &ring.newest(i);
  }
  return nullptr;
}

// Returns how many events the last message with that number had, for a copy that takes its place;
// if there is none, as if it had its event, as nobody asked for it.
std::uint8_t Originals::take_events(std::uint16_t node, std::uint16_t number) {
  Sent* const sent = latest(node, number);
  if (sent == nullptr) return 1;
  return std::exchange(sent->told, std::max<std::uint8_t>(sent->told, 1));
}

void Originals::judge_number(std::uint16_t node, const Observation& seen, const Net& net,
                             Asked asked, Sent& before) {
  const std::int64_t now = seen.place.time_us;
  const bool awaits =
      before.net.reliable == 1 && before.wait != Wait::kOver && before.net.sound &&
      before.net.trans_id == component::kConnless && seen.place.timed() && before.place.timed() &&
      now - before.place.time_us < context_.ack_timeout_us(node) - context_.early_us(node);
  const bool same =
      asked != Asked::kYes && same_message(before.net, net) && same_payload(before.net, net);
  // A sink's host may have handed it down again.
  const std::int64_t since_us = before.place.time_us;
  if (awaits) {
    before.reused |= !same;
    // An ack that was not captured would have ended the wait.
    const machine::Address dest = before.net.dest;
    const bool by_sink = dest.devid == context_.sink_am || dest.devid == machine::kNullDevid;
    const std::uint16_t acker =
        by_sink || before.acked ? context_.only_sink : context_.mote_of_am[dest.devid];
    const Severity severity = before.wait == Wait::kPerhaps
                                  ? Severity::kInconclusive
                                  : context_.without(acker, before.place.time_us, now);
    context_.report(
        same ? "T3-RESEND"_rule : "N12-REUSE"_rule,
        same ? context_.unless_given(node, since_us, severity) : context_.on_line(node, severity),
        seen.place, node,
        {(same ? "The reliable message with number " : "Number ") + number(net.seq_num) +
             (same ? " is sent" : " is used") + " again, " + ms_text(now - before.place.time_us) +
             " after the message with this number that awaits its ack.",
         same ? "Resending is the application's decision, with a number of its own."
              : "A number that no message awaits.",
         {}});
    return;
  }
  // Twice in a row, at once: a number that came again by chance would not do that.
  const bool at_once = same && before.order + 1 == orders_[node] && seen.place.timed() &&
                       before.place.timed() && now - before.place.time_us < kAtOnceUs;
  if (at_once) {
    context_.report("N2-ONCE"_rule, context_.unless_given(node, since_us), seen.place, node,
                    {"The same message, number " + number(net.seq_num) + ", is sent twice, " +
                         ms_text(now - before.place.time_us) + " apart.",
                     "Once.",
                     {}});
  }
}

void Originals::finish(const InterfaceWatch& interfaces) {
  for (std::uint16_t node = 0; node < sent_.size(); ++node) {
    ends(node, context_.end_us(node), interfaces);
    note_stale(context_, node, "WIRE-NET-PAYLOAD"_rule, stale_[node], "On the air a message has ");
  }
}

}  // namespace rubric::check
