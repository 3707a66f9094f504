// The radio channel.
#include "conformance/selftest/lawful_traffic/air.h"

#include <cassert>
#include <utility>

#include "codec/generated/tinyos/all.h"
#include "codec/runtime/ieee802154_fcs.h"
#include "conformance/selftest/lawful_traffic/world.h"

namespace rubric::lawful {
namespace {

constexpr std::int64_t kTurnaroundUs = 192;
constexpr std::uint16_t kFcfData = 0x8841;
constexpr std::uint16_t kFcfDataAckRequest = 0x8861;
constexpr std::uint16_t kFcfAck = 0x0002;

void append_fcs(Octets& record) {
  const std::uint16_t sum = fcs(view(record));
  record.push_back(static_cast<std::uint8_t>(sum & 0xFF));
  record.push_back(static_cast<std::uint8_t>(sum >> 8));
}

}  // namespace

Octets radio_record(const RadioFrame& frame) {
  Octets out(9);
  tinyos::MacHeader header;
  header.fcf = frame.ack_request ? kFcfDataAckRequest : kFcfData;
  header.dsn = frame.dsn;
  header.destpan = kPan;
  header.dest = frame.dst;
  header.src = frame.src;
  const auto written = tinyos::write(header, MutableBytes(out.data(), out.size()));
  assert(written);
  (void)written;
  out.push_back(0x3F);
  out.push_back(frame.type);
  out.insert(out.end(), frame.payload.begin(), frame.payload.end());
  append_fcs(out);
  return out;
}

Octets link_ack_record(std::uint8_t dsn) {
  Octets out{kFcfAck & 0xFF, kFcfAck >> 8, dsn};
  append_fcs(out);
  return out;
}

std::int64_t airtime_us(std::size_t record_bytes) {
  // Preamble, start of frame and length byte are 6 bytes; a byte takes 32 microseconds.
  return static_cast<std::int64_t>(record_bytes + 6) * 32;
}

Device::Device(World& world, int number, std::uint16_t am, int island_index)
    : world_(world), number_(number), am_(am), island_index_(island_index) {}

void Device::power(bool on) {
  powered_ = on;
  ++power_cycle_;
  queue_.clear();
  sending_ = false;
  next_dsn_ = 0;
}

void Device::transmit(RadioFrame frame, Done done, bool keep_dsn) {
  frame.src = am_;
  queue_.push_back({std::move(frame), std::move(done), keep_dsn});
  pump();
}

void Device::pump() {
  if (sending_ || queue_.empty()) return;
  sending_ = true;
  const Traits& traits = world_.traits();
  const auto wait = world_.random().between(traits.access_min_us, traits.access_max_us);
  world_.scheduler().after(wait, [this, cycle = power_cycle_] {
    if (cycle == power_cycle_) try_send();
  });
}

void Device::try_send() {
  const std::int64_t free_us = world_.air().busy_until_us();
  if (free_us > world_.now_us()) {
    const auto again = free_us + world_.random().between(320, 1'500);
    world_.scheduler().at(again, [this, cycle = power_cycle_] {
      if (cycle == power_cycle_) try_send();
    });
    return;
  }
  Waiting& first = queue_.front();
  if (!first.keep_dsn) first.frame.dsn = next_dsn_++;
  world_.air().send(*this, first.frame, [this, cycle = power_cycle_](bool acked) {
    if (cycle == power_cycle_) sent(acked);
  });
}

void Device::sent(bool acked) {
  const Done done = std::move(queue_.front().done);
  queue_.pop_front();
  sending_ = false;
  if (done) done(acked);
  pump();
}

bool Air::reaches(const Device& from, const RadioFrame& frame, const Device& to) {
  if (&from == &to || !to.powered()) return false;
  if (frame.dst != to.am() && frame.dst != kAllNodes) return false;
  const bool apart = world_.plan().islands_apart && from.island_index() >= 0 &&
                     to.island_index() >= 0 && from.island_index() != to.island_index();
  if (apart) return false;
  if (frame.type == static_cast<std::uint8_t>(rubicon::AmType::kNet) &&
      world_.random().chance(world_.plan().net_loss_percent)) {
    return false;
  }
  for (const Loss& loss : world_.plan().losses) {
    if (loss(world_, frame, to)) return false;
  }
  return true;
}

void Air::send(Device& from, const RadioFrame& frame, std::function<void(bool acked)> done) {
  const std::int64_t start_us = world_.now_us();
  Octets record = radio_record(frame);
  const std::int64_t end_us = start_us + airtime_us(record.size());
  busy_until_us_ = end_us + kTurnaroundUs;
  const bool corrupt = world_.random().chance(world_.plan().corrupt_percent);
  if (corrupt) record[3 + world_.random().below(record.size() - 3)] ^= 0x5A;
  world_.capture_radio(start_us, std::move(record));

  std::vector<Device*> listeners;
  for (Device* to : world_.devices()) {
    if (!corrupt && reaches(from, frame, *to)) listeners.push_back(to);
  }
  bool confirmed = false;
  std::int64_t over_us = end_us;
  if (frame.ack_request && frame.dst != kAllNodes) {
    const Octets ack = link_ack_record(frame.dsn);
    over_us = end_us + kTurnaroundUs + airtime_us(ack.size());
    busy_until_us_ = over_us + kTurnaroundUs;
    if (!listeners.empty()) {
      world_.capture_radio(end_us + kTurnaroundUs, ack);
      confirmed = true;
      for (const AckLoss& loss : world_.plan().ack_losses) {
        if (loss(world_, frame)) confirmed = false;
      }
    }
  }
  for (Device* to : listeners) {
    world_.scheduler().at(end_us, [to, frame] {
      if (to->powered()) to->heard(frame);
    });
  }
  world_.scheduler().at(over_us, [done = std::move(done), confirmed] { done(confirmed); });
}

}  // namespace rubric::lawful
