#include "codec/lines/forwarder.h"

#include <fmt/format.h>

#include "codec/lines/broken.h"

namespace rubric::lines {
namespace {

constexpr std::uint8_t kMagic = 'U';
constexpr std::uint8_t kVersion = ' ';  // There is none below it.

}  // namespace

void ForwarderLine::begin(SteadyTime deadline) {
  bytes_.clear();
  //= WIRE-SF-HANDSHAKE: A serial forwarder stream begins with the byte 0x55 and a version byte
  //= from each side.
  const std::uint8_t hello[] = {kMagic, kVersion};
  put(Bytes(hello, sizeof hello), deadline);
  while (bytes_.size() < sizeof hello) {
    bool more = false;
    try {
      more = read_some(deadline);
    } catch (const Broken&) {
      throw Broken(kTurnedAway);
    }
    if (!more) broken("the other end does not begin a serial forwarder's connection");
  }
  if (bytes_[0] != kMagic || bytes_[1] < kVersion) {
    broken(
        fmt::format("the other end is not a serial forwarder's: it begins with {:02x} {:02x}, not "
                    "with 55 20",
                    bytes_[0], bytes_[1]));
  }
  bytes_.erase(bytes_.begin(), bytes_.begin() + sizeof hello);
}

void ForwarderLine::send(const std::vector<std::uint8_t>& packet, SteadyTime deadline) {
  std::vector<std::uint8_t> out{static_cast<std::uint8_t>(packet.size())};
  out.insert(out.end(), packet.begin(), packet.end());
  put(Bytes(out.data(), out.size()), deadline);
}

std::optional<TimedPacket> ForwarderLine::receive(SteadyTime deadline) {
  //= WIRE-SF-LENGTH: A serial forwarder packet is a length byte of 1 to 255 and that many bytes
  //= from the dispatch byte on.
  while (bytes_.empty() || bytes_.size() < std::size_t{1} + bytes_[0]) {
    if (!bytes_.empty() && bytes_[0] == 0) break;
    if (!read_some(deadline)) return std::nullopt;
  }
  const std::size_t size = bytes_[0];
  if (size == 0) broken("a serial forwarder packet of no bytes");
  const auto end = bytes_.begin() + static_cast<std::ptrdiff_t>(size) + 1;
  TimedPacket packet{std::chrono::steady_clock::now(), {bytes_.begin() + 1, end}};
  bytes_.erase(bytes_.begin(), end);
  return packet;
}

void ForwarderLine::take(Bytes bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }

}  // namespace rubric::lines
