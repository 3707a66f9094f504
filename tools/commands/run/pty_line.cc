#include "tools/commands/run/pty_line.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <optional>

#include "codec/lines/broken.h"

namespace rubric::run {

using lines::Broken;
using std::chrono::steady_clock;

PtyLine::PtyLine() : master_(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK)) {
  char name[128];
  const int master = master_.get();
  if (master < 0 || ::grantpt(master) != 0 || ::unlockpt(master) != 0 ||
      ::ptsname_r(master, name, sizeof name) != 0) {
    throw Broken(fmt::format("no pseudo-terminal: {}", std::strerror(errno)));
  }
  device_ = name;
  device_end_ = lines::Descriptor(::open(name, O_RDWR | O_NOCTTY | O_CLOEXEC));
  termios settings{};
  if (!device_end_.is_open() || ::tcgetattr(device_end_.get(), &settings) != 0) {
    throw Broken(fmt::format("{}: {}", device_, std::strerror(errno)));
  }
  ::cfmakeraw(&settings);
  ::tcsetattr(device_end_.get(), TCSANOW, &settings);
}

bool PtyLine::open(lines::SteadyTime) {
  const bool opened = !is_open_;
  is_open_ = true;
  return opened;
}

void PtyLine::write(Bytes frame) {
  // All or nothing: half a frame would damage the next one, too.
  pollfd room{master_.get(), POLLOUT, 0};
  if (::poll(&room, 1, 0) > 0) (void)!::write(master_.get(), frame.data(), frame.size());
}

void PtyLine::send(const std::vector<std::uint8_t>& packet, lines::SteadyTime) {
  std::uint8_t room[hdlc_frame_room(kSerialAfterHeaderMax + 2)];
  const auto size =
      write_serial_packet(Bytes(packet.data(), packet.size()), MutableBytes(room, sizeof room));
  if (size) write(Bytes(room, *size));
}

void PtyLine::take(Bytes bytes) {
  for (const std::uint8_t byte : bytes) {
    if (deframer_.push(byte) != HdlcEvent::kFrame) continue;
    const Bytes content = deframer_.content();
    const std::uint8_t kind = *content.begin();
    if (kind != kSerialPacketAck && kind != kSerialPacketNoAck) continue;
    const std::size_t header = serial_kind_has_seq(kind) ? 2 : 1;
    if (content.size() < header) continue;
    if (kind == kSerialPacketAck) {
      std::uint8_t room[hdlc_frame_room(kSerialContentMin)];
      const auto size = write_serial_ack(content.begin()[1], MutableBytes(room, sizeof room));
      if (size) write(Bytes(room, *size));
    }
    packets_.push_back({steady_clock::now(), {content.begin() + header, content.end()}});
  }
}

std::optional<lines::TimedPacket> PtyLine::receive(lines::SteadyTime deadline) {
  while (packets_.empty()) {
    std::uint8_t room[1024];
    const ssize_t size = ::read(master_.get(), room, sizeof room);
    if (size > 0) take(Bytes(room, static_cast<std::size_t>(size)));
    if (!packets_.empty()) break;
    // Also while bytes come: they need not hold a packet.
    const auto left = std::chrono::ceil<lines::Milliseconds>(deadline - steady_clock::now());
    if (left.count() <= 0) return std::nullopt;
    pollfd input{master_.get(), POLLIN, 0};
    if (size <= 0) ::poll(&input, 1, static_cast<int>(std::min<std::int64_t>(left.count(), 1000)));
  }
  lines::TimedPacket packet = std::move(packets_.front());
  packets_.pop_front();
  return packet;
}

}  // namespace rubric::run
