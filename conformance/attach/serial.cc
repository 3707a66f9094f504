#include "conformance/attach/serial.h"

#include <fcntl.h>
#include <termios.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>

#include <fmt/format.h>

#include "conformance/runner/target.h"

namespace rubric::attach {
namespace {

using runner::TargetBroken;
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
constexpr Platform kPlatforms[] = {{"telosb", 115200}, {"tmote", 115200}, {"tinynode", 115200},
                                   {"shimmer", 115200}, {"micaz", 57600}, {"mica2", 57600},
                                   {"iris", 57600}, {"mica", 19200}, {"mica2dot", 19200}};

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
    return TargetBroken(fmt::format("{}: {}: {}", path, what, std::strerror(errno)));
  };
  Descriptor device(::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!device.is_open()) throw broken("cannot be opened");
  termios settings{};
  if (::tcgetattr(device.get(), &settings) != 0) throw broken("is no serial line");
  ::cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cc[VMIN] = 1;  // A read without bytes is the end of the line, never an empty one.
  settings.c_cc[VTIME] = 0;
  ::cfsetspeed(&settings, find_speed(baud)->code);
  if (::tcsetattr(device.get(), TCSANOW, &settings) != 0) throw broken("cannot be set up");
  ::tcflush(device.get(), TCIOFLUSH);
  return ByteStream(std::move(device));
}

void SerialLine::begin(SteadyTime) {
  deframer_ = HdlcDeframer(MutableBytes(room_.data(), room_.size()));
  packets_.clear();
  synchronised_ = false;
}

void SerialLine::send(const std::vector<std::uint8_t>& packet, SteadyTime deadline) {
  std::uint8_t out[hdlc_frame_room(kSerialAfterHeaderMax + 2)];
  for (int tries = 0; tries < kTries; ++tries) {
    confirmed_.reset();
    const std::uint8_t seq = seq_++;
    const auto size = write_serial_packet_ack(seq, Bytes(packet.data(), packet.size()),
                                              MutableBytes(out, sizeof out));
    if (!size) throw TargetBroken("a packet too long for the serial line");
    put(Bytes(out, *size), deadline);
    const SteadyTime ack_deadline = std::min(deadline, steady_clock::now() + kAckWait);
    while (confirmed_ != seq) {
      if (!read_some(ack_deadline)) break;
    }
    if (confirmed_ == seq) return;
    if (steady_clock::now() >= deadline) break;
  }
  broken("the node does not confirm packets on its serial line");
}

std::optional<TimedPacket> SerialLine::receive(SteadyTime deadline) {
  while (packets_.empty()) {
    if (!read_some(deadline)) return std::nullopt;
  }
  TimedPacket packet = std::move(packets_.front());
  packets_.pop_front();
  return packet;
}

void SerialLine::take(Bytes bytes) {
  for (const std::uint8_t byte : bytes) {
    const HdlcEvent event = deframer_.push(byte);
    if (event == HdlcEvent::kFrame) {
      synchronised_ = true;
      frame(deframer_.content());
    } else if (event == HdlcEvent::kBad && synchronised_) {
      broken(fmt::format("a malformed frame of {} bytes on the serial line: {}",
                         deframer_.content().size(),
                         deframer_.error().fault == Fault::kCrc ? "wrong CRC" : "wrong size"));
    }
  }
}

// A whole frame from its kind on.
void SerialLine::frame(Bytes content) {
  const std::uint8_t kind = content[0];
  const std::size_t header = serial_kind_has_seq(kind) ? 2 : 1;
  if (kind == kSerialAck && content.size() >= 2) {
    confirmed_ = content[1];
    return;
  }
  std::uint8_t out[hdlc_frame_room(8)];
  if (kind == kSerialPacketAck && content.size() > header) {
    if (const auto size = write_serial_ack(content[1], MutableBytes(out, sizeof out))) {
      answer(Bytes(out, *size));
    }
  } else if (kind == kSerialUnknown) {  // What we sent was not known: no answer to an answer.
    return;
  } else if (kind != kSerialPacketNoAck) {  // As hosts answer what they do not know.
    const std::uint8_t unknown[] = {kSerialUnknown, kind};
    if (const auto size = write_hdlc_frame(unknown, MutableBytes(out, sizeof out))) {
      answer(Bytes(out, *size));
    }
    return;
  }
  if (content.size() <= header) return;
  packets_.push_back(
      {steady_clock::now(), {content.data() + header, content.data() + content.size()}});
}

void SerialLine::answer(Bytes frame) { put(frame, steady_clock::now() + kAckWait); }

}  // namespace rubric::attach
