// Real lines on this host, for tests.
#pragma once

#include <fcntl.h>
#include <netinet/in.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <atomic>
#include <stdexcept>
#include <string>

#include "codec/lines/forwarder.h"
#include "codec/lines/serial.h"
#include "conformance/test/targets/real_node.h"

namespace rubric::targets {

/// Returns a port that nobody uses, another one each time, also to several threads at once. Below
/// those that connections of this host take by themselves.
inline std::uint16_t free_port() {
  constexpr int kFirst = 10'000;
  constexpr int kPorts = 20'000;
  static std::atomic<int> next = ::getpid() * 100;  // Far from those of another test.
  for (int tried = 0; tried < kPorts; ++tried) {
    const auto port = static_cast<std::uint16_t>(kFirst + next++ % kPorts);
    const lines::Descriptor socket(::socket(AF_INET, SOCK_STREAM, 0));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(port);
    auto* const any = reinterpret_cast<sockaddr*>(&address);
    if (::bind(socket.get(), any, sizeof address) == 0) return port;
  }
  throw std::runtime_error("no port is free");
}

inline machine::Config config_of(machine::Role role, std::uint16_t island) {
  machine::Config config;
  config.role = role;
  config.id = role == machine::Role::kSink ? 1 : 0;
  config.island = island;
  return config;
}

inline std::unique_ptr<lines::PacketLine> forwarder_at(std::uint16_t port) {
  auto listener = std::make_shared<lines::Listener>(lines::HostPort{"127.0.0.1", port});
  return std::make_unique<lines::ForwarderLine>(
      [listener](lines::SteadyTime by) { return listener->accept(by); });
}
inline std::unique_ptr<lines::PacketLine> forwarder_to(std::uint16_t port) {
  return std::make_unique<lines::ForwarderLine>([port](lines::SteadyTime by) {
    return lines::connect_tcp({"127.0.0.1", port}, by);
  });
}

inline std::unique_ptr<MoteEnd> mote_at(std::uint16_t port) {
  auto listener = std::make_shared<lines::Listener>(lines::HostPort{"127.0.0.1", port});
  return std::make_unique<MoteEnd>(
      [listener](lines::SteadyTime by) { return listener->accept(by); });
}

/// A pseudo terminal in place of a serial device.
class Terminal {
 public:
  Terminal() : master_(::posix_openpt(O_RDWR | O_NOCTTY)) {
    if (!master_.is_open() || ::grantpt(master_.get()) != 0 || ::unlockpt(master_.get()) != 0) {
      throw std::runtime_error("no pseudo terminal");
    }
    char name[100];
    if (::ptsname_r(master_.get(), name, sizeof name) == 0) name_ = name;
    slave_ = lines::Descriptor(::open(name_.c_str(), O_RDWR | O_NOCTTY));  // So that it stays.
  }
  const std::string& name() const { return name_; }
  std::unique_ptr<MoteEnd> mote_end() const {
    return std::make_unique<MoteEnd>([this](lines::SteadyTime) {
      return lines::ByteStream(lines::Descriptor(::dup(master_.get())));
    });
  }
  termios settings() const {
    termios out{};
    ::tcgetattr(slave_.get(), &out);
    return out;
  }

 private:
  lines::Descriptor master_;
  lines::Descriptor slave_;
  std::string name_;
};

/// Sends bytes through a pseudo terminal of its own all the time. On a busy host the kernel may
/// hold back what is in one for seconds; a node behind one then breaks rules that it keeps.
class TerminalWatch {
 public:
  TerminalWatch() : thread_([this] { watch(); }) {}
  ~TerminalWatch() {
    stop_ = true;
    thread_.join();
  }
  lines::Milliseconds worst() const { return lines::Milliseconds(worst_ms_); }

 private:
  void watch() {
    const Terminal terminal;
    const std::unique_ptr<MoteEnd> end = terminal.mote_end();
    end->open(std::chrono::steady_clock::now());
    lines::ByteStream host = lines::open_serial_device(terminal.name(), 115200);
    while (!stop_) {
      const auto sent = std::chrono::steady_clock::now();
      end->send({0}, sent + kMax);
      std::uint8_t room[100];
      host.read(room, sent + kMax);
      const auto took = std::chrono::steady_clock::now() - sent;
      worst_ms_ = std::max<std::int64_t>(
          worst_ms_, std::chrono::duration_cast<lines::Milliseconds>(took).count());
      std::this_thread::sleep_for(lines::Milliseconds(5));
    }
  }

  static constexpr lines::Milliseconds kMax{10'000};
  std::atomic<bool> stop_{false};
  std::atomic<std::int64_t> worst_ms_{0};
  std::thread thread_;
};

}  // namespace rubric::targets
