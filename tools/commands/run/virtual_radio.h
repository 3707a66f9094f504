// A node's radio on a virtual air: addresses, random waits, link acks, loss.
#pragma once

#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "codec/containers/packet.h"
#include "codec/lines/air.h"

namespace rubric::run {

constexpr std::uint8_t kPan = 0x22;  ///< TinyOS' default, and the group of AM.

/// Sends IEEE 802.15.4 frames as ZEP packets. A frame is stamped when it begins, by the system's
/// clock; a link ack 192 us after the end of its frame, as a radio sends it, however late the
/// process that plays the receiver gets to run.
class VirtualRadio {
 public:
  struct Settings {
    std::uint16_t address = 0;
    double loss = 0;  ///< Share of the frames that are not received.
    std::uint32_t seed = 0;
  };
  struct User {
    std::function<bool()> listens;
    /// A packet from its dispatch byte on, to the address or to all.
    std::function<void(Bytes)> heard;
    std::function<void(bool acked)> sent;
    /// Every frame, heard, sent or lost, in the order of their coming.
    std::function<void(const Packet&)> on_air;
    /// A frame of another radio came from the own address.
    std::function<void()> twin;
  };

  VirtualRadio(const Settings& settings, lines::HostPort at, User user);

  void open() { air_.open(); }
  std::uint16_t port() const { return air_.port(); }
  /// As lines::Air says.
  bool is_unanswered() const { return air_.is_unanswered(); }
  /// Takes a packet from its dispatch byte on; `sent` is called before it takes another.
  void send(Bytes packet, bool link_ack);
  /// Receives and sends until the deadline, or for a moment after something happened, or until
  /// one of `others` can be read.
  void run(lines::SteadyTime deadline, const lines::Air::Others& others);

 private:
  enum class State : std::uint8_t { kIdle, kWaiting, kAwaitingAck };

  void begin();
  void put(Bytes frame, std::int64_t time_ns);
  void handle(Bytes datagram);
  void finish(bool acked);

  Settings settings_;
  lines::Air air_;
  User user_;
  std::mt19937 random_;
  State state_ = State::kIdle;
  std::vector<std::uint8_t> frame_;  // Being sent; without FCS.
  bool link_ack_ = false;
  lines::SteadyTime next_;     // When the state ends.
  lines::SteadyTime taken_{};  // Others wait for a link ack until then.
  std::int64_t heard_ns_ = 0;  // The end of the frame that came last, by its stamp.
  std::int64_t taken_ns_ = 0;  // The end of the last frame for this end, and of its link ack.
  std::uint8_t dsn_ = 0;
  std::uint32_t sequence_ = 0;
};

}  // namespace rubric::run
