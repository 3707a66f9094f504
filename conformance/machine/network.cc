// The network level and the message dispatcher: net_msg from the application and from the lines.
#include <algorithm>

#include "codec/generated/rubicon/net_msg.h"
#include "codec/generated/rubicon/rubicon_ack.h"
#include "codec/generated/rubicon/rubicon_ack_seq_only.h"
#include "codec/generated/rubicon/serial_joined.h"
#include "conformance/machine/lines.h"
#include "conformance/machine/messages.h"
#include "conformance/machine/synaptic.h"
#include "conformance/machine/transport.h"

namespace rubric::machine {
namespace {

constexpr std::size_t kNetHeaderBytes = rubicon::NetMsgLayout::PayloadAt::kAt;
constexpr std::size_t kAppHeaderBytes = rubicon::AppMsgLayout::PayloadAt::kAt;

Link link_of(Route::Onward onward) {
  switch (onward) {
    case Route::Onward::kSerial: return Link::kSerial;
    case Route::Onward::kPeis: return Link::kPeis;
    case Route::Onward::kRadio:
    case Route::Onward::kNowhere: break;
  }
  return Link::kRadio;
}

void end_net_msg(const Place& place, Link link, std::size_t size_bytes) {
  //= N11-WHOLE: A net_msg on the serial line has all 114 bytes of a message, whatever its nbytes.
  if (link == Link::kSerial) {
    std::fill(place.payload + size_bytes, place.payload + kAmPayloadMax, std::uint8_t{0});
    size_bytes = kAmPayloadMax;
  }
  *place.size_bytes = static_cast<std::uint8_t>(size_bytes);
}

struct NetHeader {
  Address dest;
  Address src;
  bool reliable = false;
  std::uint16_t seq_num = 0;
};

void fill_net_msg(const Place& place, Link link, const NetHeader& header, std::uint8_t trans_id,
                  std::uint8_t app_id, Bytes data) {
  const std::size_t nbytes = kAppHeaderBytes + data.size();
  std::uint8_t* const p = place.payload;
  rubicon::NetMsg wire;
  wire.dest = wire_of(header.dest);
  wire.src = wire_of(header.src);
  wire.reliable = header.reliable ? 1 : 0;
  wire.seq_num = header.seq_num;
  //= T1-WRAP: The payload of a net_msg begins with TRANSID CONNLESS and the APPID of the sender for
  //= what Connectionless.send was given.
  std::uint8_t* const body = p + kNetHeaderBytes;
  rubicon::AppMsg app;
  app.trans_id = static_cast<rubicon::Component>(trans_id);
  app.app_id = static_cast<rubicon::Component>(app_id);
  app.payload = data;
  rubicon::AppMsgLayout::store(app, body);
  wire.payload = {body, nbytes};
  rubicon::NetMsgLayout::store(wire, p);
  end_net_msg(place, link, kNetHeaderBytes + nbytes);
}

void forward(Node& node, const Route& route, rubicon::NetMsgView message) {
  const Link link = link_of(route.onward);
  const Place place = put(node, {link, am::kNet, route.am_dest, route.requirement, false});
  if (!place) return;
  //= N6-CONTENT: What a sink forwards keeps addresses, reliable, sequence number and payload; on
  //= the serial line only nbytes and the bytes after the payload may differ.
  //= N7-CONTENT: What a sink sends on by radio keeps addresses, reliable, sequence number, nbytes
  //= and payload, and no byte after the payload.
  //= N8-INCOMING: A base station hands a message from PEIS for a mote of its island to its sink
  //= with addresses, reliable, sequence number and payload kept.
  const Bytes bytes = message.bytes();
  std::copy_n(bytes.data(), bytes.size(), place.payload);
  end_net_msg(place, link, bytes.size());
}

void send_ack(Node& node, Address to, std::uint8_t app_id, std::uint16_t seq_num) {
  std::uint8_t body[rubicon::RubiconAckView::kMaxSizeBytes];
  std::size_t size_bytes = rubicon::RubiconAckSeqOnlyView::kMaxSizeBytes;
  if (node.profile().short_acks) {
    rubicon::RubiconAckSeqOnlyLayout::SeqNumAt::store(body, seq_num);
  } else {
    rubicon::RubiconAck ack;
    ack.type = rubicon::AmType::kLearningNotification;
    ack.seq_num = seq_num;
    rubicon::RubiconAckLayout::store(ack, body);
    size_bytes = sizeof body;
  }
  //= T2-CONTENT: An ack has TRANSID RUBICON_ACK, the APPID and the sequence number of a message to
  //= the node itself, is unreliable, and goes to the message's source.
  ReqId refused = ReqId::kNone;
  send_own(node, {to, component::kRubiconAck, app_id, false, {body, size_bytes}, "T2-ACK"_rule},
           refused);
  if (refused != ReqId::kNone) node.actions.ignored(refused);
}

void hear_connless(Node& node, rubicon::NetMsgView message, std::uint8_t app_id, Bytes data) {
  Actions& actions = node.actions;
  //= T1-UNKNOWN: A message with an unknown TRANSID or APPID is dropped without harm.
  if (!is_known_app(app_id)) return actions.ignored("T1-UNKNOWN"_rule);
  const Address src = address_of(message.src());
  const Address dest = address_of(message.dest());
  const bool reliable = message.reliable() != 0;
  actions.notify(Received{src, app_id, data}, reliable ? "T2-DELIVER"_rule : "T1-DELIVER"_rule);
  if (!reliable) return actions.followed("T2-UNRELIABLE"_rule);
  if (!must_ack(reliable, dest, component::kConnless, app_id)) {
    return actions.followed("T2-BROADCAST"_rule);
  }
  //= T2-ACK: A reliable Connectionless message to the node itself, with an APPID that it knows, is
  //= answered by an ack.
  // A message for another island's sink, which is delivered by its devid, gets no ack (decision
  // 126).
  if (dest != own_address(node.state)) return actions.followed("T2-ACK"_rule);
  //= T2-ONCE: A reliable message is answered by one ack for each time that it is received.
  //= T2-PROMPT: An ack comes before the sender's timeout.
  send_ack(node, src, app_id, message.seq_num());
}

// Delivers by the message dispatcher.
void deliver(Node& node, rubicon::NetMsgView message) {
  const Bytes payload = message.payload();
  using App = rubicon::AppMsgLayout;
  const auto trans_id = static_cast<std::uint8_t>(App::TransIdAt::load(payload.data()));
  const auto app_id = static_cast<std::uint8_t>(App::AppIdAt::load(payload.data()));
  const Bytes body = payload.from(kAppHeaderBytes);
  switch (trans_id) {
    case component::kConnless: return hear_connless(node, message, app_id, body);
    case component::kRubiconAck: {
      const std::int32_t acked = acked_seq_num(body);
      if (acked < 0) return node.actions.ignored("WIRE-RUBICON-ACK"_rule);
      hear_ack(node.state.awaited, address_of(message.src()), app_id,
               static_cast<std::uint16_t>(acked), node.actions);
      if (message.reliable() != 0) node.actions.followed("T2-LOOP"_rule);
      return;
    }
    case component::kSynChannel:
      if (node.config().role == Role::kBaseStation) break;  // It has no channels.
      return hear_synaptic(node.state.synaptic, own_address(node.state), address_of(message.src()),
                           body, node.actions);
    default: break;
  }
  node.actions.ignored("T1-UNKNOWN"_rule);
}

// Makes room for a message that asks for an ack; without a timeout the oldest is given up.
bool can_await(AwaitedList& list, const Profile& profile) {
  if (!list.full()) return true;
  if (profile.ack_timeout_ticks != 0) return false;
  list.erase(0);
  return true;
}

}  // namespace

std::uint16_t send_own(Node& node, const OwnMessage& message, ReqId& refused) {
  State& state = node.state;
  const Router router = router_of(state);
  Address dest = message.dest;
  //= N3-LOCAL: dest.pid 0xFFFE (local island) is replaced by the sender's own island before the
  //= message is sent.
  const bool local = dest.pid == kLocalPid;
  if (local) dest.pid = router.own.pid;
  const Route route = route_own(router, dest);
  const Link link = link_of(route.onward);
  //= N1-ROOM: send accepts a message of a member while the outgoing buffer has room, unless the
  //= interface is off or as many acks are awaited as the node has room for.
  refused = route.onward == Route::Onward::kNowhere ? route.requirement : line_refusal(state, link);
  // A message can ask for an ack only if there is a place to remember that it is awaited.
  if (refused == ReqId::kNone && message.reliable && !can_await(state.awaited, node.profile())) {
    refused = "N1-FULL"_rule;
  }
  if (refused != ReqId::kNone) return kNoSeq;
  if (local) node.actions.followed("N3-LOCAL"_rule);
  const std::uint16_t seq_num = next_seq_num(state.sequence, state.awaited);
  const bool plain = message.requirement == ReqId::kNone;
  const ReqId requirement = plain ? route.requirement : message.requirement;
  if (message.reliable) await_ack(state.awaited, seq_num, message.app_id, dest);
  const std::uint16_t awaited = message.reliable ? seq_num : kNoSeq;
  const Place place = put(node, {link, am::kNet, route.am_dest, requirement, false, awaited});
  //= N1-SRC: What a node sends on behalf of its applications carries the node's own address as src;
  //= a base station's src is <its island, NULL>.
  fill_net_msg(place, link, {dest, router.own, message.reliable, seq_num}, message.trans_id,
               message.app_id, message.data);
  return seq_num;
}

void hear_net_msg(Node& node, Link from, Bytes bytes) {
  const Router router = router_of(node.state);
  // J11-HEAR: a node without an address ignores them.
  if (!router.member) return node.actions.ignored("J11-HEAR"_rule);
  const auto message = rubicon::NetMsgView::parse(bytes);
  if (!message) {
    //= N11-NBYTES: A net_msg whose nbytes is over 102, under 2, or more than arrived is dropped: no
    //= delivery, no ack, no forward.
    //= T2-TWO: A message whose reliable is neither 0 nor 1 is not acked.
    //= N11-NEXT: After a malformed message the next good one is handled as always.
    const ReqId rule = message.error().requirement;
    return node.actions.ignored(rule == "WIRE-NET-RELIABLE"_rule ? rule : "N11-NBYTES"_rule);
  }
  //= N11-SHORT: A net_msg on the serial line that ends after its nbytes is handled like one of 114
  //= bytes.
  const Route route =
      route_received(router, from, address_of(message->dest()), address_of(message->src()));
  const bool nowhere = route.onward == Route::Onward::kNowhere;
  if (!nowhere) forward(node, route, *message);
  if (route.deliver) {
    node.actions.followed(route.delivered);
    deliver(node, *message);
  }
  if (nowhere && (!route.deliver || route.requirement != ReqId::kNone)) {
    node.actions.ignored(route.requirement);
  }
}

void report_joined(Node& node, const Admission& member) {
  State& state = node.state;
  //= J6-REPORT: A sink reports each new member to its base station with one serial_joined.
  // Nothing would repeat it, so it must not be lost if there is no room.
  if (line_refusal(state, Link::kSerial) != ReqId::kNone) {
    auto& owed = state.sink.unreported;
    if (owed.full()) owed.erase(0);  // Some mote joined again and again; its last report stays.
    owed.push(member);
    return node.actions.followed("J6-REPORT"_rule);
  }
  const Place place = put(node, {Link::kSerial, am::kNet, kAmBroadcast, "J6-REPORT"_rule, false});
  const Address address{state.island, member.devid};
  const rubicon::MoteDesc wire = wire_of(member.descriptor);
  rubicon::SerialJoined joined;
  joined.msg_type = rubicon::AmType::kSerialJoined;
  joined.island_addr = address.pid;
  joined.mote_addr = address.devid;
  joined.mote_type = wire.mote_type;
  joined.transducers = wire.transducers;
  joined.actuators = wire.actuators;
  std::uint8_t body[rubicon::SerialJoinedView::kMaxSizeBytes];
  rubicon::SerialJoinedLayout::store(joined, body);
  //= J6-CONTENT: serial_joined carries the member's address and descriptor in an unreliable net_msg
  //= from <island, mote> to <island, NULL>, TRANSID CONNLESS, APPID CONTROL_LAYER.
  fill_net_msg(place, Link::kSerial, {{address.pid, kNullDevid}, address, false, 0},
               component::kConnless, component::kControlLayer, body);
}

void report_owed(Node& node) {
  auto& owed = node.state.sink.unreported;
  while (!owed.empty() && line_refusal(node.state, Link::kSerial) == ReqId::kNone) {
    const Admission member = owed[0];
    owed.erase(0);
    report_joined(node, member);
  }
}

void tick(Node& node) {
  State& state = node.state;
  SynapticSends sends;
  // A send has two labels at most (N3-LOCAL, and sent or queued), a signal one.
  static_assert(3 * kChannelsRoom <= Actions::kActionsMax);
  static_assert(kChannelsRoom <= Actions::kNoticesMax);
  tick_synaptic(state.synaptic, own_address(state), node.now, sends, node.actions);
  for (const SynapticSend& send : sends) {
    //= S2-CONTENT: Synaptic data has TRANSID SYN_CHANNEL, APPID LEARNING or ESN_DATA, and one
    //= little-endian binary32 for each connection, in order, unreliable.
    using Values = rubicon::SynapticDataLayout::ValuesAt;
    std::uint8_t floats[Values::kUnitBytes * kConnectionsMax];
    for (std::size_t i = 0; i < send.size; ++i) {
      Values::store(floats, i, float_of_bits(send.value_bits[i]));
    }
    const Bytes data(floats, Values::kUnitBytes * send.size);
    ReqId refused = ReqId::kNone;
    send_own(
        node,
        {send.dest, component::kSynChannel, component::kEsnData, false, data, send.requirement},
        refused);
    if (refused == ReqId::kNone) continue;
    node.actions.ignored(refused);
    keep_change(state.synaptic, send.id);
  }
}

void set_island(Node& node, std::uint16_t island) {
  State& state = node.state;
  const bool changes = island != state.island;
  //= N9-SET: A config message SET_ISLAND_ID over serial sets the sink's island id, and a base
  //= station sends it when its own is set; from then on both use the new id.
  state.island = island;
  node.actions.followed("N9-SET"_rule);
  if (changes) state.present.clear();
  if (!changes || node.config().role != Role::kSink) return;
  //= N9-MEMBERS: A sink whose island id changes forgets its members.
  state.sink.members.clear();
  state.sink.pending.clear();
  state.sink.unreported.clear();
  forget_waiting(state, am::kJoinReply);  // They offer the island that is no more.
  node.actions.followed("N9-MEMBERS"_rule);
}

}  // namespace rubric::machine
