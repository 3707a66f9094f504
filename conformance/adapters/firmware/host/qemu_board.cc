#include "conformance/adapters/firmware/host/qemu_board.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <thread>
#include <utility>

#include "conformance/adapters/firmware/bench/records.h"
#include "conformance/adapters/firmware/host/board.h"

namespace rubric::firmware {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

// How long a board that takes the bench's time may say nothing, on a machine that is busy.
constexpr milliseconds kAnswerTime{20'000};
// A record that is under way must be handled before the next one.
constexpr milliseconds kRecordTime{20};

nanoseconds duration_of(Instant instant) {
  return nanoseconds(static_cast<std::int64_t>(static_cast<double>(instant) * 1e9 /
                                               static_cast<double>(kInstantsPerSecond)));
}

// A UART of the emulator, at its end of a pair of sockets.
std::string chardev(const char* id, int descriptor) {
  return fmt::format("socket,id={},fd={}", id, descriptor);
}

// Returns our end and the other, which a program that is started does not inherit.
std::pair<int, int> socket_pair() {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
    throw BoardBroken(std::strerror(errno));
  }
  return {ends[0], ends[1]};
}

// Detaches the child from standard input and output, which are rct/1's.
void leave_standard_input() {
  const int null = open("/dev/null", O_RDWR);
  dup2(null, STDIN_FILENO);
  dup2(null, STDOUT_FILENO);
}

// Ignores what comes while the power is off.
class NobodyListens final : public Listener {
  void link_byte(std::uint8_t) override {}
  void serial_byte(std::uint8_t) override {}
};

}  // namespace

QemuBoard::QemuBoard(std::string qemu, std::string elf_file, Clock clock)
    : qemu_(std::move(qemu)), elf_file_(std::move(elf_file)), clock_(clock) {}

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
  // What a UART has written is in our end's buffer at once, so it is there before what the firmware
  // writes to the other UART after it. TCP does not promise that.
  const auto [our_serial, serial] = socket_pair();
  const auto [our_link, link] = socket_pair();
  serial_ = our_serial;
  link_ = our_link;
  const std::string serial_device = chardev("serial", serial);
  const std::string link_device = chardev("link", link);
  emulator_ = fork();
  if (emulator_ == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    leave_standard_input();
    fcntl(serial, F_SETFD, 0);
    fcntl(link, F_SETFD, 0);
    execlp(qemu_.c_str(), qemu_.c_str(), "-M", "lm3s6965evb", "-display", "none", "-monitor",
           "none", "-chardev", serial_device.c_str(), "-serial", "chardev:serial", "-chardev",
           link_device.c_str(), "-serial", "chardev:link", "-kernel", elf_file_.c_str(), nullptr);
    _exit(127);
  }
  close(serial);
  close(link);
  if (emulator_ < 0) throw BoardBroken(std::strerror(errno));
  // The board's time begins when it says something: how long an emulator starts is the host's.
  pollfd waited{link_, POLLIN, 0};
  if (poll(&waited, 1, static_cast<int>(kAnswerTime.count())) <= 0) {
    throw BoardBroken(fmt::format("{} says nothing", qemu_));
  }
}

// Memory is kept, so the emulator runs on and the firmware resets its processor.
void QemuBoard::restart() {
  std::this_thread::sleep_for(kRecordTime);
  const std::uint8_t record[] = {1, static_cast<std::uint8_t>(ToBoard::kRestart)};
  put_link(record);
}

Instant QemuBoard::now() const {
  if (!has_clock()) return bench_now_;
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

// Slows bytes down in real time: the emulator takes them as fast as they come, firmware for 115200
// baud does not.
void QemuBoard::put_serial(Bytes bytes) {
  if (!has_clock()) return put(serial_, bytes);
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

// Waits until the board says something, and passes it on.
void QemuBoard::hear(nanoseconds longest, Listener& listener) {
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(longest);
  const timespec wait{seconds.count(), static_cast<long>((longest - seconds).count())};
  std::array<pollfd, 2> waited{{{link_, POLLIN, 0}, {serial_, POLLIN, 0}}};
  const int ready = ppoll(waited.data(), waited.size(), &wait, nullptr);
  if (ready == 0 && !has_clock()) throw BoardBroken(fmt::format("{} says nothing", qemu_));
  if (ready <= 0) return;
  read_some(link_, [&](std::uint8_t byte) { listener.link_byte(byte); });
  // What it wrote to the serial line before those bytes has come by now, whatever ppoll saw.
  read_some(serial_, [&](std::uint8_t byte) { listener.serial_byte(byte); });
}

void QemuBoard::run(Instant end, Listener& listener) {
  if (!has_clock()) return hear(kAnswerTime, listener), void();
  stopped_ = false;
  while (!stopped_) {
    const auto left = begin_ + duration_of(end) - Steady::now();
    if (left <= nanoseconds(0)) return;
    hear(left, listener);
  }
}

void QemuBoard::wait(Instant end) {
  NobodyListens nobody;
  while (has_clock() && now() < end) run(end, nobody);
  bench_now_ = std::max(bench_now_, end);
}

}  // namespace rubric::firmware
