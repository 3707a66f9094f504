#include "codec/lines/air.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>

#include "codec/containers/zep_packet.h"
#include "codec/lines/broken.h"

namespace rubric::lines {
namespace {

using std::chrono::steady_clock;

constexpr Milliseconds kGreetEvery{500};
constexpr Milliseconds kHubAnswersIn{2000};
constexpr std::size_t kPeersMax = 256;
constexpr std::size_t kDatagramMax = 65'535;
constexpr std::size_t kArrivedMax = 64;  // A flood is not sorted for ever.

Descriptor udp_socket(const SocketAddress& address) {
  Descriptor made(::socket(address.family(), SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!made.is_open()) throw Broken(std::strerror(errno));
  return made;
}

bool same_end(const SocketAddress& a, const SocketAddress& b) {
  return a.port() == b.port() && a.same_host(b);
}

}  // namespace

void Air::open() {
  peers_.clear();
  arrived_.clear();
  room_.resize(kDatagramMax);
  const std::vector<SocketAddress> all = resolve(at_.host, at_.port, true);
  // The same address for everybody, so that all meet: of localhost that of IPv4.
  const SocketAddress& address = all.front();
  socket_ = udp_socket(address);
  is_hub_ = ::bind(socket_.get(), address.get(), address.size_bytes) == 0;
  if (is_hub_) {
    at_.port = address_here(socket_.get()).port();
    next_greeting_ = SteadyTime::max();
    return;
  }
  // It is taken, or belongs to another host.
  const bool elsewhere = errno == EADDRINUSE || errno == EADDRNOTAVAIL;
  if (!elsewhere || ::connect(socket_.get(), address.get(), address.size_bytes) != 0) {
    throw Broken(fmt::format("zep:{}:{}: {}", at_.host, at_.port, std::strerror(errno)));
  }
  met_ = steady_clock::now();
  is_answered_ = false;
  greet();
}

bool Air::is_unanswered() const {
  return !is_hub_ && !is_answered_ && steady_clock::now() - met_ > kHubAnswersIn;
}

std::string Air::greeting() {
  ZepPacket ack{.type = ZepPacket::Type::kAck};
  std::string datagram;
  append_zep(ack, datagram);
  return datagram;
}

// Makes the hub know this end, which may never send a frame, and shows whether the hub is there,
// which greets in return.
void Air::greet() {
  const std::string datagram = greeting();
  next_greeting_ = steady_clock::now() + kGreetEvery;
  ::send(socket_.get(), datagram.data(), datagram.size(), MSG_NOSIGNAL);
}

void Air::send(Bytes datagram) {
  if (is_hub_) return relay(datagram, nullptr);
  for (int attempt = 0; attempt < 2; ++attempt) {
    // A full buffer loses a datagram, as the air does. The error of an earlier one comes first.
    const auto sent = ::send(socket_.get(), datagram.data(), datagram.size(), MSG_NOSIGNAL);
    if (sent >= 0 || errno != ECONNREFUSED) return;
    open();
    if (is_hub_) return;
  }
}

void Air::note(const SocketAddress& from, bool greets) {
  const SteadyTime now = steady_clock::now();
  const auto known = std::find_if(peers_.begin(), peers_.end(),
                                  [&](const Peer& peer) { return same_end(peer.address, from); });
  if (known != peers_.end()) {
    known->heard = now;
    known->greets |= greets;
    return;
  }
  if (peers_.size() == kPeersMax) {
    peers_.erase(std::min_element(peers_.begin(), peers_.end(),
                                  [](const Peer& a, const Peer& b) { return a.heard < b.heard; }));
  }
  peers_.push_back({from, now, greets});
}

// The port of one that has gone may become that of another air's hub, which would pass on there
// what it is sent.
void Air::forget_the_gone() {
  const SteadyTime since = steady_clock::now() - forgets_after_;
  std::erase_if(peers_, [&](const Peer& peer) { return peer.greets && peer.heard < since; });
}

void Air::relay(Bytes datagram, const SocketAddress* from) {
  forget_the_gone();
  for (const Peer& peer : peers_) {
    if (from != nullptr && same_end(peer.address, *from)) continue;
    ::sendto(socket_.get(), datagram.data(), datagram.size(), MSG_NOSIGNAL, peer.address.get(),
             peer.address.size_bytes);
  }
}

std::int64_t air_time_ns(std::int64_t stamp_ns) {
  constexpr std::int64_t kTrustNs = 10'000'000'000;
  const std::int64_t now_ns =
      std::chrono::system_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
  // kNoTime is far below.
  return stamp_ns > now_ns - kTrustNs && stamp_ns < now_ns + kTrustNs ? stamp_ns : now_ns;
}

// Puts the datagrams at hand into order. Returns the error with which the socket had no more.
int Air::take_arrived() {
  while (arrived_.size() < kArrivedMax) {
    SocketAddress from;
    from.size_bytes = sizeof from.storage;
    const auto size =
        ::recvfrom(socket_.get(), room_.data(), room_.size(), 0, from.get(), &from.size_bytes);
    if (size < 0) return errno;
    const Bytes datagram(room_.data(), static_cast<std::size_t>(size));
    const Result<ZepPacket> zep = parse_zep(datagram);
    is_answered_ = true;
    const bool greets = zep && zep->type == ZepPacket::Type::kAck;
    if (is_hub_) note(from, greets);
    if (greets && is_hub_) {
      const std::string answer = greeting();
      ::sendto(socket_.get(), answer.data(), answer.size(), MSG_NOSIGNAL, from.get(),
               from.size_bytes);
    }
    if (size == 0 || greets) continue;
    const std::int64_t time_ns = air_time_ns(zep ? zep->time_ns : kNoTime);
    const auto later = std::upper_bound(
        arrived_.begin(), arrived_.end(), time_ns,
        [](std::int64_t time, const Arrived& other) { return time < other.time_ns; });
    arrived_.insert(later, {time_ns, from, {datagram.begin(), datagram.end()}});
  }
  return 0;
}

Bytes Air::receive(SteadyTime deadline, const Others& others) {
  while (true) {
    if (steady_clock::now() >= next_greeting_) greet();
    const int error = take_arrived();
    if (!arrived_.empty()) {
      current_ = std::move(arrived_.front().bytes);
      const SocketAddress from = arrived_.front().from;
      arrived_.pop_front();
      const Bytes datagram(current_.data(), current_.size());
      if (is_hub_) relay(datagram, &from);
      return datagram;
    }
    if (error == ECONNREFUSED) {
      open();
      continue;
    }
    if (error != EAGAIN && error != EWOULDBLOCK && error != EINTR) {
      throw Broken(std::strerror(error));
    }
    const SteadyTime now = steady_clock::now();
    if (now >= deadline) return {};
    const auto left = std::min(deadline, next_greeting_) - now;
    const auto left_ms = std::chrono::ceil<Milliseconds>(left).count();
    pollfd inputs[] = {{socket_.get(), POLLIN, 0}, {others[0], POLLIN, 0}, {others[1], POLLIN, 0}};
    ::poll(inputs, 3, static_cast<int>(std::clamp<std::int64_t>(left_ms, 0, 1000)));
    if (inputs[1].revents != 0 || inputs[2].revents != 0) return {};
  }
}

}  // namespace rubric::lines
