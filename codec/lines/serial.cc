#include "codec/lines/serial.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <termios.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>

#include "codec/lines/broken.h"

namespace rubric::lines {
namespace {

using std::chrono::steady_clock;

struct Speed {
  std::uint32_t baud;
  speed_t code;
};
constexpr Speed kSpeeds[] = {{9600, B9600},     {19200, B19200},   {38400, B38400},
                             {57600, B57600},   {115200, B115200}, {230400, B230400},
                             {460800, B460800}, {921600, B921600}};
struct Platform {
  std::string_view name;
  std::uint32_t baud;
};
constexpr Platform kPlatforms[] = {{"telosb", 115200},  {"tmote", 115200}, {"tinynode", 115200},
                                   {"shimmer", 115200}, {"micaz", 57600},  {"mica2", 57600},
                                   {"iris", 57600},     {"mica", 19200},   {"mica2dot", 19200}};

const Speed* find_speed(std::uint32_t baud) {
  const Speed* const found = std::find_if(std::begin(kSpeeds), std::end(kSpeeds),
                                          [&](const Speed& one) { return one.baud == baud; });
  return found == std::end(kSpeeds) ? nullptr : found;
}

}  // namespace

std::optional<std::uint32_t> baud_of(std::string_view text) {
  for (const Platform& one : kPlatforms) {
    if (one.name == text) return one.baud;
  }
  std::uint32_t baud = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), baud);
  if (error != std::errc() || end != text.data() + text.size() || !find_speed(baud)) {
    return std::nullopt;
  }
  return baud;
}

ByteStream open_serial_device(const std::string& path, std::uint32_t baud) {
  const auto broken = [&](const char* what) {
    return Broken(fmt::format("{}: {}: {}", path, what, std::strerror(errno)));
  };
  Descriptor device(::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!device.is_open()) throw broken("cannot be opened");
  termios settings{};
  if (::tcgetattr(device.get(), &settings) != 0) throw broken("is not a serial line");
  // Two readers would each get a part of the bytes. It ends with the descriptor.
  if (::flock(device.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    throw Broken(fmt::format("{}: is in use by another program; 'rubric forward' shares it", path));
  }
  ::cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cc[VMIN] = 1;  // A read without bytes is the end of the line, never an empty one.
  settings.c_cc[VTIME] = 0;
  ::cfsetspeed(&settings, find_speed(baud)->code);
  if (::tcsetattr(device.get(), TCSANOW, &settings) != 0) throw broken("cannot be set up");
  ::tcflush(device.get(), TCIOFLUSH);
  return ByteStream(std::move(device));
}

HostLinkOptions SerialLine::link_options() { return {.ack_wait = kAckWait, .tries = kTries}; }

void SerialLine::begin(SteadyTime) {
  link_.reset(steady_clock::now());
  packets_.clear();
  damage_.clear();
  synchronised_ = false;
}

void SerialLine::send(const std::vector<std::uint8_t>& packet, SteadyTime deadline) {
  confirmed_.reset();
  const Bytes bytes(packet.data(), packet.size());
  if (link_.submit(bytes, steady_clock::now()) != HostLink::Submitted::kTaken) {
    throw Broken("a packet too long for the serial line");
  }
  while (!confirmed_) {
    flush(deadline);
    const SteadyTime now = steady_clock::now();
    if (now >= deadline) break;
    read_some(std::min(deadline, link_.next().value_or(now)));
    link_.tick(steady_clock::now());
  }
  if (confirmed_ != true) broken("the node does not confirm packets on its serial line");
}

std::optional<TimedPacket> SerialLine::receive(SteadyTime deadline) {
  while (packets_.empty()) {
    if (!read_some(deadline)) return std::nullopt;
    // What comes without end need not hold a packet.
    if (packets_.empty() && steady_clock::now() >= deadline) return std::nullopt;
  }
  TimedPacket packet = std::move(packets_.front());
  packets_.pop_front();
  return packet;
}

void SerialLine::take(Bytes bytes) {
  auto frame = [&](const Packet& packet) {
    if (packet.error.fault == Fault::kNone) {
      synchronised_ = true;
    } else if (synchronised_) {
      damage_ = fmt::format("a malformed frame came (wrong {})",
                            packet.error.fault == Fault::kCrc ? "CRC" : "size");
    }
    if (!brings_packet(packet)) return;
    packets_.push_back({steady_clock::now(), {packet.bytes.begin(), packet.bytes.end()}});
  };
  link_.take(bytes, steady_clock::now(), frame);
  flush(steady_clock::now() + kAckWait);
}

void SerialLine::flush(SteadyTime deadline) {
  if (link_.output().empty()) return;
  put(link_.output(), deadline);
  link_.written(link_.output().size());
}

}  // namespace rubric::lines
