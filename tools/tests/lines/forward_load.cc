// Loads `rubric forward` as a busy serial line and many clients would, checks that every client
// gets every packet in order, and measures the time. Prints one JSON object; exits with 0 if
// nothing was lost and the forwarder's memory did not grow.
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include "codec/containers/sf_reader.h"
#include "codec/generated/tinyos/am_header.h"
#include "codec/lines/broken.h"
#include "codec/lines/forward/sockets.h"
#include "codec/lines/stream.h"
#include "codec/runtime/hdlc.h"
#include "tools/cli/command.h"

namespace rubric::forward {
namespace {

using lines::Descriptor;
using std::chrono::duration;
using std::chrono::steady_clock;

constexpr std::size_t kHeaderBytes = tinyos::AmHeaderView::kMaxSizeBytes;
constexpr std::size_t kStampBytes = 16;   // The packet's number, and when it was sent.
constexpr std::size_t kLatencies = 4096;  // A millisecond each; the last one holds the rest.
constexpr std::chrono::seconds kPatience{30};

struct LoadOptions {
  std::string program;
  std::size_t clients = 32;
  std::size_t stalled = 0;      // More clients, which read nothing and are to be cut off.
  std::uint64_t rate = 10'000;  // Packets a second.
  double seconds = 60;
  std::size_t packet_bytes = 122;  // RUBICON's net_msg.
  double warm_up = 0.2;            // Part of the time before memory is measured.
  std::uint64_t growth_kib_max = 512;
};

struct Measured {
  std::uint64_t sent = 0;
  double seconds = 0;
  std::uint64_t rss_warm_kib = 0;
  std::uint64_t rss_max_kib = 0;  // After the warm-up.
  std::uint64_t rss_end_kib = 0;
  double cpu_seconds = 0;
  std::array<std::uint64_t, kLatencies> latency_ms{};
  double latency_ms_max = 0;
};

[[noreturn]] void give_up(const std::string& why) {
  fmt::print(stderr, "forward_load: {}\n", why);
  std::exit(2);
}

/// The forwarder as a child process.
class Child {
 public:
  Child(const std::string& program, const std::string& source, std::size_t clients) {
    int out[2];
    if (::pipe2(out, O_CLOEXEC) != 0) give_up("no pipe");
    pid_ = ::fork();
    if (pid_ == 0) {
      ::dup2(out[1], 1);
      const std::string count = std::to_string(clients);
      ::execl(program.c_str(), "rubric", "forward", source.c_str(), "--port", "0", "--clients",
              count.c_str(), static_cast<char*>(nullptr));
      ::_exit(127);
    }
    ::close(out[1]);
    out_ = Descriptor(out[0]);
  }
  ~Child() {
    if (pid_ > 0) end();
  }

  /// Returns the port of "listening on 127.0.0.1:43211".
  std::uint16_t port() {
    std::string line;
    char c = 0;
    while (::read(out_.get(), &c, 1) == 1 && c != '\n') line += c;
    const std::size_t colon = line.rfind(':');
    if (colon == line.npos) give_up(fmt::format("the forwarder says '{}'", line));
    return static_cast<std::uint16_t>(std::stoi(line.substr(colon + 1)));
  }

  std::uint64_t rss_kib() const {
    std::ifstream file(fmt::format("/proc/{}/statm", pid_));
    std::uint64_t pages = 0;
    file >> pages >> pages;
    return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)) / 1024;
  }

  /// Ends it as Ctrl-C does. Returns CPU seconds; -1 if it did not end well.
  double end() {
    ::kill(pid_, SIGINT);
    int status = 0;
    rusage usage{};
    ::wait4(pid_, &status, 0, &usage);
    pid_ = -1;
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) return -1;
    const auto seconds = [](const timeval& time) {
      return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
  }

 private:
  pid_t pid_ = -1;
  Descriptor out_;
};

/// One client, which checks its input.
class Reader {
 public:
  explicit Reader(Descriptor socket) : socket_(std::move(socket)), room_(64 * 1024) {}

  int fd() const { return socket_.get(); }
  std::uint64_t packets() const { return next_; }
  std::uint64_t wrong() const { return wrong_; }
  bool is_open() const { return socket_.is_open(); }

  void read(const LoadOptions& options, Measured& measured) {
    const ssize_t count = ::read(fd(), room_.data() + used_, room_.size() - used_);
    if (count < 0 && would_block(errno)) return;
    if (count <= 0) return socket_.close();
    used_ += static_cast<std::size_t>(count);
    std::size_t at = 0;
    if (!greeted_ && used_ >= 2) {
      greeted_ = true;
      wrong_ += room_[0] != kSfMagic || room_[1] != kSfVersion;
      at = 2;
    }
    const double now = now_seconds();
    for (; greeted_ && at < used_ && at + room_[at] < used_; at += std::size_t{1} + room_[at]) {
      if (room_[at] != options.packet_bytes) {
        ++wrong_;
        return socket_.close();  // There is no finding the next one.
      }
      take(room_.data() + at + 1 + kHeaderBytes, now, measured);
    }
    std::memmove(room_.data(), room_.data() + at, used_ - at);
    used_ -= at;
  }

  static double now_seconds() {
    return duration<double>(steady_clock::now().time_since_epoch()).count();
  }

 private:
  void take(const std::uint8_t* stamp, double now, Measured& measured) {
    std::uint64_t number = 0;
    double sent = 0;
    std::memcpy(&number, stamp, sizeof number);
    std::memcpy(&sent, stamp + sizeof number, sizeof sent);
    wrong_ += number != next_;
    next_ = number + 1;
    const double ms = std::max(0.0, 1e3 * (now - sent));
    ++measured.latency_ms[std::min(kLatencies - 1, static_cast<std::size_t>(ms))];
    measured.latency_ms_max = std::max(measured.latency_ms_max, ms);
  }

  Descriptor socket_;
  std::vector<std::uint8_t> room_;
  std::size_t used_ = 0;
  std::uint64_t next_ = 0;
  std::uint64_t wrong_ = 0;
  bool greeted_ = false;
};

/// The serial line, which sends a given number of packets a second.
class Line {
 public:
  Line(Descriptor socket, const LoadOptions& options)
      : socket_(std::move(socket)), packet_(options.packet_bytes) {
    tinyos::AmHeaderLayout::LengthAt::store(
        packet_.data(), static_cast<std::uint8_t>(options.packet_bytes - kHeaderBytes));
    for (std::size_t i = kHeaderBytes + kStampBytes; i < packet_.size(); ++i) {
      packet_[i] = static_cast<std::uint8_t>(0x70 + i % 16);  // Flags and escapes among them.
    }
  }

  int fd() const { return socket_.get(); }
  bool blocked() const { return !waiting_.empty(); }

  /// Sends up to the packet of this number. Bytes that the socket does not take have to wait.
  void send_to(std::uint64_t number, Measured& measured) {
    while (waiting_.size() < kEnough && measured.sent < number) {
      const double now = Reader::now_seconds();
      std::memcpy(packet_.data() + kHeaderBytes, &measured.sent, sizeof measured.sent);
      std::memcpy(packet_.data() + kHeaderBytes + 8, &now, sizeof now);
      std::uint8_t frame[hdlc_frame_room(256)];
      const auto size = write_serial_packet(Bytes(packet_.data(), packet_.size()),
                                            MutableBytes(frame, sizeof frame));
      waiting_.insert(waiting_.end(), frame, frame + *size);
      ++measured.sent;
    }
    const ssize_t count = ::send(fd(), waiting_.data(), waiting_.size(), MSG_NOSIGNAL);
    if (count > 0) waiting_.erase(waiting_.begin(), waiting_.begin() + count);
    if (count < 0 && !would_block(errno)) give_up("the forwarder has left the line");
  }

 private:
  // A turn writes less than it reads, so that the clients keep up with any line.
  static constexpr std::size_t kEnough = 32 * 1024;

  Descriptor socket_;
  std::vector<std::uint8_t> packet_;
  std::vector<std::uint8_t> waiting_;
};

Descriptor accepted(const Descriptor& listener) {
  pollfd one{listener.get(), POLLIN, 0};
  const std::chrono::milliseconds patience = kPatience;
  if (::poll(&one, 1, static_cast<int>(patience.count())) != 1) give_up("the forwarder is late");
  return Descriptor(::accept4(listener.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
}

Descriptor connected(std::uint16_t port) {
  const SocketAddress to = resolve("127.0.0.1", port, false).front();
  Descriptor out(::socket(to.family(), SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (::connect(out.get(), to.get(), to.size_bytes) != 0) give_up("a client cannot connect");
  // A client that has read the forwarder's greeting is accepted.
  std::uint8_t hello[] = {kSfMagic, kSfVersion};
  if (::send(out.get(), hello, sizeof hello, MSG_NOSIGNAL) != 2 ||
      ::recv(out.get(), hello, sizeof hello, MSG_PEEK | MSG_WAITALL) != 2) {
    give_up("a client is not greeted");
  }
  ::fcntl(out.get(), F_SETFL, O_NONBLOCK);
  return out;
}

/// Writes and reads until all has been sent and every client has it, or none has read for long.
void run(const LoadOptions& options, const Child& child, Line& line, std::vector<Reader>& readers,
         Measured& measured) {
  const auto rate = static_cast<double>(options.rate);
  const auto total = static_cast<std::uint64_t>(options.seconds * rate);
  const double start = Reader::now_seconds();
  double heard = start;
  double looked = start;
  std::vector<pollfd> polled;
  for (bool left = true; left;) {
    const double now = Reader::now_seconds();
    const auto due = static_cast<std::uint64_t>((now - start) * rate);
    line.send_to(std::min(due, total), measured);
    polled.assign(1, {line.fd(), static_cast<short>(line.blocked() ? POLLOUT : 0), 0});
    left = measured.sent < total || line.blocked();
    for (const Reader& reader : readers) {
      polled.push_back({reader.fd(), POLLIN, 0});
      left = left || (reader.is_open() && reader.packets() < total);
    }
    if (measured.sent < total) measured.seconds = now - start;
    ::poll(polled.data(), polled.size(), 1);
    for (std::size_t i = 0; i < readers.size(); ++i) {
      if (polled[i + 1].revents == 0) continue;
      readers[i].read(options, measured);
      heard = now;
    }
    if (now - heard > duration<double>(kPatience).count()) return;
    if (now - looked < 0.1) continue;
    looked = now;
    measured.rss_end_kib = child.rss_kib();
    if (now - start < options.warm_up * options.seconds) {
      measured.rss_warm_kib = measured.rss_end_kib;
    } else {
      measured.rss_max_kib = std::max(measured.rss_max_kib, measured.rss_end_kib);
    }
  }
}

// Reads everything there is; only the forwarder itself can end it.
bool is_open(const Descriptor& socket) {
  std::uint8_t room[16 * 1024];
  ssize_t count = 1;
  while (count > 0) count = ::recv(socket.get(), room, sizeof room, 0);
  return count < 0 && would_block(errno);
}

std::size_t latency_of(const Measured& measured, double share) {
  std::uint64_t all = 0;
  for (const std::uint64_t count : measured.latency_ms) all += count;
  std::uint64_t sum = 0;
  for (std::size_t ms = 0; ms < kLatencies; ++ms) {
    sum += measured.latency_ms[ms];
    if (static_cast<double>(sum) >= share * static_cast<double>(all)) return ms + 1;
  }
  return kLatencies;
}

int run(const LoadOptions& options) {
  std::signal(SIGPIPE, SIG_IGN);
  const Descriptor listener = listen_at("127.0.0.1", 0);
  Child child(options.program,
              fmt::format("network@127.0.0.1:{}", address_here(listener.get()).port()),
              options.clients + options.stalled);
  Line line(accepted(listener), options);
  const std::uint16_t port = child.port();
  std::vector<Reader> readers;
  for (std::size_t i = 0; i < options.clients; ++i) readers.emplace_back(connected(port));
  std::vector<Descriptor> stalled;
  for (std::size_t i = 0; i < options.stalled; ++i) stalled.push_back(connected(port));
  Measured measured;
  run(options, child, line, readers, measured);
  const auto still_served = std::count_if(stalled.begin(), stalled.end(), is_open);
  measured.cpu_seconds = child.end();
  std::uint64_t lost = 0;
  std::uint64_t wrong = 0;
  for (const Reader& reader : readers) {
    lost += measured.sent - std::min(measured.sent, reader.packets());
    wrong += reader.wrong();
  }
  const std::uint64_t growth =
      measured.rss_max_kib - std::min(measured.rss_max_kib, measured.rss_warm_kib);
  fmt::print(
      "{{\"clients\": {}, \"packet_bytes\": {}, \"packets\": {}, \"seconds\": {:.2f}, "
      "\"packets_per_second\": {:.0f}, \"lost\": {}, \"out_of_order\": {}, "
      "\"rss_warm_kib\": {}, \"rss_max_kib\": {}, \"rss_end_kib\": {}, "
      "\"cpu_seconds\": {:.2f}, \"latency_ms_50\": {}, \"latency_ms_99\": {}, "
      "\"latency_ms_max\": {:.1f}, \"stalled\": {}, \"not_cut_off\": {}}}\n",
      options.clients, options.packet_bytes, measured.sent, measured.seconds,
      static_cast<double>(measured.sent) / std::max(measured.seconds, 1e-3), lost, wrong,
      measured.rss_warm_kib, measured.rss_max_kib, measured.rss_end_kib, measured.cpu_seconds,
      latency_of(measured, 0.5), latency_of(measured, 0.99), measured.latency_ms_max,
      options.stalled, still_served);
  const bool good = lost == 0 && wrong == 0 && still_served == 0 && measured.cpu_seconds >= 0 &&
                    measured.rss_warm_kib > 0 && growth <= options.growth_kib_max;
  return good ? 0 : 1;
}

}  // namespace
}  // namespace rubric::forward

int main(int argc, char** argv) {
  rubric::cli::Command program("forward_load",
                               "Loads 'rubric forward' with a busy line and many clients, checks "
                               "and measures.");
  rubric::forward::LoadOptions options;
  program.add_option("RUBRIC", options.program, "The program").required();
  program.add_option("--clients", options.clients);
  program.add_option("--stalled", options.stalled, "More clients, which read nothing");
  program.add_option("--rate", options.rate, "Packets a second");
  program.add_option("--seconds", options.seconds);
  program.add_option("--bytes", options.packet_bytes, "Bytes of a packet").between(24, 252);
  program.add_option("--growth", options.growth_kib_max,
                     "KiB by which its memory may grow when warm");
  program.exit_code_of([&] {
    try {
      return rubric::forward::run(options);
    } catch (const rubric::lines::Broken& broken) {
      rubric::forward::give_up(broken.what());
    }
  });
  return program.parse_and_run(argc, argv);
}
