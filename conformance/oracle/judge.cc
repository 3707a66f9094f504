// The second pass: shows each observation to the parts that judge it.
#include "conformance/oracle/judge.h"

#include <algorithm>

#include "conformance/machine/route.h"
#include "conformance/machine/transport.h"
#include "conformance/oracle/acks.h"
#include "conformance/oracle/forward.h"
#include "conformance/oracle/links.h"
#include "conformance/oracle/mote_join.h"
#include "conformance/oracle/sent.h"
#include "conformance/oracle/sink_join.h"
#include "conformance/oracle/synaptic_watch.h"

namespace rubric::oracle {
namespace {

using machine::Role;
using Kind = Observation::Kind;

class Judge {
 public:
  Judge(const Run& run, const Options& options)
      : run_(run),
        who_(identify(run, options)),
        findings_(options.deployed),
        context_(run, options, who_, findings_),
        motes_((context_.look_up(), context_), who_.devices.size()),
        sinks_(context_),
        forwarding_(context_),
        originals_(context_, who_.devices.size()),
        acks_(context_, who_.devices.size()),
        synaptic_(context_, who_.devices.size()) {}

  Report judge() {
    Report report;
    for (std::uint32_t i = 0; i < run_.seen.size(); ++i) look(i);
    motes_.finish(run_.end_us);
    sinks_.finish(run_.end_us);
    originals_.finish(run_.end_us);
    forwarding_.finish(run_.end_us);
    acks_.finish();
    report.frames = frames_;
    report.facts = who_.facts;
    if (findings_.dropped() > 0) {
      report.facts.push_back(number(findings_.dropped()) + " more findings are not listed.");
    }
    report.exercised = findings_.exercised();
    report.findings = findings_.take();
    report.verdict = verdict_of(report.findings);
    return report;
  }

 private:
  bool is(std::uint16_t device, Role role) const {
    return device != kNobody && who_.devices[device].known && who_.devices[device].role == role;
  }

  void look(std::uint32_t index) {
    const Observation& seen = run_.seen[index];
    const Mark& mark = who_.marks[index];
    switch (seen.kind) {
      case Kind::kRadio:
        ++frames_;
        if (mark.repeat) return repeated(index, seen, mark);
        if (mark.new_life) begin_life(mark.device);
        radio(index, seen, mark);
        break;
      case Kind::kSerial:
        ++frames_;
        if (mark.repeat) return repeated(index, seen, mark);
        if (mark.device != kNobody) serial(index, seen, mark);
        break;
      case Kind::kCall:
        if (mark.device != kNobody) called(seen, mark.device);
        break;
      case Kind::kNotice:
        if (mark.device != kNobody) told(seen, mark.device);
        break;
      case Kind::kReboot:
        if (mark.device != kNobody) begin_life(mark.device);
        break;
      case Kind::kLinkAck:
      case Kind::kDamaged:
        break;
    }
  }

  void begin_life(std::uint16_t device) {
    if (is(device, Role::kMote)) motes_.begin_life(device);
    if (is(device, Role::kSink)) sinks_.begin_life(device);
    if (is(device, Role::kSink)) forwarding_.begin_life(device);
    originals_.begin_life(device);
    acks_.begin_life(device);
    synaptic_.begin_life(device);
  }

  // The link's own repetition, or a log's line that says who received a frame.
  void repeated(std::uint32_t index, const Observation& seen, const Mark& mark) {
    if (seen.kind == Kind::kRadio) joins_heard(index, seen, mark);
    Net net;
    if (seen.frame.type != am::kNet || !parse_net(seen.frame.payload, net)) return;
    if (mark.receiver != kNobody) return surely(seen, mark, net);
    const bool serial = seen.kind == Kind::kSerial;
    if (serial && mark.device == kNobody) return;
    forwarding_.repeated(net, serial ? who_.devices[mark.device].partner : kNobody);
    context_.for_motes(seen.frame.dest, [&](std::uint16_t mote) { acks_.repeated(mote, net); });
    for (const std::uint16_t sink : context_.sinks) acks_.repeated(sink, net);
  }

  // A log's line that gives a node a message that is known from its sender.
  void surely(const Observation& seen, const Mark& mark, const Net& net) {
    acks_.surely(mark.receiver, net);
    if (net.is_ack()) originals_.ack_given(mark.receiver, net, seen.place.time_us);
    if (seen.kind == Kind::kRadio) {
      forwarding_.heard_on_radio(seen, mark.device, net, mark.receiver);
    }
    if (mark.again) acks_.repeated(mark.receiver, net);
  }

  // Who surely received a frame for the sinks' address.
  std::uint16_t sure_sink(std::uint32_t index) const {
    if (who_.marks[index].receiver != kNobody) return who_.marks[index].receiver;
    return context_.only_sink != kNobody && link_acked(run_, index) ? context_.only_sink : kNobody;
  }

  void radio(std::uint32_t index, const Observation& seen, const Mark& mark) {
    if (mark.device != kNobody && !who_.devices[mark.device].known) {
      context_.report_stranger(seen, mark.device);
    }
    switch (seen.frame.type) {
      case am::kJoin: {
        Request request;
        if (!parse_request(seen.frame.payload, request)) return;
        if (is(mark.device, Role::kMote)) motes_.request(mark.device, seen, request);
        sinks_.request(mark.device, seen, request, sure_sink(index));
        return;
      }
      case am::kJoinReply: {
        Reply reply;
        if (!parse_reply(seen.frame.payload, reply)) return;
        if (is(mark.device, Role::kSink)) sinks_.reply(mark.device, seen, reply);
        if (is(mark.device, Role::kMote)) {
          role_broken(req::kJ10Mote, "A mote sends a join_reply.", seen, mark.device);
        }
        replied(index, seen, mark, reply);
        return;
      }
      case am::kAckJoin: {
        AckJoin ack;
        if (!parse_ack_join(seen.frame.payload, ack)) return;
        if (is(mark.device, Role::kMote)) {
          motes_.ack_join(mark.device, seen, ack, link_acked(run_, index));
        }
        if (is(mark.device, Role::kSink)) {
          role_broken(req::kJ10Sink, "A sink sends an ack_join.", seen, mark.device);
        }
        sinks_.ack_join(mark.device, seen, ack, sure_sink(index));
        return;
      }
      case am::kNet: {
        Net net;
        if (!parse_net(seen.frame.payload, net)) return;
        radio_net(index, seen, mark, net);
        return;
      }
      default:
        return;
    }
  }

  // A join message that is known from its sender: a log's line that gives it to a node, or the
  // link's repetition, which a node may have heard in place of the first or as well.
  void joins_heard(std::uint32_t index, const Observation& seen, const Mark& mark) {
    Request request;
    Reply reply;
    AckJoin ack;
    if (seen.frame.type == am::kJoin && parse_request(seen.frame.payload, request)) {
      sinks_.request(kNobody, seen, request, mark.receiver);
    } else if (seen.frame.type == am::kJoinReply && parse_reply(seen.frame.payload, reply)) {
      replied(index, seen, mark, reply);
    } else if (seen.frame.type == am::kAckJoin && parse_ack_join(seen.frame.payload, ack)) {
      sinks_.ack_join(kNobody, seen, ack, mark.receiver);
    }
  }

  // Motes whose log has what they were given hear nothing else.
  void replied(std::uint32_t index, const Observation& seen, const Mark& mark,
               const Reply& reply) {
    context_.for_motes(seen.frame.dest, [&](std::uint16_t mote) {
      const bool given = mark.receiver == mote;
      if (who_.devices[mote].hearing ? !given : seen.received) return;
      motes_.reply(mote, seen, index, reply, given);
    });
  }

  void role_broken(ReqId rule, const char* what, const Observation& seen, std::uint16_t device) {
    context_.report(rule, Severity::kFail, seen.place, device,
                    {what, "Join requests and their acks are for sinks, replies for motes.", {}});
  }

  void radio_net(std::uint32_t index, const Observation& seen, const Mark& mark, const Net& net) {
    const std::uint16_t sender = mark.device;
    if (is(sender, Role::kMote)) {
      motes_.net_msg(sender, seen, net);
      own_message(sender, seen, net, machine::Link::kRadio,
                  motes_.address(sender).value_or(net.src));
    } else if (is(sender, Role::kSink)) {
      const Device& sink = who_.devices[sender];
      // A base station may hand its sink even the sink's own message (decision 126).
      const bool own = net.src == machine::Address{sinks_.island(sender), sink.am};
      if (own && !forwarding_.came_down(sender, net)) {
        own_message(sender, seen, net, machine::Link::kRadio, net.src);
      } else {
        acks_.showed_life(sender, seen.place.time_us);
        forwarding_.sent_on_radio(sender, seen, net);
      }
    }
    if (sender == kNobody && seen.frame.src == context_.sink_am) forwarding_.somebody_sent(net);
    const std::uint16_t sure = sure_sink(index);
    forwarding_.heard_on_radio(seen, sender, net, sure);
    const auto hear = [&](std::uint16_t mote) {
      if (mote != sender) mote_hears(mote, seen, mark, net);
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
    if (net.is_ack()) ack_comes(net);
    if (net.is_ack() && mark.receiver != kNobody) {
      originals_.ack_given(mark.receiver, net, seen.place.time_us);
    }
  }

  // A message of the node's own.
  void own_message(std::uint16_t node, const Observation& seen, const Net& net,
                   machine::Link link, machine::Address own) {
    acks_.showed_life(node, seen.place.time_us);
    originals_.sent(node, seen, net, link, own);
    if (net.is_ack()) acks_.sent(node, seen, net);
    if (net.sound && net.trans_id == component::kSynChannel) synaptic_.sent(node, seen, net);
  }

  void mote_hears(std::uint16_t mote, const Observation& seen, const Mark& mark, const Net& net) {
    const std::uint16_t am = who_.devices[mote].am;
    const std::optional<machine::Address> own = motes_.address(mote);
    // Its island is not known for sure: then anything for its devid may be for it.
    const machine::Address presumed = own.value_or(machine::Address{net.dest.pid, am});
    hears(mote, {Role::kMote, presumed, true, context_.sink_am}, machine::Link::kRadio, seen,
          mark.device, net, mark.receiver == mote);
  }

  void hears(std::uint16_t node, const machine::Router& router, machine::Link from,
             const Observation& seen, std::uint16_t sender, const Net& net, bool sure) {
    if (router.own.pid == 0) return;  // A sink of which no island is known.
    const machine::Route route = machine::route_received(router, from, net.dest, net.src);
    if (!route.deliver && route.onward != machine::Route::Onward::kNowhere) return;
    // Every island: taken or ignored, as a node likes (decision 114).
    const bool free = route.deliver || net.dest.pid == machine::kBroadcastPid;
    const ReqId forbidden = free ? ReqId::kNone : route.requirement;
    // Straight from a foreign mote: likewise (decision 116).
    // So is what a base station hands its sink for another island's (decision 126).
    const bool radio = from == machine::Link::kRadio;
    const bool straight = net.dest.pid != router.own.pid ||
                          (radio && net.src.pid != net.dest.pid && !is(sender, Role::kSink));
    acks_.arrived(node, seen, sender, net, {forbidden, forbidden == req::kN6Other, sure, straight});
  }

  // An ack counts at the originator of what it acks.
  void ack_comes(const Net& ack) {
    const std::int32_t acked = machine::acked_seq_num(ack.body());
    if (acked < 0) return;
    const auto seq_num = static_cast<std::uint16_t>(acked);
    context_.for_motes(ack.dest.devid,
              [&](std::uint16_t mote) { originals_.ack_heard(mote, ack, seq_num); });
    for (const std::uint16_t sink : context_.sinks) {
      const Device& device = who_.devices[sink];
      if (sinks_.island(sink) != ack.dest.pid) continue;
      if (ack.dest.devid == device.am) originals_.ack_heard(sink, ack, seq_num);
      if (ack.dest.devid == machine::kNullDevid && device.partner != kNobody) {
        originals_.ack_heard(device.partner, ack, seq_num);
      }
    }
  }

  void serial(std::uint32_t index, const Observation& seen, const Mark& mark) {
    const std::uint16_t sink = seen.to_mote ? who_.devices[mark.device].partner : mark.device;
    if (sink == kNobody) return;  // Of the sink nothing is known: a part of a run, say.
    if (const std::int32_t id = set_island_id(seen.frame); id >= 0 && seen.to_mote) {
      const auto island = static_cast<std::uint16_t>(id);
      sinks_.set_island(sink, island, seen.place);
      forwarding_.set_island(sink, island, seen.place.time_us);
      return;
    }
    if (!seen.to_mote) sinks_.showed_life(mark.device, seen.place.time_us, true);
    Net net;
    if (seen.frame.type != am::kNet || !parse_net(seen.frame.payload, net)) return;
    if (seen.to_mote) {
      down_serial(index, seen, mark, sink, net);
    } else {
      up_serial(seen, sink, net);
    }
    if (net.is_ack()) ack_comes(net);
  }

  void up_serial(const Observation& seen, std::uint16_t sink, const Net& net) {
    const Device& device = who_.devices[sink];
    SerialJoined joined;
    if (parse_serial_joined(net, joined)) {
      sinks_.report(sink, seen, net, joined);
      return base_station_hears(sink, seen, net);
    }
    acks_.showed_life(sink, seen.place.time_us);
    const std::uint16_t island = sinks_.island(sink);
    if (net.src == machine::Address{island, device.am}) {
      own_message(sink, seen, net, machine::Link::kSerial, net.src);
    } else {
      forwarding_.sent_on_serial(sink, seen, net);
    }
    base_station_hears(sink, seen, net);
  }

  void base_station_hears(std::uint16_t sink, const Observation& seen, const Net& net) {
    const std::uint16_t base = who_.devices[sink].partner;
    if (base == kNobody) return;
    hears(base,
          {Role::kBaseStation, {sinks_.island(sink), machine::kNullDevid}, true, context_.sink_am},
          machine::Link::kSerial, seen, sink, net, false);
  }

  void down_serial(std::uint32_t index, const Observation& seen, const Mark& mark,
                   std::uint16_t sink, const Net& net) {
    const std::uint16_t island = sinks_.island(sink);
    const machine::Address base{island, machine::kNullDevid};
    if (net.src == base) own_message(mark.device, seen, net, machine::Link::kSerial, base);
    const bool sure = serial_acked(run_, index) || mark.receiver == sink;
    forwarding_.heard_on_serial(sink, mark.device, seen, net, sure);
    const std::uint16_t am = who_.devices[sink].am;
    if (net.dest.devid != am && net.dest.devid != machine::kBroadcastDevid) return;
    hears(sink, {Role::kSink, {island, am}, true, context_.sink_am}, machine::Link::kSerial, seen,
          mark.device, net, sure);
  }

  void called(const Observation& seen, std::uint16_t device) {
    if (const auto* join = std::get_if<machine::JoinIsland>(seen.call)) {
      if (is(device, Role::kMote)) motes_.called(device, seen, *join);
      return;
    }
    const Device& d = who_.devices[device];
    const machine::Address sinks_own{sinks_.island(device), d.am};
    const machine::Address motes_own = motes_.address(device).value_or(machine::Address{0, d.am});
    synaptic_.called(device, seen, d.role == Role::kSink ? sinks_own : motes_own);
  }

  void told(const Observation& seen, std::uint16_t device) {
    if (const auto* joined = std::get_if<machine::Joined>(seen.notice)) {
      if (is(device, Role::kMote)) motes_.told(device, seen, *joined);
    } else if (const auto* mote_joined = std::get_if<machine::MoteJoined>(seen.notice)) {
      if (is(device, Role::kSink)) sinks_.told(device, seen, *mote_joined);
    } else if (const auto* received = std::get_if<machine::Received>(seen.notice)) {
      acks_.delivered(device, seen, *received);
    } else if (const auto* ack = std::get_if<machine::AckReceived>(seen.notice)) {
      originals_.told(device, seen, *ack);
    }
  }

  const Run& run_;
  Identity who_;
  Findings findings_;
  Context context_;
  MoteJoins motes_;
  SinkJoins sinks_;
  Forwarding forwarding_;
  Originals originals_;
  Acks acks_;
  SynapticWatch synaptic_;
  std::uint64_t frames_ = 0;
};

}  // namespace

Report judge(const Run& run, const Options& options) { return Judge(run, options).judge(); }

}  // namespace rubric::oracle
