// Sockets of a program that waits for many at once: no call here blocks except for names.
#pragma once

#include <vector>

#include "codec/lines/address.h"
#include "codec/lines/stream.h"

namespace rubric::forward {

using lines::address_here;
using lines::address_of_peer;
using lines::listen_at;
using lines::resolve;
using lines::SocketAddress;

/// Connects to the first of some addresses that takes the connection.
class Connector {
 public:
  explicit Connector(std::vector<SocketAddress> addresses) : addresses_(std::move(addresses)) {}

  /// Starts with the first address. Throws lines::Broken, here and below, when none is left.
  void begin(lines::SteadyTime now);
  /// Continues when the socket is writable, or the time may be over.
  void go_on(bool writable, lines::SteadyTime now);
  bool connected() const { return connected_; }
  int fd() const { return socket_.get(); }
  /// Returns when to continue though nothing happened.
  lines::SteadyTime deadline() const { return deadline_; }
  /// Returns the connection, once.
  lines::ByteStream take();
  void close() { socket_.close(); }

 private:
  void try_next(lines::SteadyTime now);

  std::vector<SocketAddress> addresses_;
  std::size_t next_ = 0;
  lines::Descriptor socket_;
  lines::SteadyTime deadline_;
  bool connected_ = false;
  int error_ = 0;  // Why the last one failed.
};

/// Returns whether an error only means that there is nothing to do now.
bool would_block(int error);

}  // namespace rubric::forward
