#include "conformance/simulate/serial.h"

#include <algorithm>
#include <array>

#include "codec/reflect/am_frames.h"
#include "codec/runtime/hdlc.h"

namespace rubric::simulate {
namespace {

constexpr Micros kBaud = 115'200;
constexpr Micros kBitsPerByte = 10;
constexpr Micros kResendUs = 1'000'000;  // A host misses its confirmation.
constexpr int kTriesMax = 25;

// Returns how long the frame takes, flags and escapes included.
Micros shift_us(std::uint8_t kind, std::int32_t seq, Bytes packet) {
  std::array<std::uint8_t, hdlc_frame_room(kSerialAfterHeaderMax + 2)> room;
  HdlcFramer framer(MutableBytes(room.data(), room.size()));
  framer.open();
  framer.put(kind);
  if (seq >= 0) framer.put(static_cast<std::uint8_t>(seq));
  framer.put(packet);
  const Micros bits = static_cast<Micros>(*framer.close()) * kBitsPerByte;
  return (bits * kUsPerSecond + kBaud - 1) / kBaud;
}

}  // namespace

void Serial::send(NodeId from, const machine::Frame& frame) {
  auto held = std::make_shared<Held>();
  held->packet = reflect::serial_packet({.dest = frame.dest, .src = frame.src, .type = frame.type},
                                        frame.payload);
  held->am = frame;
  held->am.link = machine::Link::kSerial;
  held->am.payload = Bytes(held->packet.data(), held->packet.size()).from(reflect::kAmHeaderBytes);
  if (from == plan_.base_station) return try_host(held);
  shift_out(false, kSerialPacketNoAck, -1, held, [this, held](bool intact) {
    deliver(plan_.base_station, *held, intact);
    user_.serial_sent(plan_.sink);
  });
}

// Queues a frame after what this end is sending; calls `done` at its end. Returns when that is.
Micros Serial::shift_out(bool to_sink, std::uint8_t kind, std::int32_t seq, const Shared& held,
                         Done done) {
  End& end = to_sink ? base_station_ : sink_;
  const Bytes packet(held->packet.data(), held->packet.size());
  end.free_us = std::max(queue_.now(), end.free_us) + shift_us(kind, seq, packet);
  const std::uint64_t life = end.life;
  queue_.at(end.free_us, [=, this, &end, done = std::move(done)] {
    if (end.life != life) return;
    const Bytes bytes(held->packet.data(), held->packet.size());
    recorder_.on_serial(queue_.now(), index_, to_sink, {kind, seq, bytes});
    done(!random_.chance(plan_.loss));
  });
  return end.free_us;
}

void Serial::try_host(const Shared& held) {
  const std::uint8_t seq = next_seq_++;  // Each try takes the next number.
  base_station_.awaited = seq;
  ++held->tries;
  const Micros end_us = shift_out(true, kSerialPacketAck, seq, held, [=, this](bool intact) {
    deliver(plan_.sink, *held, intact);
    if (intact && user_.serial_on(plan_.sink)) confirm(seq);
  });
  const std::uint64_t life = base_station_.life;
  queue_.at(end_us + kResendUs, [=, this] {
    if (base_station_.life != life || base_station_.awaited != seq) return;
    if (held->tries < kTriesMax) return try_host(held);
    base_station_.awaited.reset();
    user_.serial_sent(plan_.base_station);
  });
}

void Serial::confirm(std::uint8_t seq) {
  shift_out(false, kSerialAck, seq, std::make_shared<Held>(), [this, seq](bool intact) {
    if (!intact || base_station_.awaited != seq) return;
    base_station_.awaited.reset();
    user_.serial_sent(plan_.base_station);
  });
}

void Serial::deliver(NodeId to, const Held& held, bool intact) {
  const bool on = user_.serial_on(to);
  if (intact && on) return user_.serial_heard(to, held.am);
  recorder_.mishap(queue_.now(), to, on ? Mishap::kLost : Mishap::kUnheard, held.am);
}

}  // namespace rubric::simulate
