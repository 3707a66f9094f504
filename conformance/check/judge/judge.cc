#include "conformance/check/judge/judge_pass.h"
#include "conformance/check/links.h"
#include "conformance/check/observation.h"
#include "conformance/machine/transport.h"

namespace rubric::check {
using machine::Role;
using Kind = Observation::Kind;

Judge::Judge(const Run& run, const Options& options)
    : run_(run),
      who_(identify(run, options)),
      findings_(options.deployed, run.steps, run.past.settled_us),
      context_(run, options, who_, findings_),
      motes_((context_.look_up(), context_), who_.devices.size()),
      join_calls_(context_, motes_, who_.devices.size()),
      sinks_(context_),
      announcements_(context_, sinks_),
      joins_(context_, motes_, sinks_, who_.devices.size()),
      forwarding_(context_),
      originals_(context_, who_.devices.size()),
      acks_(context_, who_.devices.size()),
      synaptic_(context_, who_.devices.size()),
      peis_(context_, who_.devices.size()),
      interfaces_(context_, who_.devices.size()),
      on_air_us_(who_.devices.size(), -1) {}

Report Judge::judge() {
  Report report;
  for (std::uint32_t i = 0; i < run_.seen.size(); ++i) look(i);
  join_calls_.finish();
  announcements_.finish();
  sinks_.finish();
  joins_.finish();
  originals_.finish(interfaces_);
  forwarding_.finish();
  acks_.finish();
  synaptic_.finish();
  peis_.finish();
  interfaces_.finish();
  context_.finish();
  report.frames = frames_ + run_.past.frames;
  report.facts = who_.facts;
  if (findings_.dropped() > 0) {
    report.facts.push_back(number(findings_.dropped()) + " more findings are not listed.");
  }
  report.exercised = findings_.exercised();
  report.findings = findings_.take();
  report.verdict = verdict_of(report.findings);
  return report;
}

bool Judge::is(std::uint16_t device, Role role) const {
  return device != kNobody && who_.devices[device].known && who_.devices[device].role == role;
}

void Judge::look(std::uint32_t index) {
  const Observation& seen = run_.seen[index];
  const Mark& mark = who_.marks[index];
  context_.at_us = seen.place.time_us;
  overdue(mark.device, seen.place.time_us);
  if (mark.receiver != mark.device) overdue(mark.receiver, seen.place.time_us);
  switch (seen.kind) {
    case Kind::kRadio:
      ++frames_;
      if (mark.repeat) return repeated(index, seen, mark);
      // A sink speaks when it is spoken to, so it has heard something by its first frame.
      if (mark.new_life) begin_life(mark.device, on_air_us_[mark.device]);
      radio(index, seen, mark);
      if (mark.device == kNobody) break;
      on_air_us_[mark.device] = seen.place.time_us;
      joins_.showed_life(mark.device, seen.place.time_us);
      forwarding_.showed_life(mark.device, seen);
      if (!seen.received) interfaces_.sent(mark.device, seen);
      break;
    case Kind::kSerial:
      ++frames_;
      if (mark.repeat) return repeated(index, seen, mark);
      if (mark.device == kNobody) break;
      serial(index, seen, mark);
      if (!seen.to_mote) forwarding_.showed_life(mark.device, seen);
      if (!seen.received) interfaces_.sent(mark.device, seen);
      break;
    case Kind::kPeis:
      ++frames_;
      peis(seen, seen.received ? mark.receiver : mark.device);
      break;
    case Kind::kCall:
      if (mark.device != kNobody) called(seen, mark.device);
      break;
    case Kind::kNotice:
      if (mark.device != kNobody) told(seen, mark.device);
      break;
    case Kind::kReboot:
      if (mark.device == kNobody) break;
      joins_.rebooted(mark.device, seen.place.time_us);
      join_calls_.closes(mark.device, seen.place.time_us);
      announcements_.ends(mark.device, seen.place.time_us);
      originals_.ends(mark.device, seen.place.time_us, interfaces_);
      begin_life(mark.device, INT64_MAX);
      // A base station begins in its own island; its sink need not.
      if (is(mark.device, Role::kBaseStation) && who_.devices[mark.device].whole) {
        own_island_[mark.device] = who_.devices[mark.device].island;
      }
      if (is(mark.device, Role::kMote)) motes_.booted(mark.device, seen.place.time_us);
      break;
    case Kind::kDamaged: malformed(seen); break;
    case Kind::kForeign:
    case Kind::kLinkAck: break;
  }
}

void Judge::overdue(std::uint16_t device, std::int64_t now_us) {
  if (device == kNobody || !who_.devices[device].whole || !run_.has_time) return;
  joins_.showed_life(device, now_us);
  announcements_.overdue(device, now_us);
  forwarding_.overdue(device, now_us);
  acks_.overdue(device, now_us);
  peis_.overdue(device, now_us);
  synaptic_.settle(device, now_us);
}

void Judge::begin_life(std::uint16_t device, std::int64_t since_us) {
  if (is(device, Role::kMote)) motes_.begin_life(device);
  join_calls_.begin_life(device);
  if (is(device, Role::kSink)) sinks_.begin_life(device, since_us);
  if (is(device, Role::kSink)) forwarding_.begin_life(device, since_us);
  own_island_.erase(device);
  context_.begin_life(device);
  originals_.begin_life(device);
  acks_.begin_life(device, since_us);
  synaptic_.begin_life(device);
  peis_.begin_life(device);
  joins_.begin_life(device);
  interfaces_.begin_life(device);
}

// Returns the sink that surely received a frame for the sinks' address.
std::uint16_t Judge::sure_sink(std::uint32_t index) const {
  const std::uint16_t given = who_.marks[index].receiver;
  if (interfaces_.switched_off(given, machine::Link::kRadio)) return kNobody;
  if (given != kNobody) return given;
  const std::uint16_t only = context_.only_sink;
  if (only == kNobody || !link_acked(run_, index)) return kNobody;
  return sinks_.may_have_lost_island(only, run_.seen[index].place.time_us) ? kNobody : only;
}

void Judge::radio(std::uint32_t index, const Observation& seen, const Mark& mark) {
  if (mark.device != kNobody && !who_.devices[mark.device].known) {
    context_.report_stranger(seen, mark.device);
  }
  switch (seen.frame.type) {
    case am::kJoin: {
      Request request;
      if (!parse_request(seen.frame.payload, request)) return cut_off(seen, mark.device);
      if (is(mark.device, Role::kMote)) {
        originals_.asks_to_join(mark.device);
        joins_.repeats(mark.device, seen.place.time_us);
        joins_.asks_again(mark.device, request.seq_num, seen.place.time_us);
        const bool as_member = join_calls_.request(mark.device, seen, request);
        motes_.request(mark.device, seen, request, as_member);
        joins_.asked(mark.device, index);
      }
      sinks_.request(mark.device, seen, request, sure_sink(index));
      joins_.surely_asked(sure_sink(index), index, request.seq_num);
      return;
    }
    case am::kJoinReply: {
      Reply reply;
      if (!parse_reply(seen.frame.payload, reply)) return cut_off(seen, mark.device);
      if (is(mark.device, Role::kSink)) {
        const std::uint16_t before = sinks_.island(mark.device);
        const std::uint16_t answered = sinks_.reply(mark.device, seen, reply);
        island_shown(mark.device, before, seen.place.time_us);
        joins_.answered(mark.device, answered, seen.place);
      }
      if (is(mark.device, Role::kMote)) {
        role_broken("J10-MOTE"_rule, "A mote sends a join_reply.", seen, mark.device);
      }
      replied(index, seen, mark, reply);
      return;
    }
    case am::kAckJoin: {
      AckJoin ack;
      if (!parse_ack_join(seen.frame.payload, ack)) return cut_off(seen, mark.device);
      if (is(mark.device, Role::kMote)) {
        motes_.ack_join(mark.device, seen, ack, link_acked(run_, index));
      }
      if (is(mark.device, Role::kSink)) {
        role_broken("J10-SINK"_rule, "A sink sends an ack_join.", seen, mark.device);
      }
      sinks_.ack_join(mark.device, seen, ack, sure_sink(index));
      return;
    }
    case am::kNet: {
      Net net;
      if (!parse_net(seen.frame.payload, net)) return cut_off(seen, mark.device);
      radio_net(index, seen, mark, net);
      return;
    }
    default: return;
  }
}

// Takes a join message that is known from its sender: a log's line that gives it to a node, or the
// link's repetition, which a node may have heard instead of the first or as well.
void Judge::joins_heard(std::uint32_t index, const Observation& seen, const Mark& mark) {
  if (interfaces_.switched_off(mark.receiver, machine::Link::kRadio)) return;
  Request request;
  Reply reply;
  AckJoin ack;
  if (seen.frame.type == am::kJoin && parse_request(seen.frame.payload, request)) {
    sinks_.request(kNobody, seen, request, mark.receiver);
    joins_.surely_asked(mark.receiver, index, request.seq_num);
  } else if (seen.frame.type == am::kJoinReply && parse_reply(seen.frame.payload, reply)) {
    replied(index, seen, mark, reply);
  } else if (seen.frame.type == am::kAckJoin && parse_ack_join(seen.frame.payload, ack)) {
    sinks_.ack_join(kNobody, seen, ack, mark.receiver);
  }
}

// Takes a reply. Motes whose log has what they were given hear nothing else.
void Judge::replied(std::uint32_t index, const Observation& seen, const Mark& mark,
                    const Reply& reply) {
  if (seen.received) sinks_.answered(seen.frame.dest, reply.seq_num);
  const bool stray = mark.device == kNobody || !who_.devices[mark.device].known;
  if (stray && !seen.received) sinks_.may_have_replied(seen, reply);
  const bool all = seen.frame.dest == machine::kAmBroadcast;
  context_.for_motes(all ? reply.mote : seen.frame.dest, [&](std::uint16_t mote) {
    const bool given = mark.receiver == mote;
    if (who_.devices[mote].hearing ? !given : seen.received) return;
    const bool only =
        context_.mote_of_am[seen.frame.dest] == mote && context_.next_of_am[mote] == kNobody;
    // Such an offer is to be ignored, as if it had not come (J4-ADDRESS).
    const bool void_offer = is_void(reply, who_.devices[mote].am);
    const bool heard = given || (only && link_acked(run_, index));
    const bool sure = heard && !void_offer;
    motes_.reply(mote, seen, index, reply, sure);
    if (sure) joins_.surely_offered(mote, index, reply);
  });
}

void Judge::role_broken(ReqId rule, const char* what, const Observation& seen,
                        std::uint16_t device) {
  context_.report(rule, Severity::kFail, seen.place, device,
                  {what, "Join requests and their acks are for sinks, replies for motes.", {}});
}

void Judge::called(const Observation& seen, std::uint16_t device) {
  interfaces_.called(device, seen);
  if (const auto* join = std::get_if<machine::JoinIsland>(seen.call)) {
    if (is(device, Role::kMote)) join_calls_.called(device, seen, *join);
    return;
  }
  if (const auto* set = std::get_if<machine::SetInterface>(seen.call)) {
    if (set->link == machine::Link::kSerial) peis_.switched(device, set->on, seen.place.time_us);
    if (!set->on) acks_.interrupted(device, seen.place.time_us, who_.devices[device].whole);
    originals_.switched(device, *set, seen.place.time_us);
    synaptic_.able(device, *set, seen.place.time_us);
    if (set->link == machine::Link::kSerial) {
      forwarding_.serial_set(device, set->on);
      announcements_.serial_set(device, set->on, seen.place.time_us);
    } else {
      forwarding_.radio_set(device, set->on);
      joins_.radio_set(device, set->on, seen.place.time_us);
      join_calls_.radio_set(device, set->on, seen.place.time_us);
    }
    return;
  }
  if (const auto* send = std::get_if<machine::Send>(seen.call)) {
    const bool off = interfaces_.switched_off(device, machine::Link::kRadio) ||
                     interfaces_.switched_off(device, machine::Link::kSerial);
    return originals_.called(device, seen, *send,
                             off ? machine::Address{kNoIsland, 0} : address_of(device));
  }
  const machine::Call& call = *seen.call;
  const bool other = std::holds_alternative<machine::GetInterface>(call) ||
                     std::holds_alternative<machine::GetClock>(call) ||
                     std::holds_alternative<machine::SetIslandId>(call);
  if (const auto* set = std::get_if<machine::SetIslandId>(&call)) {
    asked_island_[device] = set->island;
    const bool owes = !interfaces_.switched_off(device, machine::Link::kSerial) &&
                      !machine::is_reserved(set->island) && who_.devices[device].whole;
    if (is(device, Role::kBaseStation)) peis_.asked_island(device, seen, set->island, owes);
    if (!who_.devices[device].whole) {
      originals_.moved(device);
      peis_.moved(device);
    }
  }
  if (other) return;  // The rest is for the channels.
  const Device& d = who_.devices[device];
  const machine::Address sinks_own{sinks_.island(device), d.am};
  const machine::Address motes_own =
      motes_.address(device).value_or(machine::Address{kNoIsland, d.am});
  synaptic_.called(device, seen, d.role == Role::kSink ? sinks_own : motes_own);
}

void Judge::told(const Observation& seen, std::uint16_t device) {
  interfaces_.told(device, seen);
  synaptic_.told(device, seen, *seen.notice);
  if (const auto* joined = std::get_if<machine::Joined>(seen.notice)) {
    joins_.repeats(device, seen.place.time_us);
    if (is(device, Role::kMote)) join_calls_.told(device, seen, *joined);
    if (joined->success) synaptic_.member(device, seen.place.time_us);
  } else if (const auto* mote_joined = std::get_if<machine::MoteJoined>(seen.notice)) {
    if (is(device, Role::kSink)) announcements_.told(device, seen, *mote_joined);
  } else if (const auto* mote_left = std::get_if<machine::MoteLeft>(seen.notice)) {
    announcements_.forgets(device, mote_left->address.devid, seen.place.time_us);
    sinks_.forgot(device, mote_left->address.devid);
  } else if (const auto* received = std::get_if<machine::Received>(seen.notice)) {
    acks_.delivered(device, seen, *received);
  } else if (const auto* ack = std::get_if<machine::AckReceived>(seen.notice)) {
    originals_.told(device, seen, *ack);
    if (ack->success) acks_.told(device, seen, ack->seq_num);
  } else if (const auto* done = std::get_if<machine::OperationResult>(seen.notice)) {
    const auto asked = asked_island_.find(device);
    if (asked == asked_island_.end()) return;
    // A call without a result is answered with success; what is sent tells (decision 132).
    if (done->success && !machine::is_reserved(asked->second) && who_.devices[device].whole) {
      own_island_[device] = asked->second;
    }
    if (!done->success) peis_.refused_island(device, asked->second);
    asked_island_.erase(asked);
  } else if (const auto* result = std::get_if<machine::SendResult>(seen.notice)) {
    originals_.told(device, seen, *result);
  } else if (const auto* data = std::get_if<machine::SynDataReceived>(seen.notice)) {
    synaptic_.told(device, seen, *data);
  } else if (const auto* clock = std::get_if<machine::Clock>(seen.notice)) {
    if (is(device, Role::kMote)) joins_.clock_told(device, seen, clock->ms);
  }
}

// Returns a node's own address; the island is kNoIsland if it has none, or that is not known.
machine::Address Judge::address_of(std::uint16_t node) const {
  const Device& device = who_.devices[node];
  if (device.role == Role::kMote)
    return motes_.address(node).value_or(machine::Address{kNoIsland, 0});
  if (device.role == Role::kSink) return {sinks_.island(node), device.am};
  if (const auto own = own_island_.find(node); own != own_island_.end()) {
    return {own->second, machine::kNullDevid};
  }
  const bool alone = device.partner == kNobody;
  return {alone ? device.island : sinks_.island(device.partner), machine::kNullDevid};
}

// Takes the link's own repetition, or a log's line that shows who received a frame.
void Judge::repeated(std::uint32_t index, const Observation& seen, const Mark& mark) {
  if (seen.kind == Kind::kRadio) joins_heard(index, seen, mark);
  if (const std::int32_t id = set_island_id(seen.frame); id >= 0 && seen.to_mote) {
    const std::uint16_t sink =
        mark.device == kNobody ? mark.receiver : who_.devices[mark.device].partner;
    const bool sure = serial_acked(run_, index) || mark.receiver == sink;
    if (!sure || sink == kNobody) return;
    return island_told(sink, seen.place, static_cast<std::uint16_t>(id), true);
  }
  Net net;
  if (seen.frame.type != am::kNet || !parse_net(seen.frame.payload, net)) return;
  if (mark.receiver != kNobody) return surely(seen, mark, net);
  const bool serial = seen.kind == Kind::kSerial;
  if (serial && mark.device == kNobody) return;
  if (mark.late && mark.device != kNobody && net.reliable == 1) {
    context_.report("T3-RESEND"_rule, Severity::kInconclusive, seen.place, mark.device,
                    {name_of(net) + " leaves again with its DSN, later than the link repeats it.",
                     "A link's repetition within " + ms_text(kLinkRepeatUs) + ".",
                     {}});
  }
  const std::int64_t now = seen.place.time_us;
  forwarding_.repeated(net, serial ? who_.devices[mark.device].partner : kNobody, now);
  if (!serial && mark.device != kNobody) synaptic_.repeated(mark.device, now);
  context_.for_motes(seen.frame.dest, [&](std::uint16_t mote) { acks_.repeated(mote, net, now); });
  for (const std::uint16_t sink : context_.sinks) acks_.repeated(sink, net, now);
}

// Takes a log's line that gives a node a message that is known from its sender.
void Judge::surely(const Observation& seen, const Mark& mark, const Net& net) {
  const bool known = acks_.came(mark.receiver, net);
  // A line can give a base station something else than its sink sent.
  if (!known && seen.kind == Kind::kSerial && is(mark.receiver, Role::kBaseStation)) {
    return base_station_hears(mark.device, seen, mark, net);
  }
  if (interfaces_.switched_off(mark.receiver, seen.frame.link)) return given_off(seen, mark, net);
  acks_.surely(mark.receiver, net, seen.place.time_us,
               standing(mark.receiver) != Standing::kOutside, no_room(mark.receiver, net));
  synaptic_.heard(mark.receiver, seen, net);
  if (seen.kind == Kind::kRadio) synaptic_.given(mark.receiver, seen, net);
  if (net.is_ack()) originals_.ack_given(mark.receiver, net, seen.place.time_us);
  if (seen.kind == Kind::kRadio) {
    forwarding_.heard_on_radio(seen, mark.device, net, mark.receiver, kNobody);
  }
  if (mark.again) acks_.repeated(mark.receiver, net, seen.place.time_us);
  if (seen.kind == Kind::kSerial) {
    peis_.surely_up(mark.receiver, net, seen.place.time_us);
    forwarding_.surely_down(mark.receiver, net, seen.place.time_us);
  }
}

void Judge::radio_net(std::uint32_t index, const Observation& seen, const Mark& mark,
                      const Net& net) {
  const std::uint16_t sender = mark.device;
  if (sender != kNobody && !is(sender, Role::kSink)) originals_.used(sender, net.seq_num);
  if (is(sender, Role::kMote)) {
    motes_.net_msg(sender, seen, net);
    own_message(sender, seen, net, machine::Link::kRadio, motes_.address(sender).value_or(net.src));
  } else if (is(sender, Role::kSink)) {
    // A base station may hand its sink even the sink's own message (decision 126).
    const bool passes = forwarding_.came_down(sender, net) ||
                        (forwarding_.alters(sender, net) && !originals_.asked(sender, net));
    if (!passes) originals_.used(sender, net.seq_num);
    if (!passes && is_sinks_own(sender, seen, net)) {
      own_message(sender, seen, net, machine::Link::kRadio, net.src);
    } else if (passes || !forged(sender, seen, net, machine::Link::kRadio, address_of(sender))) {
      acks_.showed_life(sender, seen.place.time_us);
      const bool known = forwarding_.sent_on_radio(sender, seen, net);
      if (!known && !net.sound) originals_.judge_content(sender, seen, net);
    }
  }
  if (sender == kNobody && seen.frame.src == context_.sink_am) forwarding_.somebody_sent(net);
  const std::uint16_t sure = sure_sink(index);
  forwarding_.heard_on_radio(seen, sender, net, sure, kNobody);
  given_off(seen, mark, net);
  const auto hear = [&](std::uint16_t mote) {
    if (mote != sender) mote_hears(index, mote, seen, mark, net);
  };
  if (seen.frame.dest == machine::kAmBroadcast) {
    for (std::size_t i = 0; i < who_.devices.size(); ++i) {
      const auto node = static_cast<std::uint16_t>(i);
      if (is(node, Role::kMote)) hear(node);
    }
  } else {
    context_.for_motes(seen.frame.dest, hear);
  }
  for (const std::uint16_t sink : context_.sinks) {
    const std::uint16_t am = who_.devices[sink].am;
    if (sink == sender) continue;
    if (seen.frame.dest != am && seen.frame.dest != machine::kAmBroadcast) continue;
    hears(sink, {Role::kSink, {sinks_.island(sink), am}, true, context_.sink_am},
          machine::Link::kRadio, seen, sender, net, sure == sink || mark.receiver == sink);
  }
  if (net.is_ack()) ack_comes(index, net, seen, mark.receiver);
}

// Takes a message of the node's own.
void Judge::own_message(std::uint16_t node, const Observation& seen, const Net& net,
                        machine::Link link, machine::Address own) {
  interfaces_.own_message(node, seen, net.seq_num);
  originals_.sent(node, seen, net, link, own);
  Net meant = net;  // An ack to the local island is said by N3-LOCAL, and answers all the same.
  if (net.dest.pid == machine::kLocalPid) meant.dest.pid = own.pid;
  // Late, an ack is not missing (decision 125).
  if (net.is_ack()) acks_.sent(node, seen, meant, ack_timeout_us(meant.dest));
  acks_.showed_life(node, seen.place.time_us);
  if (net.sound && net.trans_id == component::kSynChannel) synaptic_.sent(node, seen, net);
}

// Judges a message that only the node's own application can have asked for, under another name.
// Returns whether it is one.
bool Judge::forged(std::uint16_t node, const Observation& seen, const Net& net, machine::Link link,
                   machine::Address own) {
  if (own.pid == kNoIsland || net.src == own || !originals_.asked(node, net)) return false;
  if (originals_.has_moved(node)) return false;  // Nobody knows its island.
  context_.report("N1-SRC"_rule, Severity::kFail, seen.place, node,
                  {"The message to " + text_of(net.dest) + " that its application asked for has " +
                       "src " + text_of(net.src) + ".",
                   "src " + text_of(own) + ".",
                   {}});
  own_message(node, seen, net, link, own);
  return true;
}

void Judge::serial(std::uint32_t index, const Observation& seen, const Mark& mark) {
  const std::uint16_t sink = seen.to_mote ? who_.devices[mark.device].partner : mark.device;
  if (seen.to_mote && !seen.received && seen.frame.type == am::kConfig) {
    peis_.told_island(mark.device, seen, set_island_id(seen.frame));
  }
  if (sink == kNobody) {  // Nothing is known of the sink, as in a part of a run.
    Net net;
    const bool handed = seen.to_mote && !seen.received && seen.frame.type == am::kNet;
    const machine::Address base = address_of(mark.device);
    if (!handed || !parse_net(seen.frame.payload, net)) return;
    if (net.src == base) return own_message(mark.device, seen, net, machine::Link::kSerial, base);
    handed_down(mark.device, seen, net, base);
    return;
  }
  if (const std::int32_t id = set_island_id(seen.frame); id >= 0 && seen.to_mote) {
    if (!seen.received) own_island_.erase(mark.device);  // It is what it now tells its sink.
    const bool sure = serial_acked(run_, index) || mark.receiver == sink;
    return island_told(sink, seen.place, static_cast<std::uint16_t>(id), sure);
  }
  if (seen.to_mote && seen.frame.type == am::kConfig) sinks_.configured(sink, seen.frame);
  // In a whole log a late report is missing; else it may be this very frame (decision 125).
  const bool whole_log = who_.devices[mark.device].whole;
  if (!seen.to_mote && whole_log) announcements_.showed_life(sink, seen.place.time_us);
  Net net;
  if (seen.frame.type != am::kNet) return;
  if (!parse_net(seen.frame.payload, net)) return cut_off(seen, mark.device);
  if (!seen.received) whole(seen, mark.device);
  // What it passes on has the number that it came with.
  const bool passes = seen.to_mote ? peis_.came(mark.device, net) : forwarding_.came_up(sink, net);
  if (!seen.received && !passes) originals_.used(mark.device, net.seq_num);
  if (seen.to_mote) {
    down_serial(index, seen, mark, sink, net);
  } else {
    up_serial(seen, mark, sink, net, passes);
    if (!whole_log) announcements_.showed_life(sink, seen.place.time_us);
  }
  if (net.is_ack()) ack_comes(index, net, seen, mark.receiver);
}

void Judge::whole(const Observation& seen, std::uint16_t sender) {
  constexpr std::size_t kWhole = rubicon::NetMsgView::kMaxSizeBytes;
  const std::size_t size = seen.frame.payload.size();
  if (size >= kWhole || !cut_short_.insert(sender).second) return;
  context_.report("N11-WHOLE"_rule, Severity::kWeak, seen.place, sender,
                  {"A net_msg of " + number(size) + " bytes on the serial line.",
                   number(kWhole) + " bytes; hosts of release 1.0 drop what is shorter.",
                   {}});
}

void Judge::up_serial(const Observation& seen, const Mark& mark, std::uint16_t sink, const Net& net,
                      bool passes) {
  SerialJoined joined;
  // What an application sends may look like one.
  if (!passes && !originals_.asked(sink, net) && parse_serial_joined(net, joined)) {
    const std::uint16_t before = sinks_.island(sink);
    announcements_.report(sink, seen, net, joined);
    island_shown(sink, before, seen.place.time_us);
  } else if (!forwarding_.alters_up(sink, net) && is_sinks_own(sink, seen, net)) {
    own_message(sink, seen, net, machine::Link::kSerial, net.src);
    forwarding_.went_up(sink, seen.place.time_us);
  } else if (passes || !forged(sink, seen, net, machine::Link::kSerial, address_of(sink))) {
    acks_.showed_life(sink, seen.place.time_us);
    if (passes) joins_.hears_on(sink, seen.place.time_us);
    forwarding_.sent_on_serial(sink, seen, net);
  }
  base_station_hears(sink, seen, mark, net);
}

void Judge::handed_down(std::uint16_t base, const Observation& seen, const Net& net,
                        machine::Address own) {
  if (!peis_.came(base, net) && forged(base, seen, net, machine::Link::kSerial, own)) return;
  peis_.went_down(base, seen, net);
}

void Judge::down_serial(std::uint32_t index, const Observation& seen, const Mark& mark,
                        std::uint16_t sink, const Net& net) {
  const std::uint16_t island = sinks_.island(sink);
  const machine::Address base = address_of(mark.device);
  if (net.src == base) own_message(mark.device, seen, net, machine::Link::kSerial, base);
  if (net.src != base && !seen.received) handed_down(mark.device, seen, net, base);
  const bool sure = (serial_acked(run_, index) || mark.receiver == sink) &&
                    !sinks_.may_have_lost_island(sink, seen.place.time_us);
  const bool off = interfaces_.off(sink, machine::Link::kSerial, seen.place.time_us);
  const bool able = !interfaces_.switched_off(sink, machine::Link::kSerial) &&
                    !interfaces_.switched_off(sink, machine::Link::kRadio);
  forwarding_.heard_on_serial(sink, mark.device, seen, net, {sure && able, sure, off, base.pid});
  const std::uint16_t am = who_.devices[sink].am;
  if (net.dest.devid != am && net.dest.devid != machine::kBroadcastDevid) {
    // To be sent on: only its destination acks it.
    const bool ours = island != kNoIsland && net.dest.pid == island;
    if (ours) acks_.arrived(sink, seen, mark.device, net, {.forbidden = "N7-DELIVER"_rule});
    return;
  }
  hears(sink, {Role::kSink, {island, am}, true, context_.sink_am}, machine::Link::kSerial, seen,
        mark.device, net, sure);
}

// Takes a message between base stations, by the log of `base`.
void Judge::peis(const Observation& seen, std::uint16_t base) {
  Net net;
  if (!is(base, Role::kBaseStation) || seen.frame.type != am::kNet) return;
  if (!parse_net(seen.frame.payload, net)) return;
  const machine::Address own = address_of(base);
  if (!seen.received) {
    const bool first = originals_.accepted(base, net.seq_num);
    const bool came = peis_.came(base, net);
    if (!came) originals_.used(base, net.seq_num);
    if (!came && forged(base, seen, net, machine::Link::kPeis, own)) return;
    const bool original = peis_.sent(base, seen, net, own, first);
    if (original) own_message(base, seen, net, machine::Link::kPeis, own);
    return;
  }
  const bool off = interfaces_.switched_off(base, machine::Link::kSerial);
  peis_.given(base, seen, net, own, off);
  hears(base, {Role::kBaseStation, own, true, context_.sink_am}, machine::Link::kPeis, seen,
        kNobody, net, true);
  const std::int32_t acked = net.is_ack() ? machine::acked_seq_num(net.body()) : -1;
  if (acked < 0 || net.dest != own) return;
  originals_.ack_heard(base, net, static_cast<std::uint16_t>(acked), Wait::kOver);
  originals_.ack_given(base, net, seen.place.time_us);
}

}  // namespace rubric::check
