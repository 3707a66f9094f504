#include "codec/lines/forward/sockets.h"

#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>

#include <cerrno>
#include <cstring>

#include "codec/lines/broken.h"

namespace rubric::forward {
namespace {

constexpr lines::Milliseconds kConnectTime{2000};

}  // namespace

void Connector::begin(lines::SteadyTime now) {
  next_ = 0;
  connected_ = false;
  try_next(now);
}

void Connector::try_next(lines::SteadyTime now) {
  while (next_ < addresses_.size()) {
    const SocketAddress& address = addresses_[next_++];
    lines::Descriptor made = lines::open_socket(address);
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
  throw lines::Broken(fmt::format("cannot connect: {}", std::strerror(error_)));
}

void Connector::go_on(bool writable, lines::SteadyTime now) {
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

lines::ByteStream Connector::take() {
  const int on = 1;  // Writes are whole packets already.
  ::setsockopt(socket_.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  ::setsockopt(socket_.get(), SOL_SOCKET, SO_KEEPALIVE, &on, sizeof on);
  return lines::ByteStream(std::move(socket_));
}

bool would_block(int error) { return error == EAGAIN || error == EWOULDBLOCK || error == EINTR; }

}  // namespace rubric::forward
