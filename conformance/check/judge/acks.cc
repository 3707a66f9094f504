#include "conformance/check/judge/acks.h"

#include <algorithm>

#include "conformance/check/links.h"
#include "conformance/machine/transport.h"

namespace rubric::check {
namespace {

// Returns whether a message to the node is to be acked. If somebody sent it in the node's own name,
// the ack would go to the node itself, and is not owed (decision 131).
bool wants_ack(const Net& net) {
  return net.src != net.dest &&
         machine::must_ack(net.reliable == 1, net.dest, net.trans_id, net.app_id);
}

}  // namespace

Acks::Acks(Context& context, std::size_t devices)
    : context_(context),
      arrived_(devices),
      owed_(devices, 0),
      orders_(devices),
      apps_(devices),
      early_(devices) {}

void Acks::begin_life(std::uint16_t node, std::int64_t since_us) {
  Ring<Arrived, kRoom>& ring = arrived_[node];
  ring.keep_newest([&](const Arrived& one) { return one.place.time_us >= since_us; });
  for (std::size_t i = 0; i < ring.size(); ++i) ring.newest(i).sure = false;
  owed_[node] = 0;
  orders_[node] = {};
}

void Acks::arrived(std::uint16_t node, const Observation& seen, std::uint16_t sender,
                   const Net& net, const Arrival& arrival) {
  Ring<Arrived, kRoom>& ring = arrived_[node];
  Arrived arrived;
  arrived.net = net;
  arrived.place = seen.place;
  arrived.whole_us = seen.place.time_us + air_us(seen);
  arrived.sender = sender;
  arrived.link = seen.frame.link;
  arrived.forbidden = net.sound ? arrival.forbidden : "N11-NBYTES"_rule;
  arrived.weak = net.sound && arrival.weak;
  arrived.to_self = arrival.to_self;
  arrived.ackable = arrived.forbidden == ReqId::kNone && arrived.to_self && wants_ack(net);
  arrived.no_room = arrival.no_room;
  arrived.must_ack = arrived.ackable && net.for_known_app() && !arrival.free && !arrival.no_room;
  arrived.doubtful = arrival.doubtful;
  const bool known =
      net.sound && net.reliable <= 1 && net.trans_id == component::kConnless && net.for_known_app();
  const bool expected = !arrival.free || arrival.delivers == "N11-SHORT"_rule;
  if (known && expected && arrived.forbidden == ReqId::kNone) {
    arrived.delivers = arrival.delivers;
  }
  arrived.sure = arrival.sure;
  arrived.came = arrival.came;
  arrived.order = ++orders_[node].came;
  const std::int64_t now = seen.place.time_us;
  const Early& early = early_[node];
  const bool copy = arrived.link == machine::Link::kRadio && early.to == net.src &&
                    early.acked == net.seq_num && now - early.time_us <= kLinkRepeatUs;
  arrived.acks = copy ? 1 : 0;
  arrived.copies = copy ? 2 : 1;
  if (arrived.must_ack && arrived.sure && arrived.acks == 0) ++owed_[node];
  ring.make_room([&](const Arrived& one) { return waits(node, one, now); },
                 [&](Arrived& one) {
                   missing_delivery(node, one, now);
                   close(node, one);
                 });
  ring.push(arrived);
}

// Returns whether the message may still be delivered or acked. What a log has may wait for long.
bool Acks::waits(std::uint16_t node, const Arrived& arrived, std::int64_t now_us) {
  const Device& device = context_.device(node);
  const bool undelivered = device.application && arrived.delivers != ReqId::kNone;
  if (!(undelivered && arrived.delivered == 0) && !(arrived.ackable && arrived.acks == 0)) {
    return false;
  }
  const std::int64_t longer_us = device.hearing ? Context::kHeldLongUs : 0;
  return now_us <= context_.due_us(node, arrived.whole_us) + longer_us;
}

// Returns the last that came to the node with these addresses and this number.
Arrived* Acks::find(std::uint16_t node, const Net& net) {
  Ring<Arrived, kRoom>& ring = arrived_[node];
  for (std::size_t i = 0; i < ring.size(); ++i) {
    if (same_message(ring.newest(i).net, net)) return &ring.newest(i);
  }
  return nullptr;
}

void Acks::repeated(std::uint16_t node, const Net& net, std::int64_t now_us) {
  Arrived* const arrived = find(node, net);
  if (arrived == nullptr) return;
  if (arrived->copies < 255) ++arrived->copies;
  arrived->again_us = now_us;
}

bool Acks::came(std::uint16_t node, const Net& net) {
  Arrived* const arrived = find(node, net);
  if (arrived != nullptr) arrived->came = true;
  return arrived != nullptr;
}

// Returns whether by its log the node was not given the message, so that it cannot know it.
bool Acks::never_came(std::uint16_t node, const Arrived& arrived) const {
  const Device& device = context_.device(node);
  return !arrived.came &&
         (device.whole || (device.hearing && arrived.link == machine::Link::kRadio));
}

void Acks::surely(std::uint16_t node, const Net& net, std::int64_t now_us, bool may, bool no_room) {
  Arrived* const found = find(node, net);
  if (found == nullptr) return;
  Arrived& arrived = *found;
  if (no_room && !arrived.sure) {
    arrived.no_room = true;
    arrived.must_ack = false;
  }
  if (arrived.must_ack && !arrived.sure && arrived.acks == 0) ++owed_[node];
  if (!arrived.sure) arrived.order = ++orders_[node].came;  // Later ones may have come first.
  arrived.sure = true;
  arrived.whole_us = std::max(arrived.whole_us, now_us);
  arrived.net = net;  // As it was given, perhaps without the bytes after its content.
  if (may && (arrived.forbidden == "N10-OFF"_rule || arrived.forbidden == "J11-HEAR"_rule)) {
    arrived.forbidden = ReqId::kNone;
    arrived.ackable = arrived.to_self && wants_ack(net);
  }
}

void Acks::sent(std::uint16_t node, const Observation& seen, const Net& ack,
                std::int64_t timeout_us) {
  const std::int64_t now = seen.place.time_us;
  const std::int32_t acked = machine::acked_seq_num(ack.body());
  Ring<Arrived, kRoom>& ring = arrived_[node];
  // Picks the best message with that number: one that waits for its ack.
  Arrived* best = nullptr;
  const auto rank = [](const Arrived& a) {
    if (is_report(a.net)) return -1;
    if (a.forbidden != ReqId::kNone) return 0;
    const bool connless = a.net.trans_id == component::kConnless;
    if (a.net.reliable != 1 || !connless || a.net.broadcast()) return 1;
    return a.acks < a.copies ? 3 : 2;
  };
  for (std::size_t i = 0; i < ring.size(); ++i) {
    Arrived& arrived = ring.newest(i);
    if (arrived.net.seq_num != acked || arrived.net.src != ack.dest) continue;
    if (never_came(node, arrived)) continue;
    if (best == nullptr || rank(arrived) > rank(*best)) best = &arrived;
  }
  if (best == nullptr || rank(*best) < 3) {
    refuse(node, seen, ack, acked, best);
    return;
  }
  if (best->must_ack && best->sure && best->acks == 0) --owed_[node];
  ++best->acks;
  const std::int64_t took = now - std::max(best->whole_us, best->again_us);
  // What is acked did arrive, perhaps later. What surely came at once was acked late, which passes.
  if (best->must_ack && !best->sure && best->copies == 1 && took > context_.response_us(node)) {
    context_.report("T2-ACK"_rule, Severity::kInconclusive, seen.place, node,
                    {"The ack of " + name_of(best->net) + " comes after " + ms_text(took) + ".",
                     "Within " + ms_text(context_.response_us(node)) + ".",
                     {}});
  }
  if (best->net.app_id != ack.app_id || ack.reliable != 0) {
    context_.report("T2-CONTENT"_rule, Severity::kFail, seen.place, node,
                    {"The ack of " + name_of(best->net) + " has APPID " + number(ack.app_id) +
                         ", reliable " + number(ack.reliable) + ".",
                     "APPID " + number(best->net.app_id) + ", reliable 0.",
                     {}});
    return;
  }
  // What stopped it, a busy line or application or a radio that was off, is no fault of the node.
  if (took > timeout_us && best->must_ack && now > context_.due_us(node, best->whole_us)) {
    context_.report("T2-PROMPT"_rule, Severity::kWeak, seen.place, node,
                    {"The ack of " + name_of(best->net) + " comes after " + ms_text(took) + ".",
                     "Before the sender's timeout, " + ms_text(timeout_us) + ".",
                     {}});
  }
  if (best->sure && best->copies == 1) {
    context_.left(node, seen.frame.link, seen.place, best->whole_us,
                  context_.handled_us(node, best->whole_us, now),
                  "the ack of " + name_of(best->net));
    judge_ack_order(node, seen, *best);
  }
  apps_[node].acked.insert(ack.app_id);
  // An acked message did come, and must be delivered if the log tells of its application.
  const bool logged = apps_[node].delivered.contains(ack.app_id);
  best->sure = best->sure || (logged && !context_.device(node).hearing);
  for (const ReqId rule : {"T2-ACK"_rule, "T2-ONCE"_rule, "T2-CONTENT"_rule}) {
    context_.findings.kept(rule);
  }
}

// Judges whether an ack of what came later by the same line left before this one by a log.
void Acks::judge_ack_order(std::uint16_t node, const Observation& seen, const Arrived& acked) {
  const std::int64_t now = seen.place.time_us;
  if (!acked.must_ack || !context_.device(node).hearing) return;
  // Of what holds a node up only a busy application mixes what it handles; no node has this line.
  constexpr machine::Link kNone = machine::Link::kPeis;
  if (context_.busy(node, acked.whole_us, now, kNone)) return;
  if (context_.crowded(node, acked.place.time_us)) return;
  Ring<Arrived, kRoom>& ring = arrived_[node];
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Arrived& other = ring.newest(i);
    const bool same_way = other.link == acked.link && machine::is_reserved(other.net.src.devid) ==
                                                          machine::is_reserved(acked.net.src.devid);
    if (other.acks == 0 || other.order <= acked.order || !other.sure || !same_way) continue;
    if (other.copies > 1 || other.net.src.pid != acked.net.src.pid) continue;
    context_.report("N2-ORDER"_rule, Severity::kFail, seen.place, node,
                    {"The ack of " + name_of(acked.net) + " leaves after that of " +
                         name_of(other.net) + ", which came later by the same line.",
                     "The order in which they came.",
                     {}});
    return;
  }
}

// Takes an ack with a wrong number for the ack that a message waits for: one mistake, one finding.
void Acks::meant_ack(std::uint16_t node, const Net& ack) {
  Ring<Arrived, kRoom>& ring = arrived_[node];
  for (std::size_t i = 0; i < ring.size(); ++i) {
    Arrived& arrived = ring.oldest(i);
    if (!arrived.must_ack || arrived.acks > 0 || arrived.net.src != ack.dest) continue;
    if (arrived.net.app_id != ack.app_id) continue;
    if (arrived.sure) --owed_[node];
    ++arrived.acks;
    return;
  }
}

void Acks::refuse(std::uint16_t node, const Observation& seen, const Net& ack, std::int32_t acked,
                  Arrived* best) {
  const std::int64_t now = seen.place.time_us;
  Said said;
  ReqId rule = "T2-CONTENT"_rule;
  Severity severity = Severity::kFail;
  // What a mote of its island sends comes by radio.
  const bool of_mote = ack.dest.pid == ack.src.pid && !machine::is_reserved(ack.dest.devid);
  const auto its = static_cast<std::uint16_t>(acked);
  bool open = !of_mote && (!context_.has_lines(node) || context_.by_peis(node, ack.dest.pid));
  open = open || context_.comes(node, seen, ack.dest, its);
  const bool report = best != nullptr && is_report(best->net);
  const std::string acks = best == nullptr ? "" : "It acks " + name_of(best->net);
  if (acked < 0) {
    said.text = "An ack's body of " + number(ack.body().size()) + " bytes holds no number.";
    said.expected = "The acknowledged number, alone or in a learning_notification.";
  } else if (best == nullptr || report) {
    if (context_.half_heard(node) && !of_mote) return context_.needs_host(node, seen.place);
    severity = context_.on_line(node, context_.without_ever(kNobody, now));
    if (open) severity = Severity::kInconclusive;
    if (!report) meant_ack(node, ack);
    early_[node] = {ack.dest, its, now};
    said.text = "An ack to " + text_of(ack.dest) + " of number " + number(its) +
                ", which no message that came to this node had.";
    said.expected = "The number of a reliable message from " + text_of(ack.dest) + ".";
    if (report && severity == Severity::kFail && best->net.app_id == ack.app_id) {
      rule = "T2-UNRELIABLE"_rule;
      said.text = "It acks the serial_joined of " + text_of(ack.dest) + ".";
    }
  } else if (best->passes_on()) {
    said.text = acks + ", which is not for this node.";
    said.expected = "An ack by its destination.";
  } else if (best->forbidden != ReqId::kNone) {
    rule = best->forbidden;
    if (best->weak) severity = Severity::kWeak;
    // It may have joined that island while its frames were missed.
    const bool joined = rule == "N5-FOREIGN"_rule && ack.src == best->net.dest;
    if (joined) severity = context_.without(node, best->place.time_us, now);
    said.text =
        acks + ", which it should have " + (rule == "N11-NBYTES"_rule ? "dropped." : "ignored.");
    said.expected = "No effect at this node.";
  } else if (best->net.is_ack()) {
    rule = "T2-LOOP"_rule;
    said.text = "It acks an ack, " + name_of(best->net) + ".";
    said.expected = "An ack is never acked.";
  } else if (best->net.reliable != 1) {
    rule = best->net.reliable == 0 ? "T2-UNRELIABLE"_rule : "T2-TWO"_rule;
    if (best->net.reliable != 0) severity = Severity::kWeak;  // (decision 112)
    said.text = acks + ", whose reliable is " + number(best->net.reliable) + ".";
    said.expected = "An unreliable message is never acked.";
  } else if (best->net.broadcast()) {
    rule = "T2-BROADCAST"_rule;
    severity = Severity::kWeak;
    said.text = "It acks the broadcast " + number(best->net.seq_num) + ".";
    said.expected = "A broadcast is not acked.";
  } else if (best->net.trans_id != component::kConnless) {
    const bool known = known_trans(best->net.trans_id);  // Else: decision 111.
    if (!known) rule = "T1-UNKNOWN"_rule;
    said.text = acks + ", whose TRANSID is " + number(best->net.trans_id) + ".";
    said.expected = known ? "Acks of Connectionless messages." : "No effect at this node.";
    if (known) severity = Severity::kInconclusive;
  } else {
    rule = "T2-ONCE"_rule;
    severity = context_.on_line(node, context_.without_copy(best->sender, best->place, now));
    if (open) severity = Severity::kInconclusive;
    said.text = "A second ack of " + name_of(best->net) + ".";
    said.expected = "One ack for each time that it was received.";
  }
  context_.report(rule, severity, seen.place, node, std::move(said));
}

void Acks::delivered(std::uint16_t node, const Observation& seen,
                     const machine::Received& received) {
  const std::int64_t now = seen.place.time_us;
  Ring<Arrived, kRoom>& ring = arrived_[node];
  const bool whole = context_.device(node).whole;  // Then of several the oldest comes first.
  Arrived* best = nullptr;
  Arrived* nobodys = nullptr;  // It has that content, for no application.
  const auto rank = [whole](const Arrived& a) {
    if (a.forbidden != ReqId::kNone) return 0;
    if (a.delivered >= a.copies) return 1;
    return whole && a.sure && a.delivers != ReqId::kNone ? 3 : 2;
  };
  for (std::size_t i = 0; i < ring.size(); ++i) {
    Arrived& arrived = ring.newest(i);
    if (arrived.net.src != received.src || never_came(node, arrived)) continue;
    const bool sound = arrived.net.sound;
    const bool same = sound && equal(arrived.net.body(), received.data);
    if (same && is_nobodys(arrived.net)) nobodys = &arrived;
    if (sound && (arrived.net.app_id != received.app_id || !same)) continue;
    // A node may make anything of a malformed message.
    const std::size_t came = arrived.net.payload.size();
    if (!sound && came > 2 &&
        (received.data.size() < came - 2 ||
         !equal(arrived.net.payload.from(2), received.data.first(came - 2)))) {
      continue;
    }
    const bool older = whole && best != nullptr && rank(arrived) == rank(*best);
    if (best == nullptr || rank(arrived) > rank(*best) || older) best = &arrived;
  }
  if (best == nullptr) best = nobodys;
  if (best == nullptr) {
    // The message that the delivery was made from is not reported as missing, too.
    for (std::size_t i = 0; i < ring.size(); ++i) {
      Arrived& arrived = ring.oldest(i);
      if (arrived.net.src != received.src || arrived.net.app_id != received.app_id) continue;
      if (arrived.delivers == ReqId::kNone || arrived.delivered > 0) continue;
      arrived.delivers = ReqId::kNone;
      break;
    }
    context_.report("T1-DELIVER"_rule,
                    context_.by_peis(node, received.src.pid) || !context_.has_lines(node)
                        ? Severity::kInconclusive
                        : context_.without(kNobody, context_.run.start_us, now, node),
                    seen.place, node,
                    {"The application gets " + number(received.data.size()) + " bytes from " +
                         text_of(received.src) + " for APPID " + number(received.app_id) +
                         ", which no message that came to this node had.",
                     "What the message carried after TRANSID and APPID.",
                     {}});
    return;
  }
  if (best->net.sound && is_nobodys(best->net)) {
    context_.report(
        "T1-UNKNOWN"_rule, Severity::kFail, seen.place, node,
        {"The application gets " + name_of(best->net) + ", whose TRANSID is " +
             number(best->net.trans_id) + " and whose APPID is " + number(best->net.app_id) + ".",
         "No delivery.",
         {}});
  }
  if (rank(*best) >= 2) {
    apps_[node].delivered.insert(received.app_id);
    judge_order(node, seen, *best);
    ++best->delivered;
    const bool owed = best->must_ack && best->sure;
    best->must_ack = best->must_ack || (best->ackable && !best->no_room);
    // So it did arrive, and was taken, unless a later one that says the same has escaped.
    best->sure = best->sure || now <= context_.due_us(node, best->whole_us) ||
                 context_.without(best->sender, best->place.time_us, now) == Severity::kFail;
    if (best->must_ack && best->sure && !owed && best->acks == 0) ++owed_[node];
    context_.findings.kept("T1-DELIVER"_rule);
    if (best->must_ack) context_.findings.kept("T2-DELIVER"_rule);
    return;
  }
  const bool forbidden = best->forbidden != ReqId::kNone;
  Severity severity = best->weak ? Severity::kWeak : Severity::kFail;
  if (!forbidden) severity = context_.without(best->sender, best->place.time_us, now, node);
  if (!forbidden && context_.by_peis(node, received.src.pid)) severity = Severity::kInconclusive;
  context_.report(forbidden ? best->forbidden : "N2-IN-ORDER"_rule, severity, seen.place, node,
                  {"The application gets " + name_of(best->net) +
                       (forbidden ? ", which the node should have dropped or ignored."
                                  : " more often than it came."),
                   forbidden ? "No delivery." : "Each message once.",
                   {}});
}

void Acks::told(std::uint16_t node, const Observation& seen, std::uint16_t number) {
  Ring<Arrived, kRoom>& ring = arrived_[node];
  const Arrived* its = nullptr;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Arrived& one = ring.newest(i);
    if (!one.net.is_ack() || machine::acked_seq_num(one.net.body()) != number) continue;
    if (its != nullptr) return;  // Nobody knows which of them.
    its = &one;
  }
  // What else comes may be handled where it is received, and messages later.
  const bool waited = its != nullptr && context_.busy(node, its->whole_us, its->whole_us);
  if (waited && context_.device(node).role != machine::Role::kBaseStation) {
    judge_order(node, seen, *its);
  }
}

// Judges the order of deliveries, by a log that has what the node was given.
void Acks::judge_order(std::uint16_t node, const Observation& seen, const Arrived& arrived) {
  std::uint32_t& latest = orders_[node].delivered[static_cast<std::size_t>(arrived.link)];
  const bool late = arrived.order < latest;
  latest = std::max(latest, arrived.order);
  if (!context_.device(node).whole || !arrived.sure) return;
  Ring<Arrived, kRoom>& ring = arrived_[node];
  for (std::size_t i = 0; i < ring.size(); ++i) {
    Arrived& other = ring.newest(i);
    const bool overtaken = other.link == arrived.link && other.order < arrived.order;
    if (overtaken && other.overtaken_us < 0) other.overtaken_us = seen.place.time_us;
  }
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Arrived& other = ring.newest(i);  // Of two that are alike nobody knows which one it is.
    if (other.order != arrived.order && same_payload(other.net, arrived.net)) return;
  }
  if (!late) return context_.findings.kept("N2-IN-ORDER"_rule);
  context_.report("N2-IN-ORDER"_rule, Severity::kFail, seen.place, node,
                  {"The application gets " + name_of(arrived.net) + " after what came later.",
                   "Messages in the order in which they came.",
                   {}});
}

void Acks::showed_life(std::uint16_t node, std::int64_t now_us) {
  if (owed_[node] == 0 || now_us < 0) return;
  Ring<Arrived, kRoom>& ring = arrived_[node];
  for (std::size_t i = 0; i < ring.size(); ++i) {
    Arrived& arrived = ring.newest(i);
    if (!arrived.must_ack || !arrived.sure || arrived.acks > 0) continue;
    missing_ack(node, arrived, now_us, true);
  }
}

// Returns how much longer the ack may take as it comes after those of messages just before.
std::int64_t Acks::queued_us(std::uint16_t node, const Arrived& arrived) {
  Ring<Arrived, kRoom>& ring = arrived_[node];
  std::int64_t before = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Arrived& other = ring.oldest(i);
    const bool just = arrived.whole_us - other.whole_us <= context_.response_us(node);
    before += other.ackable && other.order < arrived.order && just ? 1 : 0;
  }
  return before * context_.response_us(node);
}

// Reports an ack that surely is owed and, by `now_us`, overdue.
void Acks::missing_ack(std::uint16_t node, Arrived& arrived, std::int64_t now_us, bool lives) {
  const Device& device = context_.device(node);
  const std::int64_t due_us = context_.due_us(node, arrived.whole_us);
  if (now_us <= due_us || (device.whole && now_us <= due_us + queued_us(node, arrived))) return;
  --owed_[node];
  arrived.must_ack = false;
  if (lacks_delivery(node, arrived)) return;  // One cause; it is said by that.
  // A radio frame of the node may have escaped; a serial line is seen whole.
  const bool by_radio =
      device.role == machine::Role::kMote ||
      (device.role == machine::Role::kSink && arrived.net.src.devid != machine::kNullDevid);
  Severity severity = Severity::kFail;
  if (arrived.doubtful || context_.by_peis(node, arrived.net.src.pid) ||
      context_.crowded(node, arrived.place.time_us) ||
      context_.who.damaged(arrived.place.time_us, now_us)) {
    severity = Severity::kInconclusive;
  } else if (by_radio) {
    severity = context_.absent_on_line(node, context_.without(node, arrived.place.time_us, now_us));
  } else {
    severity = context_.own_absent_on_line(node, severity);
  }
  context_.report("T2-ACK"_rule, severity, arrived.place, node,
                  {"It surely received " + name_of(arrived.net) +
                       ", reliable, and sent no ack within " + ms_text(context_.response_us(node)) +
                       (lives && !device.hearing ? ", though it sent other frames later." : "."),
                   "An ack.",
                   {}});
}

// Returns whether a copy of the message was delivered before it (decision 111).
bool Acks::delivered_before(std::uint16_t node, const Arrived& arrived) {
  Ring<Arrived, kRoom>& ring = arrived_[node];
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Arrived& other = ring.oldest(i);
    if (other.delivered > 0 && other.place.time_us <= arrived.place.time_us &&
        same_message(other.net, arrived.net) && same_payload(other.net, arrived.net)) {
      return true;
    }
  }
  return false;
}

// Returns whether by the node's log a message came for its application, which did not get it yet.
bool Acks::lacks_delivery(std::uint16_t node, const Arrived& arrived) {
  const Device& device = context_.device(node);
  return arrived.delivers != ReqId::kNone && arrived.sure && arrived.delivered == 0 &&
         device.application && context_.run.has_time &&
         context_.tells<machine::Received>(node, context_.due_us(node, arrived.whole_us)) &&
         !delivered_before(node, arrived);
}

// Returns whether the application of a mote got what came later, and few messages came before: then
// no buffer can have been full, whatever the mote did besides.
bool Acks::overtaken(std::uint16_t node, const Arrived& arrived) {
  if (arrived.overtaken_us < 0 || context_.device(node).role != machine::Role::kMote) return false;
  const std::int64_t since_us =
      context_.held_since_us(node, arrived.whole_us) - 2 * context_.response_us(node);
  std::size_t before = 0;
  Ring<Arrived, kRoom>& ring = arrived_[node];
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Arrived& other = ring.newest(i);
    before += other.order < arrived.order && other.whole_us >= since_us ? 1 : 0;
  }
  return before < machine::kSerialRoom;
}

// Reports what by the node's log came for its application, which never got it.
void Acks::missing_delivery(std::uint16_t node, Arrived& arrived, std::int64_t now_us) {
  // What was overtaken waits for nothing any more (decision 125), however busy its node is.
  const bool overtaken = this->overtaken(node, arrived);
  const std::int64_t due_us = overtaken ? arrived.overtaken_us + context_.response_us(node)
                                        : context_.due_us(node, arrived.whole_us);
  if (now_us <= due_us || !lacks_delivery(node, arrived)) return;
  // A busy application, or what waits for it, may have filled the buffer.
  const bool held = !overtaken && context_.busy(node, arrived.whole_us, due_us);
  const bool acked = arrived.acks > 0;  // Then it was in no buffer any more.
  const bool full = !acked && context_.crowded(node, arrived.place.time_us);
  const bool nothing = arrived.ackable && !acked;
  const bool cut = arrived.delivers == "N11-SHORT"_rule;
  // What else came to the node, and may have filled its buffers, only such a log says.
  const bool given = context_.device(node).hearing;
  context_.report(
      acked && !cut ? "T2-DELIVER"_rule : arrived.delivers,
      held || full || !(given || acked) ? Severity::kInconclusive
      : cut                             ? Severity::kWeak
                                        : Severity::kFail,
      arrived.place, node,
      {std::string("The node ") + (given ? "was given " : "surely received ") +
           name_of(arrived.net) + (acked ? ", acked it" : "") +
           ", and its application did not get it within " + ms_text(context_.response_us(node)) +
           (nothing ? ", nor its sender an ack." : ".") +
           (cut ? " It ended after its nbytes." : ""),
       nothing ? "A delivery and an ack." : "A delivery.",
       {}});
  arrived.delivers = ReqId::kNone;
}

void Acks::interrupted(std::uint16_t node, std::int64_t now_us, bool still_gets) {
  Ring<Arrived, kRoom>& ring = arrived_[node];
  for (std::size_t i = 0; i < ring.size(); ++i) {
    Arrived& arrived = ring.newest(i);
    if (now_us > context_.due_us(node, arrived.whole_us)) continue;
    if (arrived.must_ack && arrived.sure && arrived.acks == 0) --owed_[node];
    arrived.must_ack = false;
    if (!still_gets) arrived.delivers = ReqId::kNone;
  }
}

void Acks::close(std::uint16_t node, Arrived& arrived) {
  if (!arrived.must_ack || arrived.acks > 0) return;
  if (arrived.sure && owed_[node] > 0) --owed_[node];
  arrived.must_ack = false;
  if (context_.device(node).hearing && !arrived.sure) return;  // A log says what arrived.
  context_.report(
      "T2-ACK"_rule, Severity::kInconclusive, arrived.place, node,
      {"No ack of " + name_of(arrived.net) + "; nothing proves that it arrived where application " +
           number(arrived.net.app_id) + " runs.",
       "An ack, if it arrived.",
       {}});
}

void Acks::overdue(std::uint16_t node, std::int64_t now_us) {
  showed_life(node, now_us);
  Ring<Arrived, kRoom>& ring = arrived_[node];
  for (std::size_t i = 0; i < ring.size(); ++i) missing_delivery(node, ring.oldest(i), now_us);
}

void Acks::finish() {
  for (std::size_t i = 0; i < arrived_.size(); ++i) {
    const auto node = static_cast<std::uint16_t>(i);
    const std::int64_t end_us = context_.end_us(node);
    Ring<Arrived, kRoom>& ring = arrived_[node];
    for (std::size_t k = 0; k < ring.size(); ++k) {
      Arrived& arrived = ring.oldest(k);
      // At its end a log of what the node was given needs no sign of life.
      const bool owes = arrived.must_ack && arrived.sure && arrived.acks == 0;
      if (owes && context_.device(node).hearing) missing_ack(node, arrived, end_us, false);
      missing_delivery(node, arrived, end_us);
      close(node, arrived);
    }
  }
}

}  // namespace rubric::check
