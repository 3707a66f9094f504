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

// False at the end of `from`.
bool carry(int from, int to) {
  std::array<char, 512> bytes{};
  const ssize_t size = read(from, bytes.data(), bytes.size());
  if (size <= 0) return false;
  for (ssize_t done = 0; done < size;) {
    const ssize_t sent = write(to, bytes.data() + done, static_cast<std::size_t>(size - done));
    if (sent <= 0) return false;
    done += sent;
  }
  return true;
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
  std::cout << device.name() << std::endl;
  while (true) {
    std::array<pollfd, 3> waited{{{STDIN_FILENO, POLLIN, 0},
                                  {device.master(), POLLIN, 0},
                                  {board.serial_descriptor(), POLLIN, 0}}};
    if (poll(waited.data(), waited.size(), -1) < 0 && errno != EINTR) return 1;
    std::array<char, 64> ignored{};
    if (waited[0].revents != 0 && read(STDIN_FILENO, ignored.data(), ignored.size()) <= 0) return 0;
    if (waited[1].revents != 0 && !carry(device.master(), board.serial_descriptor())) return 1;
    if (waited[2].revents != 0 && !carry(board.serial_descriptor(), device.master())) return 1;
  }
}

}  // namespace rubric::firmware
