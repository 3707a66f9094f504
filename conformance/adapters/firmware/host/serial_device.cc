#include "conformance/adapters/firmware/host/serial_device.h"

#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <iostream>

#include "conformance/adapters/firmware/host/bridge.h"

namespace rubric::firmware {
namespace {

// A pseudo terminal that changes no byte. The slave stays open, so that its users may come and go.
class Device {
 public:
  Device() {
    master_ = posix_openpt(O_RDWR | O_NOCTTY);
    if (master_ < 0 || grantpt(master_) != 0 || unlockpt(master_) != 0) {
      throw BoardBroken(std::strerror(errno));
    }
    slave_ = open(name(), O_RDWR | O_NOCTTY);
    termios settings{};
    if (slave_ < 0 || tcgetattr(slave_, &settings) != 0) throw BoardBroken(std::strerror(errno));
    cfmakeraw(&settings);
    tcsetattr(slave_, TCSANOW, &settings);
  }
  ~Device() {
    close(slave_);
    close(master_);
  }
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  const char* name() const { return ptsname(master_); }
  int master() const { return master_; }

 private:
  int master_ = -1;
  int slave_ = -1;
};

bool has_bytes(int descriptor) {
  pollfd waited{descriptor, POLLIN, 0};
  return poll(&waited, 1, 0) > 0;
}

}  // namespace

int serve_serial_device(QemuBoard& board, std::uint16_t island) {
  Bridge bridge(board);
  const Firmware firmware = bridge.greet();
  if (!firmware.is_sink) throw BoardBroken("this is no firmware of a sink");
  NodeSetup setup;
  setup.id = 1;
  setup.island = island;
  bridge.start(setup);
  const Device device;
  bridge.set_serial_tap([&](std::uint8_t byte) {
    if (write(device.master(), &byte, 1) != 1) throw BoardBroken(std::strerror(errno));
  });
  std::cout << device.name() << std::endl;
  while (true) {
    std::array<std::uint8_t, 512> bytes{};
    if (has_bytes(STDIN_FILENO) && read(STDIN_FILENO, bytes.data(), bytes.size()) <= 0) return 0;
    if (has_bytes(device.master())) {
      const ssize_t size = read(device.master(), bytes.data(), bytes.size());
      if (size <= 0) return 1;
      board.put_serial(Bytes(bytes.data(), static_cast<std::size_t>(size)));
    }
    bridge.run(bridge.tick() + 1);  // A tick or two of real time.
    bridge.take_lines();
  }
}

}  // namespace rubric::firmware
