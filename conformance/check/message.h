// The messages of the protocol as plain values, read without judging them.
#pragma once

#include <algorithm>
#include <cstdint>

#include "codec/generated/rubicon/ack_join.h"
#include "codec/generated/rubicon/config.h"
#include "codec/generated/rubicon/join_reply.h"
#include "codec/generated/rubicon/join_request.h"
#include "codec/generated/rubicon/net_msg.h"
#include "codec/generated/rubicon/serial_joined.h"
#include "conformance/machine/address.h"
#include "conformance/machine/event.h"
#include "conformance/machine/messages.h"

namespace rubric::check {

namespace am = machine::am;
namespace component = machine::component;

using NetAt = rubicon::NetMsgLayout;
constexpr std::size_t kNetHeaderBytes = NetAt::PayloadAt::kAt;

/// A net_msg. It is `sound` (N11) if nbytes is in its range and no more than the bytes that came.
struct Net {
  machine::Address dest;
  machine::Address src;
  std::uint8_t reliable = 0;
  std::uint8_t nbytes = 0;
  std::uint16_t seq_num = 0;
  bool sound = false;
  std::uint8_t trans_id = 0;  ///< Valid if sound.
  std::uint8_t app_id = 0;
  Bytes payload;  ///< nbytes of it where sound, else what came.
  Bytes body() const { return payload.from(rubicon::AppMsgLayout::PayloadAt::kAt); }

  bool is_ack() const { return sound && trans_id == component::kRubiconAck; }
  bool broadcast() const {
    return dest.pid == machine::kBroadcastPid || dest.devid == machine::kBroadcastDevid;
  }
  /// Returns whether its APPID is one that each node knows. What a node does with messages for
  /// another component is its own (T1-UNKNOWN).
  bool for_known_app() const {
    using rubicon::Component;
    const auto app = static_cast<Component>(app_id);
    return app == Component::kMockup || app == Component::kLearning ||
           app == Component::kControlLayer;
  }
  /// Returns both addresses, which with the number identify a message.
  std::uint64_t addresses() const {
    return std::uint64_t{dest.pid} << 48 | std::uint64_t{dest.devid} << 32 |
           std::uint64_t{src.pid} << 16 | src.devid;
  }
};

template <class Field>
machine::Address address_at(const std::uint8_t* structure) {
  using Address = rubicon::RAddrLayout;
  return {static_cast<std::uint16_t>(Within<Field, Address::PidAt>::load(structure)),
          static_cast<std::uint16_t>(Within<Field, Address::DevidAt>::load(structure))};
}

/// Reads a net_msg. Returns false if it is shorter than a header. Unlike the view of a net_msg it
/// reads a header that breaks a rule: its sender is judged, and others may have taken it.
inline bool parse_net(Bytes bytes, Net& out) {
  using App = rubicon::AppMsgLayout;
  if (bytes.size() < kNetHeaderBytes) return false;
  const std::uint8_t* const p = bytes.data();
  out.dest = address_at<NetAt::DestAt>(p);
  out.src = address_at<NetAt::SrcAt>(p);
  out.reliable = NetAt::ReliableAt::load(p);
  out.seq_num = NetAt::SeqNumAt::load(p);
  out.nbytes = NetAt::NbytesAt::load(p);
  out.payload = bytes.from(kNetHeaderBytes);
  out.sound = NetAt::NbytesAt::allows(out.nbytes) && out.nbytes <= out.payload.size();
  if (out.sound) {
    out.payload = out.payload.first(out.nbytes);
    out.trans_id = static_cast<std::uint8_t>(App::TransIdAt::load(out.payload.data()));
    out.app_id = static_cast<std::uint8_t>(App::AppIdAt::load(out.payload.data()));
  }
  return true;
}

/// Returns whether addresses, reliable, number and payload are the same.
inline bool same_message(const Net& a, const Net& b) {
  return a.seq_num == b.seq_num && a.addresses() == b.addresses() && a.reliable == b.reliable;
}
/// What comes after the nbytes of a malformed message, or is missing there, means nothing.
inline bool same_payload(const Net& a, const Net& b) {
  if (a.nbytes != b.nbytes || a.sound != b.sound) return false;
  const std::size_t n = std::min({std::size_t{a.nbytes}, a.payload.size(), b.payload.size()});
  return equal(a.payload.first(n), b.payload.first(n));
}

/// Returns whether each node has a transport of this TRANSID. A message with another one is dropped
/// (T1-UNKNOWN).
inline bool known_trans(std::uint8_t trans_id) {
  return trans_id == component::kConnless || trans_id == component::kSynChannel ||
         trans_id == component::kRubiconAck;
}

/// Returns whether the message's TRANSID or APPID is none that exists.
inline bool is_nobodys(const Net& net) {
  const auto unknown = [](std::uint8_t id) {
    return id < component::kSynChannel || id > component::kEsnData;
  };
  return unknown(net.trans_id) || unknown(net.app_id);
}

/// Returns whether both are the same message of one sender on one link, whatever follows its
/// content: an underlying buffer may be longer.
inline bool same_content(const machine::Frame& a, const machine::Frame& b) {
  if (a.src != b.src || a.type != b.type) return false;
  Net one;
  Net other;
  const bool sound = a.type == am::kNet && parse_net(a.payload, one) && one.sound &&
                     parse_net(b.payload, other) && other.sound;
  return sound ? same_message(one, other) && same_payload(one, other) : equal(a.payload, b.payload);
}

struct Request {
  std::uint16_t seq_num = 0;
  machine::Descriptor descriptor;
};
inline bool parse_request(Bytes bytes, Request& out) {
  const auto view = rubicon::JoinRequestView::parse(bytes);
  if (view) out = {view->seq_num(), machine::descriptor_of(view->mote_desc())};
  return view.has_value();
}

struct Reply {
  std::uint16_t island = 0;
  std::uint16_t mote = 0;
  std::uint32_t time_ms = 0;
  std::uint16_t seq_num = 0;
};
inline bool parse_reply(Bytes bytes, Reply& out) {
  const auto view = rubicon::JoinReplyView::parse(bytes);
  if (view) out = {view->island_addr(), view->mote_addr(), view->cur_time(), view->seq_num()};
  return view.has_value();
}

struct AckJoin {
  machine::Address dest;
  machine::Address src;
  std::uint16_t seq_num = 0;
  machine::Descriptor descriptor;
  friend bool operator==(const AckJoin&, const AckJoin&) = default;
};
inline bool parse_ack_join(Bytes bytes, AckJoin& out) {
  const auto view = rubicon::AckJoinView::parse(bytes);
  if (!view) return false;
  out = {machine::address_of(view->dest()), machine::address_of(view->src()), view->seq_num(),
         machine::descriptor_of(view->mote_desc())};
  return true;
}

/// serial_joined within a sound net_msg of CONNLESS, CONTROL_LAYER.
struct SerialJoined {
  machine::Address address;
  machine::Descriptor descriptor;
};
inline bool parse_serial_joined(const Net& net, SerialJoined& out) {
  constexpr auto kControl = static_cast<std::uint8_t>(rubicon::Component::kControlLayer);
  if (!net.sound || net.trans_id != component::kConnless || net.app_id != kControl) return false;
  const auto view = rubicon::SerialJoinedView::parse(net.body());
  if (!view || view->msg_type() != rubicon::AmType::kSerialJoined) return false;
  out.address = {view->island_addr(), view->mote_addr()};
  out.descriptor = {static_cast<std::uint8_t>(view->mote_type()), view->actuators().raw(),
                    view->transducers().raw()};
  return true;
}

/// Returns whether it is one. It has the address of the mote, and the number of the sink.
inline bool is_report(const Net& net) {
  SerialJoined joined;
  return parse_serial_joined(net, joined);
}

/// Returns the island id of a SET_ISLAND_ID config message; -1 for another message, or an id that
/// no sink can have.
inline std::int32_t set_island_id(const machine::Frame& frame) {
  if (frame.type != am::kConfig) return -1;
  const auto view = rubicon::ConfigView::parse(frame.payload);
  if (!view || view->type() != rubicon::CommandCode::kSetIslandId) return -1;
  const std::uint16_t island = view->value();
  return machine::is_reserved(island) ? -1 : island;
}

}  // namespace rubric::check
