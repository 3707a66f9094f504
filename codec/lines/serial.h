// The serial line of a mote, as a device or through TCP: framed as in TEP 113.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>

#include "codec/lines/host_link.h"
#include "codec/lines/stream.h"

namespace rubric::lines {

/// Returns the bits per second of a number or of a platform's name (telosb, micaz, ...), if there
/// is such a speed.
std::optional<std::uint32_t> baud_of(std::string_view text);

/// Opens a terminal device, raw and at this speed. Throws Broken.
ByteStream open_serial_device(const std::string& path, std::uint32_t baud);

/// Sends packets as hosts do: the node confirms each, and an unconfirmed one is sent again.
class SerialLine : public StreamLine {
 public:
  static constexpr Milliseconds kAckWait{1000};
  static constexpr int kTries = 3;

  using StreamLine::StreamLine;

  void send(const std::vector<std::uint8_t>& packet, SteadyTime deadline) override;
  std::optional<TimedPacket> receive(SteadyTime deadline) override;
  /// A malformed frame is noise, and a packet that was sent again may have arrived twice.
  std::string take_damage() override { return std::exchange(damage_, {}); }

 private:
  static HostLinkOptions link_options();
  void begin(SteadyTime deadline) override;
  void take(Bytes bytes) override;
  void flush(SteadyTime deadline);

  std::optional<bool> confirmed_;  // The last packet was confirmed; nothing: not yet.
  HostLink link_{link_options(), [this](const HostLink::Outcome& outcome) {
                   if (outcome.packet + 1 == link_.taken()) confirmed_ = outcome.confirmed;
                   if (outcome.tries > 1) damage_ = "a packet was confirmed late, and sent again";
                 }};
  std::deque<TimedPacket> packets_;
  bool synchronised_ = false;  // Input before the first good frame is none of a packet's.
  std::string damage_;
};

}  // namespace rubric::lines
