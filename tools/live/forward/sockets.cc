#include "tools/live/forward/sockets.h"

#include <netinet/in.h>
#include <netinet/tcp.h>

#include <cerrno>
#include <cstring>

#include <fmt/format.h>

#include "conformance/runner/target.h"

namespace rubric::forward {
namespace {

using runner::TargetBroken;

constexpr attach::Milliseconds kConnectTime{2000};

}  // namespace

void Connector::begin(attach::SteadyTime now) {
  next_ = 0;
  connected_ = false;
  try_next(now);
}

void Connector::try_next(attach::SteadyTime now) {
  while (next_ < addresses_.size()) {
    const SocketAddress& address = addresses_[next_++];
    attach::Descriptor made = attach::open_socket(address);
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
