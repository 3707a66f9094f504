// A sink.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "conformance/selftest/lawful_traffic/node.h"
#include "conformance/selftest/lawful_traffic/serial_line.h"
#include "conformance/selftest/lawful_traffic/world.h"

namespace rubric::lawful {
namespace {

constexpr std::size_t kNetHeaderBytes = 12;
constexpr std::size_t kNetBytes = 114;
constexpr std::uint8_t kMaxNbytes = 102;
constexpr auto kNetType = static_cast<std::uint8_t>(rubicon::AmType::kNet);

}  // namespace

Sink::Sink(World& world, int number, int island_index, std::uint16_t island)
    : Node(world, number, kSinkAm, island_index, "sink"), serial_memory_(kNetBytes) {
  address_ = {island, kSinkAm};
}

void Sink::boot() {
  power(true);
  event("booted", "");
}

std::uint32_t Sink::clock_ms() const {
  const std::int64_t local_us = world().now_us() + world().now_us() * clock_ppm() / 1'000'000;
  const std::int64_t per_second = world().traits().binary_time ? 1024 : 1000;
  return static_cast<std::uint32_t>(world().traits().time_offset_ms +
                                    static_cast<std::uint64_t>(local_us * per_second / 1'000'000));
}

void Sink::heard(const RadioFrame& frame) {
  switch (static_cast<rubicon::AmType>(frame.type)) {
    case rubicon::AmType::kJoin: return work(false, [this, frame] { on_request(frame); });
    case rubicon::AmType::kAckJoin: return work(false, [this, frame] { on_ack_join(frame); });
    case rubicon::AmType::kNet:
      return work(true, [this, frame] {
        const auto message = decode_net(view(frame.payload));
        if (message) on_net(*message);
      });
    default: return;
  }
}

void Sink::on_request(const RadioFrame& frame) {
  const auto request = rubicon::JoinRequestView::parse(view(frame.payload));
  if (!request || members_.count(frame.src) != 0) return;
  const bool full = members_.size() >= world().traits().members_max;
  if (full && !world().traits().answers_when_full) return;
  const auto desc = request->mote_desc();
  joining_[frame.src] = {request->seq_num(),
                         {static_cast<std::uint8_t>(desc.mote_type()), desc.transducers().raw(),
                          desc.actuators().raw()}};
  RadioFrame reply;
  reply.dst = frame.src;
  reply.type = static_cast<std::uint8_t>(rubicon::AmType::kJoinReply);
  reply.payload = join_reply({address_.pid, frame.src}, clock_ms(), request->seq_num());
  transmit(std::move(reply));
}

void Sink::on_ack_join(const RadioFrame& frame) {
  const auto ack = rubicon::AckJoinView::parse(view(frame.payload));
  if (!ack || static_cast<std::uint16_t>(ack->dest().pid()) != address_.pid) return;
  const auto found = joining_.find(frame.src);
  if (found == joining_.end() || found->second.seq != ack->seq_num()) return;
  const Joining joined = found->second;
  joining_.erase(found);
  if (members_.size() >= world().traits().members_max) return;
  if (!members_.insert(frame.src).second) return;
  event("moteJoined", fmt::format(",\"island\":{},\"mote\":{}", address_.pid, frame.src));
  NetMessage report{.dest = {address_.pid, kNull}, .src = {address_.pid, frame.src}};
  // A sink that keeps nbytes true counts its reports, too; release 1.0 sends 0.
  report.seq = world().traits().serial_true_nbytes ? fresh_seq() : std::uint16_t{0};
  report.payload = app_msg(rubicon::Component::kConnless,
                           static_cast<std::uint8_t>(rubicon::Component::kControlLayer),
                           serial_joined_body(report.src, joined.descriptor));
  to_host(report, false);
}

void Sink::on_net(const NetMessage& message) {
  const Traits& traits = world().traits();
  const Address dest = message.dest;
  const bool from_here = message.src.pid == address_.pid;
  if (dest.pid == address_.pid) {
    if (dest.devid == kSinkAm || dest.devid == kAllNodes) return arrived(message);
    if (dest.devid == kNull) {
      if (from_here || traits.forwards_foreign_source) to_host(message, false);
      return;
    }
    if (traits.relays_for_others && first_time(message)) by_radio(message);
    return;
  }
  if (dest.pid == kAllNodes) {
    arrived(message);
    if (traits.wide_pid == WidePid::kForward && from_here && first_time(message)) {
      to_host(message, false);
    }
    return;
  }
  if (from_here) to_host(message, false);
}

bool Sink::first_time(const NetMessage& message) {
  const auto source = static_cast<std::uint32_t>(message.src.pid) << 16 | message.src.devid;
  return seen_.insert({source, message.seq}).second;
}

void Sink::serial_heard(std::uint8_t am_type, const Octets& payload) {
  if (am_type == static_cast<std::uint8_t>(rubicon::AmType::kConfig)) {
    const auto config = rubicon::ConfigView::parse(view(payload));
    if (!config || config->type() != rubicon::CommandCode::kSetIslandId) return;
    const std::uint16_t island = config->value();
    return work(false, [this, island] {
      if (island == address_.pid) return;
      address_.pid = island;
      joining_.clear();
      if (world().traits().forgets_members) members_.clear();
      event("island_set", fmt::format(",\"island\":{}", island));
    });
  }
  if (am_type != kNetType) return;
  work(true, [this, payload] {
    const auto message = decode_net(view(payload));
    if (message) on_serial_net(*message);
  });
}

void Sink::on_serial_net(const NetMessage& message) {
  const Address dest = message.dest;
  if (dest.pid == kAllNodes) {
    arrived(message);
    if (world().traits().wide_pid == WidePid::kRefuse) return;
    if (first_time(message)) by_radio(message);
    return;
  }
  if (dest.pid != address_.pid) {
    const bool mote = dest.devid != kNull && dest.devid != kSinkAm;
    if (world().traits().radiates_foreign && mote) by_radio(message);
    return;
  }
  if (dest.devid == kNull) return;
  if (dest.devid == kSinkAm || dest.devid == kAllNodes) arrived(message);
  if (dest.devid != kSinkAm) by_radio(message);
}

void Sink::by_radio(const NetMessage& message) { transmit_net(message, message.dest.devid); }

void Sink::to_host(const NetMessage& message, bool own) {
  // The serial line mostly carries a whole message; the bytes after the content are left over.
  const Octets bytes = encode(message);
  if (world().traits().serial_cut) return line_->to_host(kNetType, bytes);
  std::copy(bytes.begin(), bytes.end(), serial_memory_.begin());
  const bool lies = !own && !world().traits().serial_true_nbytes;
  if (lies) serial_memory_[kNetHeaderBytes - 1] = kMaxNbytes;
  line_->to_host(kNetType, serial_memory_);
}

bool Sink::route(const NetMessage& message) {
  const Address dest = message.dest;
  const bool by_serial = (dest.pid == address_.pid && dest.devid == kNull) ||
                         (dest.pid != address_.pid && dest.pid != kAllNodes);
  if (by_serial) {
    to_host(message, true);
    return true;
  }
  if (radio_full()) return false;
  if (dest.pid == kAllNodes && world().traits().wide_pid == WidePid::kRefuse) return false;
  by_radio(message);
  return true;
}

}  // namespace rubric::lawful
