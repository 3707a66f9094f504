#include "codec/lines/stream.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <stdexcept>
#include <thread>

#include "codec/lines/address.h"
#include "codec/lines/broken.h"

namespace rubric::lines {
namespace {

using std::chrono::steady_clock;

constexpr Milliseconds kRetry{50};

// Returns whether the descriptor is ready before the deadline; continues after interruptions.
bool wait_for(int fd, short events, SteadyTime deadline) {
  while (true) {
    const auto left = std::chrono::ceil<Milliseconds>(deadline - steady_clock::now());
    const int left_ms = static_cast<int>(std::clamp<std::int64_t>(left.count(), 0, 1'000'000));
    pollfd one{fd, events, 0};
    const int ready = ::poll(&one, 1, left_ms);
    if (ready > 0) return true;
    if (ready < 0 && errno != EINTR) throw Broken(std::strerror(errno));
    if (left_ms == 0) return false;
  }
}

bool would_block(int error) { return error == EAGAIN || error == EWOULDBLOCK || error == EINTR; }

ByteStream stream_of(Descriptor connection) {
  const int on = 1;  // Packets are short and each is waited for.
  ::setsockopt(connection.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  return ByteStream(std::move(connection));
}

// Connects once. Returns 0, or the error.
int connect_once(const Descriptor& connection, const SocketAddress& address, SteadyTime deadline) {
  if (!connection.is_open()) return errno;
  if (::connect(connection.get(), address.get(), address.size_bytes) == 0) return 0;
  if (errno != EINPROGRESS && errno != EINTR) return errno;
  if (!wait_for(connection.get(), POLLOUT, deadline)) return ETIMEDOUT;
  int error = 0;
  socklen_t size = sizeof error;
  ::getsockopt(connection.get(), SOL_SOCKET, SO_ERROR, &error, &size);
  return error;
}

}  // namespace

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
  std::swap(fd_, other.fd_);
  return *this;
}

void Descriptor::close() {
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
}

ByteStream::ByteStream(Descriptor descriptor) : descriptor_(std::move(descriptor)) {
  const int fd = descriptor_.get();
  ::fcntl(fd, F_SETFL, ::fcntl(fd, F_GETFL) | O_NONBLOCK);
}

void ByteStream::write(Bytes bytes, SteadyTime deadline) { write_all(bytes, deadline, false); }

void ByteStream::write_or_keep(Bytes bytes, SteadyTime deadline) {
  write_all(bytes, deadline, true);
}

void ByteStream::write_all(Bytes bytes, SteadyTime deadline, bool keep) {
  std::size_t sent = 0;
  while (sent < bytes.size()) {
    const Bytes rest(bytes.data() + sent, bytes.size() - sent);
    const std::size_t count = keep ? send_some(rest) : write_some(rest);
    sent += count;
    if (count == 0 && !wait_for(descriptor_.get(), POLLOUT, deadline)) {
      throw Broken("the line takes no more bytes");
    }
  }
}

std::size_t ByteStream::write_some(Bytes bytes) {
  try {
    return send_some(bytes);
  } catch (const Broken&) {
    close();
    throw;
  }
}

std::size_t ByteStream::send_some(Bytes bytes) const {
  if (!is_open()) throw Broken("the line is closed");
  const int fd = descriptor_.get();
  ssize_t count = ::send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  if (count < 0 && errno == ENOTSOCK) count = ::write(fd, bytes.data(), bytes.size());
  if (count >= 0) return static_cast<std::size_t>(count);
  if (would_block(errno)) return 0;
  throw Broken(fmt::format("the line broke: {}", std::strerror(errno)));
}

std::size_t ByteStream::read(MutableBytes out, SteadyTime deadline) {
  while (true) {
    if (!is_open()) throw Broken("the line is closed");
    const ssize_t count = ::read(descriptor_.get(), out.data(), out.size());
    if (count > 0) return static_cast<std::size_t>(count);
    if (count == 0 || !would_block(errno)) {
      const std::string why = count == 0 ? "the other end closed it" : std::strerror(errno);
      close();
      throw Broken("the line broke: " + why);
    }
    if (!wait_for(descriptor_.get(), POLLIN, deadline)) return 0;
  }
}

void ByteStream::end_output() {
  if (is_open()) ::shutdown(descriptor_.get(), SHUT_WR);
}

HostPort read_host_port(std::string_view text) {
  HostPort out;
  const std::size_t colon = text.rfind(':');
  out.host = colon == std::string_view::npos ? kThisHost : text.substr(0, colon);
  const std::string_view port = colon == std::string_view::npos ? text : text.substr(colon + 1);
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), out.port);
  if (error != std::errc() || end != port.data() + port.size() || out.port == 0 ||
      out.host.empty()) {
    throw std::invalid_argument(fmt::format("'{}' is not a HOST:PORT", text));
  }
  return out;
}

ByteStream connect_tcp(const HostPort& to, SteadyTime deadline) {
  while (true) {
    int error = 0;
    for (const SocketAddress& address : resolve(to.host, to.port, false)) {
      Descriptor connection = open_socket(address);
      error = connect_once(connection, address, deadline);
      if (error == 0) return stream_of(std::move(connection));
    }
    if (steady_clock::now() + kRetry >= deadline) {
      throw Broken(
          fmt::format("cannot connect to {}:{}: {}", to.host, to.port, std::strerror(error)));
    }
    std::this_thread::sleep_for(kRetry);
  }
}

ByteStream Listener::accept(SteadyTime deadline) {
  if (!descriptor_.is_open()) descriptor_ = listen_at(at_.host, at_.port);
  while (true) {
    const int fd = ::accept4(descriptor_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (fd >= 0) return stream_of(Descriptor(fd));
    if (!would_block(errno) && errno != ECONNABORTED) throw Broken(std::strerror(errno));
    if (!wait_for(descriptor_.get(), POLLIN, deadline)) {
      throw Broken(fmt::format("nobody connects to {}:{}", at_.host, at_.port));
    }
  }
}

using std::chrono::steady_clock;

bool StreamLine::open(SteadyTime deadline) {
  if (stream_.is_open()) {
    try {
      while (read_some(steady_clock::now()) && steady_clock::now() < deadline) {
      }
      return false;
    } catch (const Broken&) {  // It has gone since.
      close();
    }
  }
  stream_ = connect_(deadline);
  try {
    begin(deadline);
  } catch (const Broken&) {
    close();
    throw;
  }
  return true;
}

bool StreamLine::read_some(SteadyTime deadline) {
  std::uint8_t bytes[4096];
  const std::size_t count = stream_.read(MutableBytes(bytes, sizeof bytes), deadline);
  take(Bytes(bytes, count));
  return count > 0;
}

void StreamLine::broken(const std::string& why) {
  close();
  throw Broken(why);
}

}  // namespace rubric::lines
