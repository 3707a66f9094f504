// Internet addresses of sockets, and of hosts by name.
#pragma once

#include <sys/socket.h>

#include <cstdint>
#include <string>
#include <vector>

#include "codec/lines/stream.h"

namespace rubric::lines {

/// The address of one end of a socket.
struct SocketAddress {
  sockaddr_storage storage{};
  socklen_t size_bytes = 0;

  sockaddr* get() { return reinterpret_cast<sockaddr*>(&storage); }
  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&storage); }
  int family() const { return storage.ss_family; }
  std::uint16_t port() const;
  /// Returns "127.0.0.1:9002", "[::1]:9002".
  std::string text() const;
  /// Returns whether only this host reaches it.
  bool is_loopback() const;
  /// Returns whether it means all addresses of this host.
  bool is_any() const;
  /// Returns whether the hosts are the same; ports do not matter.
  bool same_host(const SocketAddress& other) const;
};

SocketAddress address_here(int fd);
SocketAddress address_of_peer(int fd);

/// Returns all addresses of a host, in the order in which they are to be tried. `passive`: to
/// listen at, and `port` may be 0. `localhost` always means loopback (RFC 6761). Throws
/// Broken. May take as long as looking up names takes.
std::vector<SocketAddress> resolve(const std::string& host, std::uint16_t port, bool passive);

/// Returns a socket for the address that does not block. It is not open if that fails: see errno.
Descriptor open_socket(const SocketAddress& address);

/// Listens at the first of the host's addresses where that works. Throws Broken.
Descriptor listen_at(const std::string& host, std::uint16_t port);

}  // namespace rubric::lines
