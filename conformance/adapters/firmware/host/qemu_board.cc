#include "conformance/adapters/firmware/host/qemu_board.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <thread>

#include "conformance/adapters/firmware/bench/records.h"
#include "conformance/adapters/firmware/host/board.h"

namespace rubric::firmware {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

// How long the emulator may take to connect its UARTs, on a machine that is busy.
constexpr std::chrono::seconds kConnectTime{20};
// A record that is under way must be handled before the next one.
constexpr std::chrono::milliseconds kRecordTime{20};

nanoseconds duration_of(Instant instant) {
  return nanoseconds(static_cast<std::int64_t>(static_cast<double>(instant) * 1e9 /
                                               static_cast<double>(kInstantsPerSecond)));
}

// A UART of the emulator, which connects to `port`.
std::string chardev(const char* id, const LoopbackPort& port) {
  return fmt::format("socket,id={},host=127.0.0.1,port={},server=off,nodelay=on", id, port.port());
}

// Detaches the child from standard input and output, which are rct/1's.
void leave_standard_input() {
  const int null = open("/dev/null", O_RDWR);
  dup2(null, STDIN_FILENO);
  dup2(null, STDOUT_FILENO);
}

constexpr milliseconds kAskAgain{20};

}  // namespace

QemuBoard::QemuBoard(std::string qemu, std::string elf_file)
    : qemu_(std::move(qemu)), elf_file_(std::move(elf_file)) {}

QemuBoard::~QemuBoard() { end_emulator(); }

void QemuBoard::end_emulator() {
  if (emulator_ >= 0) {
    kill(emulator_, SIGKILL);
    waitpid(emulator_, nullptr, 0);
  }
  for (const int connection : {link_, serial_}) {
    if (connection >= 0) close(connection);
  }
  emulator_ = link_ = serial_ = -1;
}

void QemuBoard::power_on() {
  end_emulator();
  const LoopbackPort serial;
  const LoopbackPort link;
  const std::string serial_device = chardev("serial", serial);
  const std::string link_device = chardev("link", link);
  emulator_ = fork();
  if (emulator_ < 0) throw BoardBroken(std::strerror(errno));
  if (emulator_ == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    leave_standard_input();
    execlp(qemu_.c_str(), qemu_.c_str(), "-M", "lm3s6965evb", "-display", "none", "-monitor",
           "none", "-chardev", serial_device.c_str(), "-serial", "chardev:serial", "-chardev",
           link_device.c_str(), "-serial", "chardev:link", "-kernel", elf_file_.c_str(), nullptr);
    _exit(127);
  }
  serial_ = connected(serial);
  link_ = connected(link);
}

int QemuBoard::connected(const LoopbackPort& port) {
  const auto has_ended = [this] {
    if (waitpid(emulator_, nullptr, WNOHANG) != emulator_) return false;
    emulator_ = -1;
    return true;
  };
  const int connection = port.accept(kConnectTime, has_ended);
  if (connection >= 0) return connection;
  const bool ended = emulator_ < 0;
  end_emulator();
  throw BoardBroken(fmt::format("{} {}", qemu_, ended ? "has ended" : "does not connect"));
}

// Memory is kept, so the emulator runs on and the firmware resets its processor.
void QemuBoard::restart(Instant) {
  std::this_thread::sleep_for(kRecordTime);
  const std::uint8_t record[] = {1, static_cast<std::uint8_t>(ToBoard::kRestart)};
  put_link(record);
}

Instant QemuBoard::now() const {
  const auto passed = std::chrono::duration_cast<nanoseconds>(Steady::now() - begin_);
  return static_cast<Instant>(static_cast<double>(passed.count()) * 1e-9 *
                              static_cast<double>(kInstantsPerSecond));
}

void QemuBoard::put(int descriptor, Bytes bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = send(descriptor, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) throw BoardBroken("the emulator has gone");
    bytes = bytes.from(static_cast<std::size_t>(sent));
  }
}

// Slows bytes down: the emulator takes them as fast as they come, firmware for 115200 baud does
// not.
void QemuBoard::put_serial(Bytes bytes) {
  constexpr nanoseconds kByteTime{10'000'000'000 / 115'200};
  std::this_thread::sleep_until(serial_free_);
  serial_free_ = Steady::now() + kByteTime * static_cast<int>(bytes.size());
  put(serial_, bytes);
}

template <class Take>
void QemuBoard::read_some(int descriptor, Take take) {
  std::array<std::uint8_t, 256> bytes{};
  const ssize_t size = recv(descriptor, bytes.data(), bytes.size(), MSG_DONTWAIT);
  if (size < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (size <= 0) throw BoardBroken(fmt::format("{} has ended", qemu_));
  for (ssize_t i = 0; i < size; ++i) take(bytes[static_cast<std::size_t>(i)]);
}

void QemuBoard::run(Instant end, Listener& listener) {
  stopped_ = false;
  while (!stopped_) {
    const auto left = begin_ + duration_of(end) - Steady::now();
    if (left <= nanoseconds(0)) return;
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(left);
    const timespec wait{seconds.count(), static_cast<long>((left - seconds).count())};
    std::array<pollfd, 2> waited{{{link_, POLLIN, 0}, {serial_, POLLIN, 0}}};
    if (ppoll(waited.data(), waited.size(), &wait, nullptr) <= 0) continue;
    if (waited[0].revents != 0) {
      read_some(link_, [&](std::uint8_t byte) { listener.link_byte(byte); });
    }
    if (waited[1].revents != 0) {
      read_some(serial_, [&](std::uint8_t byte) { listener.serial_byte(byte); });
    }
  }
}

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
