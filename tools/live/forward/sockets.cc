#include "tools/live/forward/sockets.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>

#include <cerrno>
#include <cstring>
#include <memory>

#include <fmt/format.h>

#include "conformance/runner/target.h"

namespace rubric::forward {
namespace {

using runner::TargetBroken;

constexpr attach::Milliseconds kConnectTime{2000};
constexpr int kBacklogConnections = 64;

struct FreeAddresses {
  void operator()(addrinfo* list) const { ::freeaddrinfo(list); }
};

const sockaddr_in& as_v4(const SocketAddress& address) {
  return reinterpret_cast<const sockaddr_in&>(address.storage);
}
const sockaddr_in6& as_v6(const SocketAddress& address) {
  return reinterpret_cast<const sockaddr_in6&>(address.storage);
}

attach::Descriptor make_socket(const SocketAddress& address) {
  return attach::Descriptor(
      ::socket(address.family(), SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
}

}  // namespace

std::uint16_t SocketAddress::port() const {
  return ntohs(family() == AF_INET6 ? as_v6(*this).sin6_port : as_v4(*this).sin_port);
}

std::string SocketAddress::text() const {
  char host[NI_MAXHOST] = "?";
  ::getnameinfo(get(), size_bytes, host, sizeof host, nullptr, 0, NI_NUMERICHOST);
  return family() == AF_INET6 ? fmt::format("[{}]:{}", host, port())
                              : fmt::format("{}:{}", host, port());
}

bool SocketAddress::is_loopback() const {
  if (family() == AF_INET) return ntohl(as_v4(*this).sin_addr.s_addr) >> 24 == IN_LOOPBACKNET;
  return family() == AF_INET6 && IN6_IS_ADDR_LOOPBACK(&as_v6(*this).sin6_addr);
}

bool SocketAddress::is_any() const {
  if (family() == AF_INET) return as_v4(*this).sin_addr.s_addr == INADDR_ANY;
  return family() == AF_INET6 && IN6_IS_ADDR_UNSPECIFIED(&as_v6(*this).sin6_addr);
}

bool SocketAddress::same_host(const SocketAddress& other) const {
  if (family() != other.family()) return false;
  if (family() == AF_INET) return as_v4(*this).sin_addr.s_addr == as_v4(other).sin_addr.s_addr;
  return family() == AF_INET6 &&
         std::memcmp(&as_v6(*this).sin6_addr, &as_v6(other).sin6_addr, sizeof(in6_addr)) == 0;
}

SocketAddress address_here(int fd) {
  SocketAddress out;
  out.size_bytes = sizeof out.storage;
  ::getsockname(fd, out.get(), &out.size_bytes);
  return out;
}

SocketAddress address_of_peer(int fd) {
  SocketAddress out;
  out.size_bytes = sizeof out.storage;
  ::getpeername(fd, out.get(), &out.size_bytes);
  return out;
}

std::vector<SocketAddress> resolve(const std::string& host, std::uint16_t port, bool passive) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = passive ? AI_PASSIVE : 0;
  addrinfo* found = nullptr;
  const int error = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found);
  if (error != 0) throw TargetBroken(fmt::format("{}: {}", host, ::gai_strerror(error)));
  const std::unique_ptr<addrinfo, FreeAddresses> all(found);
  std::vector<SocketAddress> out;
  for (const addrinfo* one = all.get(); one; one = one->ai_next) {
    SocketAddress& address = out.emplace_back();
    std::memcpy(&address.storage, one->ai_addr, one->ai_addrlen);
    address.size_bytes = one->ai_addrlen;
  }
  return out;
}

attach::Descriptor listen_at(const std::string& host, std::uint16_t port) {
  int error = 0;
  for (const SocketAddress& address : resolve(host, port, true)) {
    attach::Descriptor made = make_socket(address);
    if (!made.is_open()) {
      error = errno;
      continue;
    }
    const int on = 1;
    ::setsockopt(made.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    if (::bind(made.get(), address.get(), address.size_bytes) == 0 &&
        ::listen(made.get(), kBacklogConnections) == 0) {
      return made;
    }
    error = errno;
  }
  throw TargetBroken(
      fmt::format("cannot listen at {}, port {}: {}", host, port, std::strerror(error)));
}

void Connector::begin(attach::SteadyTime now) {
  next_ = 0;
  connected_ = false;
  try_next(now);
}

void Connector::try_next(attach::SteadyTime now) {
  while (next_ < addresses_.size()) {
    const SocketAddress& address = addresses_[next_++];
    attach::Descriptor made = make_socket(address);
    if (!made.is_open()) {
      error_ = errno;
      continue;
    }
    socket_ = std::move(made);
    connected_ = ::connect(socket_.get(), address.get(), address.size_bytes) == 0;
    error_ = errno;
    deadline_ = now + kConnectTime;
    if (connected_ || error_ == EINPROGRESS || error_ == EINTR) return;
  }
  socket_.close();
  throw TargetBroken(fmt::format("cannot connect: {}", std::strerror(error_)));
}

void Connector::go_on(bool writable, attach::SteadyTime now) {
  if (writable) {
    socklen_t size = sizeof error_;
    ::getsockopt(socket_.get(), SOL_SOCKET, SO_ERROR, &error_, &size);
    connected_ = error_ == 0;
    if (!connected_) try_next(now);
  } else if (now >= deadline_) {
    error_ = ETIMEDOUT;
    try_next(now);
  }
}

attach::ByteStream Connector::take() {
  const int on = 1;  // Writes are whole packets already.
  ::setsockopt(socket_.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  ::setsockopt(socket_.get(), SOL_SOCKET, SO_KEEPALIVE, &on, sizeof on);
  return attach::ByteStream(std::move(socket_));
}

bool would_block(int error) { return error == EAGAIN || error == EWOULDBLOCK || error == EINTR; }

}  // namespace rubric::forward
