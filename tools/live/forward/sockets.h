// Sockets of a program that waits for many at once: no call here blocks except for names.
#pragma once

#include <vector>

#include "conformance/attach/address.h"
#include "conformance/attach/stream.h"

namespace rubric::forward {

using attach::address_here;
using attach::address_of_peer;
using attach::listen_at;
using attach::resolve;
using attach::SocketAddress;

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
