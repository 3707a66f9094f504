#include "codec/lines/forward/client.h"

#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <chrono>
#include <cstring>

#include "codec/containers/sf_reader.h"
#include "codec/lines/forward/sockets.h"

namespace rubric::forward {
namespace {

// The kernel's buffer for a client besides the backlog. By default it would take megabytes.
constexpr int kSocketBytes = 128 * 1024;

double seconds(lines::SteadyTime::duration time) {
  return std::chrono::duration<double>(time).count();
}

}  // namespace

Client::Client(lines::Descriptor socket, std::string name, std::uint64_t offset,
               const Limits& limits, lines::SteadyTime now)
    : socket_(std::move(socket)),
      name_(std::move(name)),
      limits_(limits),
      begun_(now),
      heard_(now),
      served_(now),
      offset_(offset) {
  const int on = 1;
  ::setsockopt(fd(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  ::setsockopt(fd(), SOL_SOCKET, SO_KEEPALIVE, &on, sizeof on);
  ::setsockopt(fd(), SOL_SOCKET, SO_SNDBUF, &kSocketBytes, sizeof kSocketBytes);
  //= WIRE-SF-HANDSHAKE: A serial forwarder stream begins with the byte 0x55 and a version byte
  //= from each side.
  const std::uint8_t hello[] = {kSfMagic, kSfVersion};
  lost_ = ::send(fd(), hello, sizeof hello, MSG_NOSIGNAL) != sizeof hello;
}

short Client::events() const {
  const bool listens = !ended_ && in_used_ < kRoom;
  return static_cast<short>((listens ? POLLIN : 0) | (blocked_ && !lost_ ? POLLOUT : 0));
}

void Client::turn(short found, const Backlog& backlog, lines::SteadyTime now) {
  const bool broken = found & (POLLERR | POLLHUP | POLLNVAL);
  lost_ = lost_ || broken;
  if (found & POLLOUT) {
    blocked_ = false;
    write(backlog, now);
  }
  if (ended_ && broken) return socket_.close();
  // Even if the client is lost: its earlier packets are for the source all the same.
  if (broken || (found & POLLIN)) read(now);
}

// Reads everything, so that a client that has left is noticed before the next one comes.
void Client::read(lines::SteadyTime now) {
  while (!ended_ && in_used_ < kRoom) {
    const ssize_t count = ::recv(fd(), in_.data() + in_used_, kRoom - in_used_, 0);
    if (count < 0 && would_block(errno)) return;
    if (count <= 0) {
      ended_ = true;
      if (lost_ || count < 0) socket_.close();
      return look_behind_the_last();
    }
    const bool begins = greeted_ && !is_cut_short();
    const bool greeted = greeted_;
    const std::size_t packets = packets_waiting();
    in_used_ += static_cast<std::size_t>(count);
    heard_ = now;
    check_input();
    if (begins || greeted != greeted_ || packets != packets_waiting()) begun_ = now;
  }
}

// Checks the beginning of its input.
void Client::check_input() {
  if (in_used_ == 0 || !fault_.empty()) return;
  if (!greeted_) {
    const bool magic = in_[0] == kSfMagic;
    if (magic && in_used_ < 2) return;
    // Both sides use the lower of their two versions, so a higher one is no fault.
    if (magic && in_[1] >= kSfVersion) {
      greeted_ = true;
      return drop(2);
    }
    fault_ = magic ? fmt::format("it begins with 55 {:02x}, not with 55 20", in_[1])
                   : fmt::format("it begins with {:02x}, not with 55 20", in_[0]);
    return;
  }
  //= WIRE-SF-LENGTH: A serial forwarder packet is a length byte of 1 to 255 and that many bytes
  //= from the dispatch byte on.
  if (in_[0] == 0) {
    fault_ = "it sent a packet of no bytes";
  } else if (in_[0] > limits_.packet_max) {
    fault_ = fmt::format("it sent a packet of {} bytes; the source takes {}", in_[0],
                         limits_.packet_max);
  }
}

void Client::drop(std::size_t count) {
  in_used_ -= count;
  std::memmove(in_.data(), in_.data() + count, in_used_);
  check_input();
  look_behind_the_last();
}

void Client::look_behind_the_last() {
  if (!ended_ || !fault_.empty() || !is_cut_short()) return;
  fault_ = greeted_ ? "it left within a packet" : "it left within the handshake";
}

std::optional<Bytes> Client::packet() const {
  if (!greeted_ || !fault_.empty() || in_used_ == 0 || in_used_ <= in_[0]) return std::nullopt;
  return Bytes(in_.data() + 1, in_[0]);
}

void Client::drop_packet() { drop(std::size_t{1} + in_[0]); }

std::size_t Client::packets_waiting() const {
  std::size_t count = 0;
  for (std::size_t at = 0; greeted_ && at < in_used_ && at + in_[at] < in_used_; ++count) {
    if (in_[at] == 0) break;
    at += std::size_t{1} + in_[at];
  }
  return count;
}

void Client::write(const Backlog& backlog, lines::SteadyTime now) {
  if (fd() < 0 || lost_) return;
  if (!backlog.holds(offset_)) {
    fault_ = fmt::format("it is {} bytes behind and has taken nothing for {:.1f} s",
                         backlog.end() - offset_, seconds(now - served_));
    return;
  }
  while (!blocked_ && offset_ != backlog.end()) {
    const Bytes bytes = backlog.from(offset_);
    const ssize_t count = ::send(fd(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (count > 0) {
      offset_ += static_cast<std::uint64_t>(count);
      served_ = now;
    } else if (would_block(errno) || errno == ENOBUFS || errno == ENOMEM) {
      blocked_ = true;
    } else {
      lost_ = true;  // Poll says so, too, and then it is read to its end.
      return;
    }
  }
}

std::optional<lines::SteadyTime> Client::deadline() const {
  if (ended_ || lost_ || !fault_.empty()) return std::nullopt;
  if (greeted_ && !is_cut_short()) return std::nullopt;
  return begun_ + limits_.patience;
}

void Client::tick(lines::SteadyTime now) {
  const std::optional<lines::SteadyTime> end = deadline();
  if (!end || now < *end) return;
  fault_ = fmt::format("it has not ended its {} in {:.1f} s", greeted_ ? "packet" : "handshake",
                       seconds(now - begun_));
}

}  // namespace rubric::forward
