// The serial line: framing, timing, confirmation.
#include "conformance/selftest/lawful_traffic/serial_line.h"

#include <algorithm>
#include <cassert>

#include "codec/generated/tinyos/all.h"
#include "codec/runtime/crc16.h"
#include "conformance/selftest/lawful_traffic/node.h"
#include "conformance/selftest/lawful_traffic/world.h"

namespace rubric::lawful {
namespace {

constexpr std::int64_t kByteUs = 87;  // 115200 baud, ten bits a byte.
constexpr std::int64_t kHostTimeoutUs = 1'000'000;
constexpr int kHostTries = 25;

void append_crc(Octets& record) {
  const std::uint16_t sum = crc16(view(record));
  record.push_back(static_cast<std::uint8_t>(sum & 0xFF));
  record.push_back(static_cast<std::uint8_t>(sum >> 8));
}

Octets am_packet(std::uint16_t dest, std::uint8_t type, const Octets& payload) {
  constexpr std::size_t kHeaderBytes = 8;
  Octets out(kHeaderBytes + payload.size());
  tinyos::AmHeader header;
  header.dispatch = tinyos::Dispatch::kActiveMessage;
  header.dest = dest;
  header.length = static_cast<std::uint8_t>(payload.size());
  header.type = type;
  const auto written = tinyos::write(header, MutableBytes(out.data(), kHeaderBytes));
  assert(written);
  (void)written;
  std::copy(payload.begin(), payload.end(), out.begin() + kHeaderBytes);
  return out;
}

Octets content(tinyos::SerialKind kind, int serial_seq, const Octets& packet) {
  Octets out{static_cast<std::uint8_t>(kind)};
  if (serial_seq >= 0) out.push_back(static_cast<std::uint8_t>(serial_seq));
  out.insert(out.end(), packet.begin(), packet.end());
  append_crc(out);
  return out;
}

}  // namespace

SerialLine::SerialLine(World& world, int number)
    : world_(world),
      interface_("serial:" + std::to_string(number)),
      next_serial_seq_(world.random().chance(50) ? 14 : 0) {}

std::int64_t SerialLine::reserve(std::int64_t& busy_until_us, std::size_t content_bytes) const {
  const auto size = static_cast<std::int64_t>(content_bytes + 2);  // Two flags.
  busy_until_us = std::max(busy_until_us, world_.now_us()) + size * kByteUs;
  return busy_until_us;
}

void SerialLine::to_host(std::uint8_t am_type, const Octets& payload) {
  const Octets record =
      content(tinyos::SerialKind::kPacketNoack, -1, am_packet(kAllNodes, am_type, payload));
  const std::int64_t end_us = reserve(out_busy_until_us_, record.size());
  world_.capture_serial(end_us, interface_, Direction::kOutbound, record);
  world_.scheduler().at(end_us,
                        [this, am_type, payload] { host_->serial_heard(am_type, payload); });
}

void SerialLine::to_mote(std::uint8_t am_type, const Octets& payload) {
  to_mote_.push_back({am_type, payload});
  send_next();
}

void SerialLine::send_next() {
  if (host_sending_ || to_mote_.empty()) return;
  host_sending_ = true;
  Outgoing& first = to_mote_.front();
  ++first.tries;
  const int turn = ++turn_;
  const std::uint8_t seq = next_serial_seq_++;
  Octets record = content(tinyos::SerialKind::kPacketAck, seq,
                          am_packet(world_.traits().serial_am_dest, first.am_type, first.payload));
  const std::int64_t end_us = reserve(in_busy_until_us_, record.size());
  const bool corrupt = world_.random().chance(world_.plan().serial_corrupt_percent);
  if (corrupt) record[record.size() / 2] ^= 0x10;
  world_.capture_serial(end_us, interface_, Direction::kInbound, record);
  if (!corrupt) {
    world_.scheduler().at(end_us, [this, type = first.am_type, payload = first.payload, seq, turn] {
      mote_got(type, payload, seq, turn);
    });
  }
  world_.scheduler().at(end_us + kHostTimeoutUs, [this, turn] {
    if (turn != turn_ || !host_sending_) return;
    host_sending_ = false;
    if (to_mote_.front().tries >= kHostTries) to_mote_.pop_front();
    send_next();
  });
}

void SerialLine::mote_got(std::uint8_t am_type, const Octets& payload, std::uint8_t serial_seq,
                          int turn) {
  if (!sink_->powered()) return;
  Octets record = content(tinyos::SerialKind::kAck, serial_seq, {});
  const std::int64_t end_us = reserve(out_busy_until_us_, record.size());
  const bool corrupt = world_.random().chance(world_.plan().serial_ack_corrupt_percent);
  if (corrupt) record.back() ^= 0x10;
  world_.capture_serial(end_us, interface_, Direction::kOutbound, record);
  if (!corrupt) world_.scheduler().at(end_us, [this, turn] { host_confirmed(turn); });
  sink_->serial_heard(am_type, payload);
}

void SerialLine::host_confirmed(int turn) {
  if (turn != turn_ || !host_sending_) return;
  to_mote_.pop_front();
  host_sending_ = false;
  send_next();
}

}  // namespace rubric::lawful
