// Runs made by hand, for tests: the frames of nodes one by one.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "codec/reflect/requirements.h"
#include "conformance/check/message.h"
#include "conformance/check/observation.h"
#include "conformance/check/storage.h"

namespace rubric::check {

using Payload = std::vector<std::uint8_t>;

constexpr machine::Descriptor kDescriptor{1, 1, 0x43};

inline void put16(Payload& out, std::uint32_t value) {
  out.push_back(static_cast<std::uint8_t>(value >> 8));
  out.push_back(static_cast<std::uint8_t>(value));
}
inline void put(Payload& out, machine::Address address) {
  put16(out, address.pid);
  put16(out, address.devid);
}
inline void put(Payload& out, const machine::Descriptor& descriptor) {
  out.push_back(descriptor.mote_type);
  put16(out, descriptor.transducers);
  out.push_back(descriptor.actuators);
}

/// A net_msg to be; tests change the fields that must be wrong.
struct NetFields {
  machine::Address dest;
  machine::Address src;
  std::uint8_t reliable = 0;
  std::uint16_t seq_num = 0;
  Payload body = Payload(2, 7);
  std::uint8_t trans_id = component::kConnless;
  std::uint8_t app_id = 5;
  int nbytes = -1;       ///< -1: as it must be.
  std::size_t size = 0;  ///< Whole size, filled with zeros; 0: as needed.

  Payload bytes() const {
    Payload out;
    put(out, dest);
    put(out, src);
    out.push_back(reliable);
    put16(out, seq_num);
    const std::size_t stated = nbytes < 0 ? body.size() + 2 : static_cast<std::size_t>(nbytes);
    out.push_back(static_cast<std::uint8_t>(stated));
    out.push_back(trans_id);
    out.push_back(app_id);
    out.insert(out.end(), body.begin(), body.end());
    if (out.size() < size) out.resize(size);
    return out;
  }
  /// Returns the message as a sink puts it on its serial line.
  NetFields forwarded() const {
    NetFields out = *this;
    out.nbytes = 102;
    out.size = 114;
    return out;
  }
  /// Returns its ack.
  NetFields ack(std::uint16_t own_seq_num) const {
    return {.dest = src,
            .src = dest,
            .seq_num = own_seq_num,
            .body = {23, static_cast<std::uint8_t>(seq_num >> 8),
                     static_cast<std::uint8_t>(seq_num), 0},
            .trans_id = component::kRubiconAck,
            .app_id = app_id};
  }
};

inline NetFields message(machine::Address src, machine::Address dest, std::uint16_t seq_num,
                         std::uint8_t reliable = 0) {
  return {.dest = dest, .src = src, .reliable = reliable, .seq_num = seq_num};
}
/// From a mote of island 11 to its PC.
inline NetFields update(std::uint16_t mote, std::uint16_t seq_num) {
  return message({11, mote}, {11, machine::kNullDevid}, seq_num);
}

/// Frames one after the other; times in ms.
class Script {
 public:
  Script() {
    run.storage = std::make_shared<RunStorage>();
    run.files = {"script"};
    run.taps = {{"radio", machine::Link::kRadio, false},
                {"serial:1", machine::Link::kSerial, true},
                {"serial:2", machine::Link::kSerial, true}};
  }

  Script& radio(double ms, std::uint16_t src, std::uint16_t dest, std::uint8_t type,
                const Payload& payload, std::uint16_t island = 0, bool ack_request = false) {
    Observation seen = at(ms);
    seen.kind = Observation::Kind::kRadio;
    seen.has_dsn = true;
    seen.dsn = dsn[island * 65536U + src]++;
    seen.ack_request = ack_request;
    seen.frame = {machine::Link::kRadio, dest, src, type,
                  run.storage->keep(Bytes(payload.data(), payload.size()))};
    run.seen.push_back(seen);
    return *this;
  }
  Script& link_ack() {
    run.seen.back().ack_request = true;
    Observation seen = run.seen.back();
    seen.kind = Observation::Kind::kLinkAck;
    seen.place.time_us += 1700;
    ++seen.place.frame;
    run.seen.push_back(seen);
    return *this;
  }
  Script& serial(double ms, bool to_mote, std::uint8_t type, const Payload& payload,
                 std::uint32_t tap = 1) {
    Observation seen = at(ms);
    seen.kind = Observation::Kind::kSerial;
    seen.tap = tap;
    seen.to_mote = to_mote;
    seen.frame = {machine::Link::kSerial, 0xFFFF, 0, type,
                  run.storage->keep(Bytes(payload.data(), payload.size()))};
    run.seen.push_back(seen);
    return *this;
  }

  /// Makes the frame down a line that was added last a numbered packet, which the mote confirms.
  Script& confirm(bool captured = true) {
    run.seen.back().ack_request = run.seen.back().has_dsn = true;
    run.seen.back().dsn = serial_number++;
    if (!captured) return *this;
    Observation seen = run.seen.back();
    seen.kind = Observation::Kind::kLinkAck;
    seen.to_mote = false;
    seen.place.time_us += 2000;
    ++seen.place.frame;
    run.seen.push_back(seen);
    return *this;
  }

  Script& request(double ms, std::uint16_t mote, std::uint16_t seq_num,
                  const machine::Descriptor& descriptor = kDescriptor) {
    Payload out;
    put16(out, seq_num);
    put(out, descriptor);
    return radio(ms, mote, 1, am::kJoin, out, mote_key);
  }
  Script& reply(double ms, std::uint16_t island, std::uint16_t mote, std::uint16_t seq_num,
                std::uint32_t time_ms, std::uint16_t am_dest = 0) {
    Payload out;
    put16(out, island);
    put16(out, mote);
    put16(out, time_ms >> 16);
    put16(out, time_ms & 0xFFFF);
    put16(out, seq_num);
    return radio(ms, 1, am_dest == 0 ? mote : am_dest, am::kJoinReply, out, island);
  }
  Script& ack_join(double ms, std::uint16_t island, std::uint16_t mote, std::uint16_t seq_num,
                   const machine::Descriptor& descriptor = kDescriptor) {
    Payload out;
    put(out, machine::Address{island, 1});
    put(out, machine::Address{island, mote});
    put16(out, seq_num);
    put(out, descriptor);
    return radio(ms, mote, 1, am::kAckJoin, out, mote_key, true);
  }
  Script& joined(double ms, std::uint16_t island, std::uint16_t mote, std::uint32_t tap = 1,
                 const machine::Descriptor& descriptor = kDescriptor) {
    NetFields net{
        .dest = {island, machine::kNullDevid}, .src = {island, mote}, .body = {16}, .app_id = 10};
    put(net.body, machine::Address{island, mote});
    put(net.body, descriptor);
    return serial(ms, false, am::kNet, net.forwarded().bytes(), tap);
  }
  /// Adds a whole join: request, reply, ack_join, report.
  Script& join(double ms, std::uint16_t island, std::uint16_t mote, std::uint16_t seq_num,
               std::uint32_t tap = 1) {
    request(ms, mote, seq_num);
    reply(ms + 10, island, mote, seq_num, static_cast<std::uint32_t>(ms + 10));
    ack_join(ms + 20, island, mote, seq_num).link_ack();
    return joined(ms + 40, island, mote, tap);
  }
  Script& net(double ms, std::uint16_t src, std::uint16_t dest, const NetFields& fields,
              std::uint16_t island = 0) {
    return radio(ms, src, dest, am::kNet, fields.bytes(), island);
  }
  Script& up(double ms, const NetFields& fields, std::uint32_t tap = 1) {
    return serial(ms, false, am::kNet, fields.bytes(), tap);
  }
  Script& down(double ms, const NetFields& fields, std::uint32_t tap = 1) {
    return serial(ms, true, am::kNet, fields.bytes(), tap);
  }

  Run run;
  std::map<std::uint32_t, std::uint8_t> dsn;
  std::uint16_t mote_key = 0;
  std::uint8_t serial_number = 0;

 private:
  Observation at(double ms) {
    Observation seen;
    seen.place.frame = run.seen.size() + 1;
    seen.place.time_us = static_cast<std::int64_t>(ms * 1000);
    run.end_us = seen.place.time_us;
    return seen;
  }
};

/// Returns the rules of all but notes, each with the letter of its severity: "F:N9-SET I:J5-STOP".
inline std::string found_in(const Script& script, const Options& options) {
  std::string out;
  for (const Finding& finding : judge(script.run, options).findings) {
    if (finding.severity == Severity::kNote) continue;
    const char* const id = reflect::requirement(finding.requirement).id;
    out += out.empty() ? "" : " ";
    out += "NWSIF"[static_cast<std::size_t>(finding.severity)];
    out += ":" + std::string(id);
  }
  return out;
}
inline std::string found_in(const Script& script, bool complete = true) {
  return found_in(script, {.sniffer_complete = complete, .start_cold = complete});
}

}  // namespace rubric::check
