// Sockets of a program that waits for many at once: no call here blocks except for names.
#pragma once

#include <sys/socket.h>

#include <cstdint>
#include <string>
#include <vector>

#include "conformance/attach/stream.h"

namespace rubric::forward {

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
/// listen at, and `port` may be 0. Throws runner::TargetBroken. May take as long as looking up
/// names takes.
std::vector<SocketAddress> resolve(const std::string& host, std::uint16_t port, bool passive);

/// Listens at the first of the host's addresses where that works. Throws runner::TargetBroken.
attach::Descriptor listen_at(const std::string& host, std::uint16_t port);

/// Connects to the first of some addresses that takes the connection.
class Connector {
 public:
  explicit Connector(std::vector<SocketAddress> addresses) : addresses_(std::move(addresses)) {}

  /// Starts with the first address. Throws runner::TargetBroken, here and below, when none is left.
  void begin(attach::SteadyTime now);
  /// Continues when the socket is writable, or the time may be over.
  void go_on(bool writable, attach::SteadyTime now);
  bool connected() const { return connected_; }
  int fd() const { return socket_.get(); }
  /// Returns when to continue though nothing happened.
  attach::SteadyTime deadline() const { return deadline_; }
  /// Returns the connection, once.
  attach::ByteStream take();
  void close() { socket_.close(); }

 private:
  void try_next(attach::SteadyTime now);

  std::vector<SocketAddress> addresses_;
  std::size_t next_ = 0;
  attach::Descriptor socket_;
  attach::SteadyTime deadline_;
  bool connected_ = false;
  int error_ = 0;  // Why the last one failed.
};

/// Returns whether an error only means that there is nothing to do now.
bool would_block(int error);

}  // namespace rubric::forward
