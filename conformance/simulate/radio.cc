#include "conformance/simulate/radio.h"

#include <algorithm>

#include "codec/generated/tinyos/mac_ack.h"
#include "codec/reflect/am_frames.h"

namespace rubric::simulate {
namespace {

using tinyos::FrameControl;

// Times of TinyOS' CC2420 stack: random waits in ticks of its 32 kHz timer, 10 to 329 before the
// first attempt, 10 to 79 after the channel was found taken.
constexpr Micros kInitialBackoffUs[] = {305, 10'040};
constexpr Micros kCongestionBackoffUs[] = {305, 2'410};
constexpr Micros kTurnaroundUs = 192;          // From listening to sending. (IEEE 802.15.4, 6.4.1)
constexpr Micros kLinkAckUs[] = {192, 2'500};  // The acknowledgement is software's.
constexpr Micros kLinkAckWaitUs = 8'000;
constexpr Micros kDoubleUs[] = {500, 20'000};  // The link repeats a frame after this.

constexpr std::size_t kHeaderBytes = reflect::kRadioIHeaderBytes;

std::vector<std::uint8_t> data_frame(const machine::Frame& am, std::uint8_t dsn, bool asks_ack) {
  const auto fcf = asks_ack ? FrameControl::kDataAckRequest : FrameControl::kData;
  return reflect::radio_frame(
      {.fcf = reflect::fcf_of(fcf), .dsn = dsn, .destpan = kPanId, .dest = am.dest, .src = am.src},
      am.type, am.payload);
}

}  // namespace

std::size_t Radio::add_station(std::optional<NodeId> node, std::uint16_t am_address) {
  Station station{.node = node, .am_address = am_address};
  stations_.push_back(station);
  return stations_.size() - 1;
}

void Radio::send(std::size_t station, const machine::Frame& frame, bool link_ack) {
  Station& from = stations_[station];
  auto data = std::make_shared<OnAir>();
  data->sender = station;
  data->dsn = from.dsn++;
  data->bytes = data_frame(frame, data->dsn, link_ack);
  data->am = frame;
  data->am.link = machine::Link::kRadio;
  data->am.payload = Bytes(data->bytes.data(), data->bytes.size()).from(kHeaderBytes);
  data->asks_ack = link_ack;
  data->life = from.life;
  try_channel(data, random_.between(kInitialBackoffUs[0], kInitialBackoffUs[1]));
}

void Radio::try_channel(const Shared& frame, Micros backoff_us) {
  queue_.after(backoff_us, [this, frame] {
    const Station& from = stations_[frame->sender];
    if (from.life != frame->life) return;
    if (is_busy(frame->sender)) {
      const Micros wait = random_.between(kCongestionBackoffUs[0], kCongestionBackoffUs[1]);
      return try_channel(frame, wait);
    }
    // Stations that find the channel free within the turnaround send as well: a collision.
    queue_.after(kTurnaroundUs, [this, frame] {
      const Station& then = stations_[frame->sender];
      if (then.life != frame->life) return;
      if (then.sending) return try_channel(frame, kCongestionBackoffUs[0]);  // Its link ack.
      begin(frame);
    });
  });
}

bool Radio::hears(std::size_t station, std::size_t sender) const {
  const Station& to = stations_[station];
  const Station& from = stations_[sender];
  if (station == sender || !to.node) return false;
  if (!from.node) return true;
  return std::none_of(plan_.deaf.begin(), plan_.deaf.end(), [&](const RadioPlan::Deaf& deaf) {
    return deaf.from == *from.node && deaf.to == *to.node;
  });
}

const Faults& Radio::faults(const Station& from, const Station& to) const {
  for (const RadioPlan::LinkFaults& link : plan_.link_faults) {
    if (link.from == from.node && link.to == to.node) return link.faults;
  }
  return plan_.faults;
}

bool Radio::is_busy(std::size_t station) const {
  if (stations_[station].sending) return true;  // Its link ack.
  return std::any_of(air_.begin(), air_.end(), [&](const Shared& frame) {
    // A station that only sends has no list of whom it hears; it hears all.
    return !stations_[station].node || hears(station, frame->sender);
  });
}

void Radio::begin(const Shared& frame) {
  Station& from = stations_[frame->sender];
  // A radio sends or listens: it loses the frame that it was hearing.
  for (const Shared& other : air_) {
    for (Reception& reception : other->receptions) {
      if (reception.station == frame->sender) reception.destroyed = true;
    }
  }
  for (std::size_t to = 0; to < stations_.size(); ++to) {
    if (!hears(to, frame->sender)) continue;
    Reception mine{to, stations_[to].sending};
    for (const Shared& other : air_) {
      for (Reception& theirs : other->receptions) {
        if (theirs.station == to) theirs.destroyed = mine.destroyed = true;
      }
    }
    frame->receptions.push_back(mine);
  }
  from.sending = true;
  air_.push_back(frame);
  recorder_.on_air(queue_.now(), index_, Bytes(frame->bytes.data(), frame->bytes.size()));
  queue_.after(air_us(frame->bytes.size()), [this, frame] { end(frame); });
}

void Radio::end(const Shared& frame) {
  std::erase(air_, frame);
  stations_[frame->sender].sending = false;
  if (!frame->is_ack && !may_double()) sent(frame);
  std::vector<std::size_t> twice;
  for (const Reception& reception : frame->receptions) {
    if (receive(*frame, reception)) twice.push_back(reception.station);
  }
  if (frame->is_ack || !may_double()) return;
  if (twice.empty() || frame->again) return sent(frame);
  repeat(frame, std::move(twice));
}

bool Radio::may_double() const {
  const auto doubles = [](const RadioPlan::LinkFaults& link) {
    return link.faults.duplication > 0;
  };
  return plan_.faults.duplication > 0 ||
         std::any_of(plan_.link_faults.begin(), plan_.link_faults.end(), doubles);
}

// Sends a frame again: a receiver gets it twice because the sender's link missed the
// acknowledgement. For the sender that is one transmission.
void Radio::repeat(const Shared& frame, std::vector<std::size_t> had_it) {
  auto copy = std::make_shared<OnAir>(*frame);
  copy->am.payload = Bytes(copy->bytes.data(), copy->bytes.size()).from(kHeaderBytes);
  copy->receptions.clear();
  copy->again = true;
  copy->had_it = std::move(had_it);
  const Micros wait = frame->asks_ack ? kLinkAckWaitUs : 0;
  try_channel(copy, wait + random_.between(kDoubleUs[0], kDoubleUs[1]));
}

// Handles the end of a frame at the sender.
void Radio::sent(const Shared& frame) {
  const std::size_t station = frame->sender;
  Station& from = stations_[station];
  if (!from.node || from.life != frame->life) return;
  if (!frame->asks_ack) return finish(station, true);
  from.awaited = frame->dsn;
  queue_.after(kLinkAckWaitUs, [this, frame, station] {
    const Station& then = stations_[station];
    if (then.life == frame->life && then.awaited == frame->dsn) finish(station, false);
  });
}

void Radio::finish(std::size_t station, bool acked) {
  Station& from = stations_[station];
  if (from.awaited) recorder_.link_ack(queue_.now(), *from.node, acked);
  from.awaited.reset();
  user_.radio_sent(*from.node, acked);
}

bool Radio::receive(const OnAir& frame, const Reception& reception) {
  Station& to = stations_[reception.station];
  if (frame.is_ack) {
    const bool awaited = to.awaited == frame.dsn;
    if (!awaited || reception.destroyed || !user_.listens(*to.node)) return false;
    if (!random_.chance(faults(stations_[frame.sender], to).loss)) finish(reception.station, true);
    return false;
  }
  const bool broadcast = frame.am.dest == machine::kAmBroadcast;
  if (!broadcast && frame.am.dest != to.am_address) return false;
  const auto missed = [&](Mishap what) {
    recorder_.mishap(queue_.now(), *to.node, what, frame.am);
    return false;
  };
  if (!user_.listens(*to.node)) return missed(Mishap::kUnheard);
  if (reception.destroyed) return missed(Mishap::kCollided);
  const Faults& faults_here = faults(stations_[frame.sender], to);
  if (random_.chance(faults_here.loss)) return missed(Mishap::kLost);
  if (frame.asks_ack && !broadcast) answer(frame, reception.station);
  auto copy = std::make_shared<OnAir>(frame);
  copy->am.payload = Bytes(copy->bytes.data(), copy->bytes.size()).from(kHeaderBytes);
  const Micros delay = random_.between(0, faults_here.delay_max_us);
  if (delay == 0) {
    deliver(copy, reception.station);
  } else {
    queue_.after(delay, [this, copy, station = reception.station] { deliver(copy, station); });
  }
  return random_.chance(faults_here.duplication);
}

void Radio::deliver(const Shared& frame, std::size_t station) {
  const Station& to = stations_[station];
  if (!user_.listens(*to.node)) return;
  if (std::count(frame->had_it.begin(), frame->had_it.end(), station) > 0) {
    recorder_.mishap(queue_.now(), *to.node, Mishap::kDoubled, frame->am);
  }
  user_.heard(*to.node, frame->am);
}

// Sends the link acknowledgement of a frame, with its number and without listening first.
void Radio::answer(const OnAir& frame, std::size_t station) {
  auto ack = std::make_shared<OnAir>();
  ack->sender = station;
  ack->is_ack = true;
  ack->dsn = frame.dsn;
  ack->bytes.resize(tinyos::MacAckView::kMaxSizeBytes);
  tinyos::MacAck wire;
  wire.fcf = reflect::fcf_of(FrameControl::kAck);
  wire.dsn = frame.dsn;
  tinyos::MacAckLayout::store(wire, ack->bytes.data());
  ack->life = stations_[station].life;
  queue_.after(random_.between(kLinkAckUs[0], kLinkAckUs[1]), [this, ack] {
    const Station& from = stations_[ack->sender];
    if (from.life == ack->life && !from.sending && user_.listens(*from.node)) begin(ack);
  });
}

}  // namespace rubric::simulate
