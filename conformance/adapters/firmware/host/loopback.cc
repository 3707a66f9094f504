#include "conformance/adapters/firmware/host/loopback.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "conformance/adapters/firmware/host/board.h"

namespace rubric::firmware {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kAskAgain{20};

}  // namespace

LoopbackPort::LoopbackPort() {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  auto* const any = reinterpret_cast<sockaddr*>(&address);
  listener_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (listener_ < 0) throw BoardBroken(std::strerror(errno));
  if (bind(listener_, any, size) != 0 || listen(listener_, 1) != 0 ||
      getsockname(listener_, any, &size) != 0) {
    const int error = errno;
    close(listener_);
    throw BoardBroken(std::strerror(error));
  }
  port_ = ntohs(address.sin_port);
}

LoopbackPort::~LoopbackPort() { close(listener_); }

int LoopbackPort::accept(milliseconds wait) const {
  pollfd waited{listener_, POLLIN, 0};
  if (poll(&waited, 1, static_cast<int>(wait.count())) <= 0) return -1;
  const int connection = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
  const int at_once = 1;  // Bytes of a line do not wait for more.
  if (connection >= 0) {
    setsockopt(connection, IPPROTO_TCP, TCP_NODELAY, &at_once, sizeof at_once);
  }
  return connection;
}

int LoopbackPort::accept(milliseconds wait, const std::function<bool()>& is_hopeless) const {
  const auto end = std::chrono::steady_clock::now() + wait;
  do {
    const int connection = accept(kAskAgain);
    if (connection >= 0) return connection;
  } while (!is_hopeless() && std::chrono::steady_clock::now() < end);
  return -1;
}

}  // namespace rubric::firmware
