// rct/1 for firmware of a Cortex-M3 in QEMU.
#include <fcntl.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <memory>
#include <string>

#include "conformance/adapters/firmware/host/bridge.h"
#include "conformance/adapters/firmware/host/qemu_board.h"
#include "conformance/adapters/firmware/host/session.h"

namespace {

using namespace rubric::firmware;
using rubric::Bytes;

constexpr const char* kUsage =
    "usage: firmware_arm [--real-time] ELF...\n"
    "       firmware_arm --serial-device ISLAND ELF\n"
    "       firmware_arm --serial-tcp ISLAND ELF\n"
    "Speaks rct/1; starts the ELF file whose role and channels are asked for. Its time is "
    "virtual,\n"
    "or with --real-time that of the processor's clock. Or starts a sink and prints the name of a\n"
    "device, or tcp:HOST:PORT, which is its serial line until standard input ends.\n"
    "The emulator is $QEMU_SYSTEM_ARM, else qemu-system-arm.\n";

// The line's other end. Its users may come and go.
class Device {
 public:
  virtual ~Device() = default;
  virtual std::string name() const = 0;
  virtual void put(std::uint8_t byte) = 0;
  // Returns the bytes at hand without waiting.
  virtual std::size_t take(std::uint8_t* bytes, std::size_t max) = 0;
};

bool has_bytes(int descriptor) {
  pollfd waited{descriptor, POLLIN, 0};
  return poll(&waited, 1, 0) > 0;
}

// A pseudo terminal that changes no byte. The slave stays open for later users.
class Terminal : public Device {
 public:
  Terminal() {
    master_ = posix_openpt(O_RDWR | O_NOCTTY);
    if (master_ < 0 || grantpt(master_) != 0 || unlockpt(master_) != 0) {
      throw BoardBroken(std::strerror(errno));
    }
    slave_ = open(ptsname(master_), O_RDWR | O_NOCTTY);
    termios settings{};
    if (slave_ < 0 || tcgetattr(slave_, &settings) != 0) throw BoardBroken(std::strerror(errno));
    cfmakeraw(&settings);
    tcsetattr(slave_, TCSANOW, &settings);
  }
  ~Terminal() override {
    close(slave_);
    close(master_);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  std::string name() const override { return ptsname(master_); }
  void put(std::uint8_t byte) override {
    if (write(master_, &byte, 1) != 1) throw BoardBroken(std::strerror(errno));
  }
  std::size_t take(std::uint8_t* bytes, std::size_t max) override {
    if (!has_bytes(master_)) return 0;
    const ssize_t size = read(master_, bytes, max);
    if (size <= 0) throw BoardBroken("the terminal has gone");
    return static_cast<std::size_t>(size);
  }

 private:
  int master_ = -1;
  int slave_ = -1;
};

// One connection at a time. Bytes without a receiver are lost, as on a line.
class TcpLine : public Device {
 public:
  TcpLine() {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto* const any = reinterpret_cast<sockaddr*>(&address);
    listener_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (listener_ < 0 || bind(listener_, any, size) != 0 || listen(listener_, 1) != 0 ||
        getsockname(listener_, any, &size) != 0) {
      throw BoardBroken(std::strerror(errno));
    }
    port_ = ntohs(address.sin_port);
  }
  ~TcpLine() override {
    hang_up();
    close(listener_);
  }
  TcpLine(const TcpLine&) = delete;
  TcpLine& operator=(const TcpLine&) = delete;

  std::string name() const override { return fmt::format("tcp:127.0.0.1:{}", port_); }
  void put(std::uint8_t byte) override {
    if (user_ >= 0) send(user_, &byte, 1, MSG_NOSIGNAL | MSG_DONTWAIT);
  }
  std::size_t take(std::uint8_t* bytes, std::size_t max) override {
    if (user_ < 0) accept_user();
    if (user_ < 0 || !has_bytes(user_)) return 0;
    const ssize_t size = recv(user_, bytes, max, 0);
    if (size <= 0) hang_up();
    return size > 0 ? static_cast<std::size_t>(size) : 0;
  }

 private:
  void accept_user() {
    user_ = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
    const int at_once = 1;  // Bytes of a line do not wait for more.
    if (user_ >= 0) setsockopt(user_, IPPROTO_TCP, TCP_NODELAY, &at_once, sizeof at_once);
  }
  void hang_up() {
    if (user_ >= 0) close(user_);
    user_ = -1;
  }

  int listener_ = -1;
  std::uint16_t port_ = 0;
  int user_ = -1;
};

// Starts the node as a sink of `island`, writes to standard output the part after `serial:` of a
// target of `rubric test` (a device, or `tcp:HOST:PORT`) and carries bytes until standard input
// ends. The sink's radio sends, but hears nobody. Returns the exit status.
int serve_serial_device(QemuBoard& board, std::uint16_t island, bool over_tcp) {
  Bridge bridge(board);
  const Firmware firmware = bridge.greet();
  if (!firmware.is_sink) throw BoardBroken("this is not firmware of a sink");
  NodeSetup setup{.id = 1, .island = island};
  bridge.start(setup);
  std::unique_ptr<Device> device;
  if (over_tcp) {
    device = std::make_unique<TcpLine>();
  } else {
    device = std::make_unique<Terminal>();
  }
  bridge.set_serial_tap([&](std::uint8_t byte) { device->put(byte); });
  std::cout << device->name() << std::endl;
  while (true) {
    std::array<std::uint8_t, 512> bytes{};
    if (has_bytes(STDIN_FILENO) && read(STDIN_FILENO, bytes.data(), bytes.size()) <= 0) return 0;
    const std::size_t size = device->take(bytes.data(), bytes.size());
    if (size > 0) board.put_serial(Bytes(bytes.data(), size));
    bridge.run(bridge.tick() + 1);  // A tick or two of real time.
    bridge.take_lines();
  }
}

std::string emulator() {
  const char* const named = std::getenv("QEMU_SYSTEM_ARM");
  return named != nullptr ? named : "qemu-system-arm";
}

int run(const std::vector<std::string>& arguments) {
  const bool over_tcp = arguments[0] == "--serial-tcp";
  if (arguments.size() == 3 && (over_tcp || arguments[0] == "--serial-device")) {
    const auto island = static_cast<std::uint16_t>(number_of(arguments[1], 0xFFFF));
    QemuBoard board(emulator(), arguments[2], QemuBoard::Clock::kBoard);
    return serve_serial_device(board, island, over_tcp);
  }
  const bool real = arguments[0] == "--real-time";
  const auto clock = real ? QemuBoard::Clock::kBoard : QemuBoard::Clock::kBench;
  std::vector<Station> stations;
  for (std::size_t i = real ? 1 : 0; i < arguments.size(); ++i) {
    Station station;
    station.board = std::make_unique<QemuBoard>(emulator(), arguments[i], clock);
    station.bridge = std::make_unique<Bridge>(*station.board);
    station.firmware = station.bridge->greet();
    stations.push_back(std::move(station));
  }
  return serve(stations, "rubric_firmware_arm", real ? "real" : "virtual");
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (arguments.empty() || arguments[0] == "--help") {
    std::cerr << kUsage;
    return 2;
  }
  try {
    return run(arguments);
  } catch (const std::exception& error) {
    std::cerr << "firmware_arm: " << error.what() << "\n";
    return 1;
  }
}
