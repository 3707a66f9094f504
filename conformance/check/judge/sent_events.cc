// Judges what the application of a sender is told: send_result, and receive_ack of an ack or of its
// timeout.
#include <algorithm>

#include "conformance/check/judge/sent.h"
#include "conformance/machine/transport.h"

namespace rubric::check {

using machine::Link;
using machine::Role;

void Originals::ack_heard(std::uint16_t node, const Net& ack, std::uint16_t acked, Wait wait) {
  Ring<Sent, kRoom>& ring = sent_[node];
  for (std::size_t i = 0; i < ring.size(); ++i) {
    Sent& sent = ring.newest(i);
    if (sent.net.seq_num != acked || sent.net.reliable != 1) continue;
    sent.acked = true;
    sent.wait = std::max(sent.wait, wait);
  }
  if (context_.device(node).application) acks_[node].push({ack, acked});
}

void Originals::ack_given(std::uint16_t node, const Net& ack, std::int64_t now_us) {
  const std::int32_t acked = machine::acked_seq_num(ack.body());
  Ring<Sent, kRoom>& ring = sent_[node];
  bool awaited = false;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    Sent& sent = ring.newest(i);
    const bool matches = sent.net.seq_num == acked && sent.net.reliable == 1 &&
                         sent.net.src == ack.dest && sent.net.dest == ack.src &&
                         sent.net.app_id == ack.app_id;
    if (matches && sent.given_us < 0) sent.given_us = now_us;
    if (sent.net.seq_num == acked) sent.ack_came = true;
    if (sent.net.seq_num == acked && sent.told == 0) awaited = true;
  }
  if (!awaited) strays_us_[node] = now_us;
}

// Returns whether an ack of that number was heard which fits.
template <typename Fits>
bool Originals::heard_ack(std::uint16_t node, std::uint16_t number, Fits fits) const {
  const Ring<Ack, kRoom>& ring = acks_[node];
  for (std::size_t i = 0; i < ring.size(); ++i) {
    if (ring.newest(i).number == number && fits(ring.newest(i).net)) return true;
  }
  return false;
}

// Returns whether an ack that fits the message in everything was heard, or none of any.
bool Originals::rightly_acked(std::uint16_t node, const Net& message) const {
  const auto fits = [&](const Net& ack) {
    return ack.src == message.dest && ack.app_id == message.app_id;
  };
  return acks_[node].size() == 0 || heard_ack(node, message.seq_num, fits);
}

// Returns whether an ack of the message has a code that is not success: its sender may call that a
// success or a failure (decision 108).
bool Originals::ill_acked(std::uint16_t node, const Net& message) const {
  return heard_ack(node, message.seq_num, [](const Net& ack) {
    const auto body = rubicon::RubiconAckView::parse(ack.body());
    return body && body->ack() != 0 && body->type() == rubicon::AmType::kLearningNotification;
  });
}

std::int64_t Originals::patience_us(std::uint16_t node) const {
  return kTimeouts * context_.ack_timeout_us(node) + context_.response_us(node);
}

// Returns whether its application may still be told of the message's end.
bool Originals::awaits(std::uint16_t node, const Sent& sent, std::int64_t now_us) const {
  return context_.device(node).application && sent.net.reliable == 1 && sent.told == 0 &&
         now_us - sent.place.time_us <= patience_us(node);
}

void Originals::told(std::uint16_t node, const Observation& seen, const machine::AckReceived& ack) {
  const std::int64_t now = seen.place.time_us;
  Ring<Sent, kRoom>& ring = sent_[node];
  Sent* match = nullptr;
  for (std::size_t i = 0; i < ring.size() && (match == nullptr || match->told > 0); ++i) {
    Sent& sent = ring.newest(i);
    if (sent.net.seq_num != ack.seq_num || sent.net.reliable != 1) continue;
    if (match == nullptr || sent.told == 0) match = &sent;
  }
  const std::string what = "receive_ack(" + std::string(ack.success ? "success" : "failure") +
                           ", number " + number(ack.seq_num) + ")";
  for (std::size_t i = 0; match == nullptr && !ack.success && i < calls_[node].size(); ++i) {
    Call& call = calls_[node].newest(i);  // The timeout may run from the call (decision 110).
    if (call.result != ack.seq_num || call.left || call.failed || !call.send->reliable) continue;
    call.failed = true;
    return;
  }
  if (match == nullptr) {
    // Messages from a base station to other islands pass where no log and no tap is read, and of
    // many sent at once the first are forgotten here before their timeout.
    const Device& device = context_.device(node);
    const bool elsewhere = !context_.has_lines(node) ||
                           (device.role == Role::kBaseStation && !context_.logs_peis(node));
    const bool forgotten = ring.size() + 1 >= ring.kMost && awaits(node, ring.oldest(0), now);
    bool before = context_.begun_before(node, now, patience_us(node));
    const bool came = heard_ack(node, ack.seq_num, [](const Net&) { return true; });
    bool line = false;
    for (std::size_t i = 0; i < calls_[node].size(); ++i) {  // It may have left unseen.
      const Call& call = calls_[node].newest(i);
      if (call.result != ack.seq_num || !call.send->reliable) continue;
      // A message that is acked must have left.
      before = before || came || context_.before_captures(node, call.place.time_us);
      line = line || call.line != Link::kRadio;
    }
    const Severity severity = context_.without(node, std::min(device.first_us, now), now, node);
    context_.report(came || !ack.success ? "T3-MATCH"_rule : "T3-SUCCESS"_rule,
                    elsewhere || forgotten || before ? Severity::kInconclusive
                    : line                           ? context_.on_line(node, severity)
                                                     : severity,
                    seen.place, node,
                    {what + " although the node has sent no reliable message with that number.",
                     "The number of the message that was acked.",
                     {}});
    return;
  }
  if (match->reused) return;
  if (match->told++ > 0) {
    context_.report("T3-ONCE"_rule, Severity::kFail, seen.place, node,
                    {what + " again.", "One receive_ack for each message.", {}});
    return;
  }
  if (match->net.sound && ack.app_id != match->net.app_id) {
    context_.report("T3-SUCCESS"_rule, Severity::kFail, seen.place, node,
                    {what + " for APPID " + number(ack.app_id) + "; the message had " +
                         number(match->net.app_id) + ".",
                     "receive_ack to the application that sent it.",
                     {}});
    return;
  }
  // An implementation may start its timer at either.
  const std::int64_t waited = now - match->called_us;
  const std::int64_t latest =
      context_.due_us(node, match->place.time_us + context_.ack_timeout_us(node));
  const bool overdue = match->given_us >= 0 && now > context_.due_us(node, match->given_us);
  // An ack on the air is none to a node whose whole log does not give it that.
  const bool acked = match->acked && (match->ack_came || !context_.device(node).whole);
  const bool too_late = seen.place.timed() && match->place.timed() && now > latest;
  if (!ack.success && !overdue && match->acked && ill_acked(node, match->net)) {
    context_.findings.kept("T3-SUCCESS"_rule);
  } else if (overdue) {
    context_.report("T3-SUCCESS"_rule, Severity::kFail, seen.place, node,
                    {what + ", " + ms_text(now - match->given_us) + " after its ack had come.",
                     "receive_ack(success) when the ack came.",
                     {}});
  } else if (ack.success && acked && !match->net.broadcast() &&
             !rightly_acked(node,
                            match->net)) {  // Of a broadcast any ack may count (decision 114).
    const std::uint16_t acker = context_.mote_of_am[match->net.dest.devid];
    const bool mote =
        context_.without(acker, match->place.time_us, now) == Severity::kFail && acker != kNobody;
    const bool sure = context_.device(node).hearing || mote || context_.options.sniffer_complete;
    context_.report("T3-SENDER"_rule, sure ? Severity::kWeak : Severity::kInconclusive, seen.place,
                    node,
                    {what + ", but every ack with that number came from another node than " +
                         text_of(match->net.dest) + " or for another APPID than " +
                         number(match->net.app_id) + ".",
                     "An ack counts from the message's destination, with its APPID.",
                     {}});
  } else if (ack.success && !acked) {
    const Device& device = context_.device(node);  // A mote hears by radio alone.
    const bool all = device.hearing && device.role == Role::kMote;
    const Severity severity = context_.without(kNobody, match->place.time_us, now, node);
    context_.report(strays_us_[node] >= match->place.time_us ? "T3-MATCH"_rule : "T3-SUCCESS"_rule,
                    all                        ? Severity::kFail
                    : context_.has_lines(node) ? context_.on_line(node, severity)
                                               : Severity::kInconclusive,
                    seen.place, node,
                    {what + ", but no ack of it was heard.", "No receive_ack before the ack.", {}});
  } else if (!ack.success && seen.place.timed() && match->place.timed() &&
             waited < context_.ack_timeout_us(node) - context_.early_us(node)) {
    // Only a stated timeout can be broken (decision 110).
    const bool stated = context_.ack_timeout_stated(node);
    context_.report("T3-TIMEOUT"_rule, stated ? Severity::kFail : Severity::kInconclusive,
                    seen.place, node,
                    {what + " " + ms_text(waited) + " after the message.",
                     "Not before the timeout, " + ms_text(context_.ack_timeout_us(node)) + ".",
                     {},
                     true});
  } else if (too_late) {
    context_.report(
        "T3-TIMEOUT"_rule,
        context_.ack_timeout_stated(node) ? Severity::kFail : Severity::kInconclusive, seen.place,
        node,
        {what + " " + ms_text(waited) + " after the message.",
         "receive_ack(failure) at the timeout, " + ms_text(context_.ack_timeout_us(node)) + ".",
         {}});
  } else {
    context_.findings.kept(ack.success ? "T3-SUCCESS"_rule : "T3-TIMEOUT"_rule);
  }
}

void Originals::close(std::uint16_t node, std::size_t newest, std::int64_t now_us) {
  Ring<Sent, kRoom>& ring = sent_[node];
  const Sent& sent = ring.newest(newest);
  if (!context_.device(node).application || !sent.place.timed() || sent.told > 0) return;
  if (sent.reused) return;
  const bool awaits =
      sent.net.reliable == 1 && sent.net.sound && sent.net.trans_id == component::kConnless;
  if (!awaits) return;
  for (std::size_t i = 0; i < newest; ++i) {  // Sent again by its application: one event for both.
    if (ring.newest(i).net.seq_num == sent.net.seq_num) return;
  }
  if (sent.given_us >= 0 && now_us > context_.due_us(node, sent.given_us)) {
    context_.report("T3-SUCCESS"_rule, Severity::kFail, sent.place, node,
                    {"The node was given the ack of " + name_of(sent.net) + " " +
                         ms_text(sent.given_us - sent.place.time_us) +
                         " after it, and its application is told nothing.",
                     "receive_ack(success).",
                     {}});
    return;
  }
  if (context_.profile(node).ack_timeout_ticks == 0) return;
  // An unstated timeout may be longer than what is assumed (decision 110); for ever it is not.
  const std::int64_t waited = now_us - sent.place.time_us;
  const std::int64_t timeouts = context_.device(node).whole ? 1 : kTimeouts;
  const std::int64_t timeout_us = timeouts * context_.ack_timeout_us(node);
  if (now_us <= context_.due_us(node, sent.place.time_us + timeout_us)) return;
  const std::int64_t forever_us = kForever * context_.ack_timeout_us(node);
  const bool stated = context_.ack_timeout_stated(node);
  // A log that ended before says nothing.
  const bool logged = context_.log_end_us(node) - sent.place.time_us >
                      (stated ? timeout_us + context_.response_us(node) : forever_us);
  const bool sure = logged && (stated || waited > forever_us);
  context_.report("T3-ONCE"_rule, sure ? Severity::kFail : Severity::kInconclusive, sent.place,
                  node,
                  {"No receive_ack for " + name_of(sent.net) + " in " + ms_text(waited) + ".",
                   "receive_ack(failure) at the timeout, or receive_ack(success) before.",
                   {}});
}

void Originals::told(std::uint16_t node, const Observation& seen,
                     const machine::SendResult& result) {
  auto& calls = calls_[node];
  if (calls.size() == 0) return;
  std::size_t which = 0;  // The oldest that still waits: results come in the order of the calls.
  for (std::size_t i = 0; i < calls.size(); ++i) {
    const Call& one = calls.newest(i);
    const bool waits = seen.place.time_us - one.place.time_us <= context_.response_us(node);
    if (!one.result && waits) which = i;
  }
  Call& call = calls.newest(which);
  if (call.result && context_.device(node).whole) {
    context_.report("N1-SEQ"_rule, Severity::kFail, seen.place, node,
                    {"send returns " + number(result.seq_num) + " after " + number(*call.result) +
                         " for one call, to " + text_of(call.send->dest) + ".",
                     "One result for each call.",
                     {}});
    return;
  }
  if (context_.device(node).whole &&
      seen.place.time_us > context_.due_us(node, call.place.time_us)) {
    context_.report("N1-SEQ"_rule, Severity::kFail, seen.place, node,
                    {"send returns " + number(result.seq_num) + " " +
                         ms_text(seen.place.time_us - call.place.time_us) + " after its call, to " +
                         text_of(call.send->dest) + ".",
                     "The number of the message, or 0xFFFF, at once.",
                     {}});
  }
  call.result = result.seq_num;
  call.told_us = seen.place.time_us;
  call.full = result.seq_num == machine::kNoSeq && full(node, call.line);
  if (result.seq_num == machine::kNoSeq) judge_refused(node, seen, call);
  if (call.send->data.size() > machine::kAppDataMax && result.seq_num != machine::kNoSeq) {
    context_.report("N1-SIZE"_rule, Severity::kFail, seen.place, node,
                    {"send returned " + number(result.seq_num) + " for a message of " +
                         number(call.send->data.size()) + " bytes.",
                     "0xFFFF.",
                     {}});
    call.free = true;  // All else about it has this cause.
  }
  if (call.self && !call.left && result.seq_num != machine::kNoSeq) {
    context_.report("N4-SELF"_rule, Severity::kWeak, seen.place, node,
                    {"send returned " + number(result.seq_num) + " for a message to " +
                         text_of(call.send->dest) + ", the node itself.",
                     "0xFFFF.",
                     {}});
  }
  if (call.left) judge_result(node, seen, call);
}

// Returns how many messages of its application a node accepted for a line and has not sent yet.
std::size_t Originals::waiting(std::uint16_t node, Link line) const {
  std::size_t count = 0;
  for (std::size_t i = 0; i < calls_[node].size(); ++i) {
    const Call& one = calls_[node].newest(i);
    const bool accepted = one.result && *one.result != machine::kNoSeq;
    if (accepted && !one.left && !one.free && one.line == line) ++count;
  }
  return count;
}

bool Originals::full(std::uint16_t node, Link line) const {
  return waiting(node, line) >= context_.room(node, line);
}

// Says that send refused a message although fewer of its application's messages waited than a
// buffer holds. Forwarded ones may have filled it, and awaited acks the room for acks, which nobody
// states.
void Originals::judge_refused(std::uint16_t node, const Observation& seen, const Call& call) {
  // These it must or may refuse (decision 114).
  const machine::Send& send = *call.send;
  const std::uint16_t devid = send.dest.devid;
  const bool nobody = machine::is_reserved(devid) && devid != machine::kNullDevid;
  const bool all = devid == machine::kBroadcastDevid;
  const bool refusable = send.data.size() > machine::kAppDataMax || (all ? send.reliable : nobody);
  if (!context_.device(node).whole || call.free || refusable) return;
  if (call.full) return;
  bool awaits = false;
  for (std::size_t i = 0; i < sent_[node].size(); ++i) {
    const Sent& sent = sent_[node].newest(i);
    awaits = awaits || (sent.net.reliable == 1 && !sent.acked && sent.told == 0);
  }
  const bool several = awaits && call.send->reliable;
  context_.report(several ? "T4-SEVERAL"_rule : "N1-ROOM"_rule, Severity::kInconclusive, seen.place,
                  node,
                  {"send refused the message to " + text_of(call.send->dest) + " with " +
                       number(waiting(node, call.line)) + " messages of the application waiting.",
                   several ? "It is accepted, unless there is no room for another awaited ack."
                           : "It is accepted, unless other messages fill the outgoing buffer.",
                   {}});
}

// Judges the number of a message that left and the one that send returned for it.
void Originals::judge_result(std::uint16_t node, const Observation& seen, const Call& call) {
  if (*call.left == *call.result) return context_.findings.kept("N1-SEQ"_rule);
  context_.report(
      call.full ? "N1-FULL"_rule : "N1-SEQ"_rule, Severity::kFail, seen.place, node,
      {"send returned " + number(*call.result) + " for the message to " + text_of(call.send->dest) +
           " with number " + number(*call.left) + ".",
       call.full ? "A message that send refused is never sent." : "The number of the message.",
       {}});
}

}  // namespace rubric::check
