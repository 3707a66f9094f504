// Packets taken apart.
#include "conformance/selftest/lawful_traffic/tests/seen.h"

#include <algorithm>
#include <set>

#include "codec/containers/link_record.h"
#include "codec/runtime/crc16.h"
#include "codec/runtime/ieee802154_fcs.h"

namespace rubric::lawful {
namespace {

void see_radio(const Octets& record, Seen& out) {
  const std::size_t size = record.size() - 2;
  out.radio = true;
  out.sum_ok = fcs(view(record).first(size)) == load_le16(record.data() + size);
  out.dsn = record[2];
  out.link_ack = size == 3;
  if (out.link_ack || size < 11) return;
  out.am_dst = load_le16(record.data() + 5);
  out.am_src = load_le16(record.data() + 7);
  out.am_type = record[10];
  out.payload.assign(record.begin() + 11, record.begin() + static_cast<std::ptrdiff_t>(size));
}

void see_serial(const Octets& record, Seen& out) {
  const std::size_t size = record.size() - 2;
  out.sum_ok = crc16(view(record).first(size)) == load_le16(record.data() + size);
  out.link_ack = record[0] == 0x43;
  const bool numbered = record[0] != 0x45;
  if (numbered) out.dsn = record[1];
  if (out.link_ack) return;
  const std::uint8_t* am = record.data() + (numbered ? 2 : 1);
  out.am_dst = load_be16(am + 1);
  out.am_src = load_be16(am + 3);
  out.am_type = am[7];
  out.payload.assign(am + 8, record.data() + size);
}

}  // namespace

std::uint16_t Seen::join_seq() const {
  const std::size_t offset = is(rubicon::AmType::kJoin) ? 0 : 8;
  return load_be16(payload.data() + offset);
}

int Seen::body_type() const {
  if (!app(rubicon::Component::kConnless) || net->payload.size() < 3) return -1;
  return net->payload[2];
}

std::uint16_t Seen::acked() const {
  const std::uint8_t* body = net->payload.data() + 2;
  return net->payload.size() >= 6 ? load_be16(body + 1) : load_be16(body);
}

Frames see(const Traffic& traffic) {
  Frames out;
  for (const LawfulPacket& packet : traffic.packets) {
    Seen seen;
    seen.time_us = packet.time_us;
    seen.interface = packet.interface;
    seen.inbound = packet.direction == Direction::kInbound;
    if (packet.link_type == kLinkRadioFcs) {
      see_radio(packet.record, seen);
    } else {
      see_serial(packet.record, seen);
    }
    if (seen.sum_ok && seen.is(rubicon::AmType::kNet)) seen.net = decode_net(view(seen.payload));
    out.push_back(std::move(seen));
  }
  return out;
}

Frames pick(const Frames& frames, const Pick& wanted) {
  Frames out;
  std::copy_if(frames.begin(), frames.end(), std::back_inserter(out), wanted);
  return out;
}

std::size_t count(const Frames& frames, const Pick& wanted) { return pick(frames, wanted).size(); }

Frames requests(const Frames& frames, std::uint16_t mote) {
  return pick(frames, [&](const Seen& s) { return s.from(rubicon::AmType::kJoin, mote); });
}

Frames replies(const Frames& frames, std::uint16_t mote) {
  return pick(frames, [&](const Seen& s) {
    return s.from(rubicon::AmType::kJoinReply, kSinkAm) && s.am_dst == mote;
  });
}

Frames ack_joins(const Frames& frames, std::uint16_t mote) {
  return pick(frames, [&](const Seen& s) { return s.from(rubicon::AmType::kAckJoin, mote); });
}

std::size_t distinct_seqs(const Frames& joins) {
  std::set<std::uint16_t> seqs;
  for (const Seen& join : joins) seqs.insert(join.join_seq());
  return seqs.size();
}

std::vector<std::int64_t> gaps(const Frames& frames) {
  std::vector<std::int64_t> out;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    out.push_back(frames[i].time_us - frames[i - 1].time_us);
  }
  return out;
}

std::vector<AppEvent> events(const Traffic& traffic, int node, const std::string& name,
                             const std::string& part) {
  std::vector<AppEvent> out;
  for (const AppEvent& event : traffic.events) {
    if (event.node != node || event.name != name) continue;
    if (event.fields.find(part) != std::string::npos) out.push_back(event);
  }
  return out;
}

}  // namespace rubric::lawful
