#include "tools/commands/run/virtual_radio.h"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "codec/containers/zep_packet.h"
#include "codec/generated/rubicon/radio_i_frame.h"
#include "codec/generated/tinyos/am_header.h"
#include "codec/generated/tinyos/mac_ack.h"
#include "codec/generated/tinyos/mac_header.h"
#include "codec/reflect/am_frames.h"
#include "codec/runtime/ieee802154_fcs.h"
#include "tools/commands/run/wall_clock.h"

namespace rubric::run {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::steady_clock;
using tinyos::FrameControl;
using Mac = tinyos::MacHeaderLayout;

// Random waits of TinyOS' CC2420 stack.
constexpr int kBackoffMinUs = 305;
constexpr int kBackoffMaxUs = 10'040;
// Longer than on a real air, where a processor is never late; the stamps do not show it.
constexpr milliseconds kAckWait{100};
constexpr std::int64_t kLateMostNs = 100'000'000;

constexpr std::uint16_t kAll = 0xFFFF;
constexpr std::uint16_t kNobody = 0;
constexpr std::size_t kAckBytes = tinyos::MacAckView::kMaxSizeBytes;
constexpr std::size_t kHeader = reflect::kRadioIHeaderBytes;
constexpr std::int64_t kByteNs = 32'000;
constexpr std::int64_t kTurnaroundNs = 192'000;
constexpr std::size_t kPreambleAndFcs = 6 + 2;
constexpr std::int64_t kLongestFrameNs = 133 * kByteNs;

}  // namespace

VirtualRadio::VirtualRadio(const Settings& settings, lines::HostPort at, User user)
    : settings_(settings),
      air_(std::move(at)),
      user_(std::move(user)),
      random_(settings.seed),
      dsn_(static_cast<std::uint8_t>(random_())) {}

void VirtualRadio::send(Bytes packet, bool link_ack) {
  const auto header = tinyos::AmHeaderView::parse(packet);
  const auto control = link_ack ? FrameControl::kDataAckRequest : FrameControl::kData;
  frame_ = reflect::radio_frame({.fcf = reflect::fcf_of(control),
                                 .dsn = ++dsn_,
                                 .destpan = kPan,
                                 .dest = header->dest(),
                                 .src = settings_.address},
                                header->type(), header->stale());
  link_ack_ = link_ack;
  state_ = State::kWaiting;
  std::uniform_int_distribution<int> wait_us(kBackoffMinUs, kBackoffMaxUs);
  next_ = steady_clock::now() + microseconds(wait_us(random_));
}

void VirtualRadio::put(Bytes frame, std::int64_t time_ns) {
  std::vector<std::uint8_t> whole(frame.begin(), frame.end());
  const std::uint16_t sum = fcs(frame);
  whole.push_back(static_cast<std::uint8_t>(sum));
  whole.push_back(static_cast<std::uint8_t>(sum >> 8));
  ZepPacket zep;
  zep.device = settings_.address;
  zep.time_ns = time_ns;
  zep.sequence = ++sequence_;
  zep.frame = Bytes(whole.data(), whole.size());
  std::string datagram;
  append_zep(zep, datagram);
  Packet packet{.framing = Framing::kRadio, .bytes = frame, .time_ns = time_ns, .fcs = sum};
  user_.on_air(packet);
  air_.send(Bytes(reinterpret_cast<const std::uint8_t*>(datagram.data()), datagram.size()));
}

void VirtualRadio::begin() {
  // A radio sends when its wait is over, however late a busy computer lets this process run; but
  // not before what it has heard, since others then had that first.
  const std::chrono::nanoseconds late = steady_clock::now() - std::max(next_, taken_);
  const std::int64_t late_ns = std::min<std::int64_t>(late.count(), kLateMostNs);
  const std::int64_t now_ns = wall_ns();
  put(Bytes(frame_.data(), frame_.size()), std::clamp(heard_ns_, now_ns - late_ns, now_ns));
  if (!link_ack_) return finish(false);
  state_ = State::kAwaitingAck;
  next_ = taken_ = steady_clock::now() + kAckWait;
}

void VirtualRadio::finish(bool acked) {
  state_ = State::kIdle;
  user_.sent(acked);
}

void VirtualRadio::handle(Bytes datagram) {
  Packet packet;
  if (!decode_zep_datagram(datagram, packet)) return;
  constexpr std::int32_t kChannel = ZepPacket().channel;  // Also of what it sends.
  if (packet.radio.channel != kAbsent && packet.radio.channel != kChannel) return;
  packet.time_ns = lines::air_time_ns(packet.time_ns);
  const std::vector<std::uint8_t> kept(packet.bytes.begin(), packet.bytes.end());
  packet.bytes = Bytes(kept.data(), kept.size());
  // Two senders that were late may have stamped their frames in another order than that in which
  // this end takes them.
  const std::uint16_t dest = kept.size() < kHeader ? kNobody : Mac::DestAt::load(kept.data());
  const bool is_for_us = dest == settings_.address || dest == kAll;
  if (is_for_us) {
    // Not beyond the end of a link ack; a wrong clock's stamp may be.
    const std::int64_t least_ns = std::min(taken_ns_, wall_ns() + kLongestFrameNs);
    packet.time_ns = std::max(packet.time_ns, least_ns);
  }
  user_.on_air(packet);
  // A frame is heard at its end, which is also the earliest time of what it causes.
  const std::int64_t end_ns =
      packet.time_ns + static_cast<std::int64_t>(kept.size() + kPreambleAndFcs) * kByteNs;
  heard_ns_ = end_ns;
  if (is_for_us) taken_ns_ = end_ns;
  if (packet.error.fault != Fault::kNone) return;
  const bool lost = std::bernoulli_distribution(settings_.loss)(random_);
  if (kept.size() < kAckBytes) return;
  const std::uint16_t control = Mac::FcfAt::load(kept.data());
  if (kept.size() == kAckBytes && control == reflect::fcf_of(FrameControl::kAck)) {
    taken_ = {};
    const bool ours = state_ == State::kAwaitingAck &&
                      Mac::DsnAt::load(kept.data()) == Mac::DsnAt::load(frame_.data());
    if (!lost && ours) finish(true);
    return;
  }
  if (kept.size() < kHeader) return;
  const bool asks = control == reflect::fcf_of(FrameControl::kDataAckRequest);
  if (asks) taken_ = steady_clock::now() + kAckWait;
  if (!asks && control != reflect::fcf_of(FrameControl::kData)) return;
  const std::uint16_t src = Mac::SrcAt::load(kept.data());
  if (src == settings_.address) user_.twin();
  if (lost || !user_.listens() || !is_for_us) return;
  if (asks && dest != kAll) {
    tinyos::MacAck ack;
    ack.fcf = reflect::fcf_of(FrameControl::kAck);
    ack.dsn = Mac::DsnAt::load(kept.data());
    std::uint8_t room[kAckBytes];
    tinyos::MacAckLayout::store(ack, room);
    put(Bytes(room, sizeof room), end_ns + kTurnaroundNs);
    taken_ns_ += kTurnaroundNs + std::int64_t{kAckBytes + kPreambleAndFcs} * kByteNs;
    taken_ = {};
  }
  const std::int64_t early_ns = end_ns - wall_ns();
  if (early_ns > 0 && early_ns < kLongestFrameNs) {
    std::this_thread::sleep_for(std::chrono::nanoseconds(early_ns));
  }
  tinyos::AmHeader header;
  header.dest = dest;
  header.src = src;
  header.group = static_cast<std::uint8_t>(kPan);
  header.type = static_cast<std::uint8_t>(rubicon::RadioIFrameLayout::TypeAt::load(kept.data()));
  header.length = static_cast<std::uint8_t>(kept.size() - kHeader);
  std::vector<std::uint8_t> out(tinyos::AmHeaderView::kMaxSizeBytes);
  tinyos::AmHeaderLayout::store(header, out.data());
  out.insert(out.end(), kept.begin() + kHeader, kept.end());
  user_.heard(Bytes(out.data(), out.size()));
}

void VirtualRadio::run(lines::SteadyTime deadline, const lines::Air::Others& others) {
  const auto until = state_ == State::kIdle ? deadline : std::min(deadline, next_);
  const Bytes datagram = air_.receive(until, others);
  if (!datagram.empty()) handle(datagram);
  const auto now = steady_clock::now();
  // What came while this process could not run is heard first.
  if (!datagram.empty() && now < next_ + std::chrono::nanoseconds(kLateMostNs)) return;
  if (state_ == State::kIdle || now < next_) return;
  if (state_ == State::kAwaitingAck) return finish(false);
  if (now < taken_) {
    std::uniform_int_distribution<int> wait_us(kBackoffMinUs, kBackoffMaxUs);
    next_ = now + microseconds(wait_us(random_));
    return;
  }
  begin();
}

}  // namespace rubric::run
