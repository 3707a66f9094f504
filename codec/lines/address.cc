#include "codec/lines/address.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <memory>

#include "codec/lines/broken.h"

namespace rubric::lines {
namespace {

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

// `localhost` and the names below it.
bool is_localhost(std::string name) {
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (name.ends_with('.')) name.pop_back();
  return name == "localhost" || name.ends_with(".localhost");
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
  if (is_localhost(host)) {
    std::vector<SocketAddress> out = resolve("127.0.0.1", port, passive);
    // IPv4 is listened at first, where most clients look, and tried last: that failure is reported.
    const SocketAddress v6 = resolve("::1", port, passive).front();
    out.insert(passive ? out.end() : out.begin(), v6);
    return out;
  }
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = passive ? AI_PASSIVE : 0;
  addrinfo* found = nullptr;
  const int error = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found);
  if (error != 0) throw Broken(fmt::format("{}: {}", host, ::gai_strerror(error)));
  const std::unique_ptr<addrinfo, FreeAddresses> all(found);
  std::vector<SocketAddress> out;
  for (const addrinfo* one = all.get(); one; one = one->ai_next) {
    SocketAddress& address = out.emplace_back();
    std::memcpy(&address.storage, one->ai_addr, one->ai_addrlen);
    address.size_bytes = one->ai_addrlen;
  }
  return out;
}

Descriptor open_socket(const SocketAddress& address) {
  return Descriptor(::socket(address.family(), SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
}

Descriptor listen_at(const std::string& host, std::uint16_t port) {
  int error = 0;
  for (const SocketAddress& address : resolve(host, port, true)) {
    Descriptor made = open_socket(address);
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
  throw Broken(fmt::format("cannot listen at {}, port {}: {}", host, port, std::strerror(error)));
}

}  // namespace rubric::lines
