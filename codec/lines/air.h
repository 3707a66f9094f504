// A virtual air: ZEP datagrams between all who take part at a UDP port. (decision 11)
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "codec/lines/address.h"
#include "codec/lines/stream.h"
#include "codec/lines/time.h"

namespace rubric::lines {

/// One participant. Whoever comes first binds the port and is the hub: it passes on what it hears
/// to all others. Those who come later find the port taken, send to it, and take the hub's place
/// when it has gone.
class Air {
 public:
  /// As a hub it forgets who has greeted it and does not any more for `forgets_after`.
  explicit Air(HostPort at, Milliseconds forgets_after = Milliseconds(10'000))
      : at_(std::move(at)), forgets_after_(forgets_after) {}

  /// Takes part. Port 0 always makes a hub. Throws Broken.
  void open();
  void close() { socket_.close(); }
  /// Returns the port, also after port 0.
  std::uint16_t port() const { return at_.port; }
  /// Returns whether the port is held by a program that is no hub: it has not answered for two
  /// seconds.
  bool is_unanswered() const;

  /// Sends a datagram to all others; throws Broken.
  void send(Bytes datagram);
  /// Descriptors of a caller who waits for more than datagrams; -1: none.
  using Others = std::array<int, 2>;
  /// Returns the next datagram, valid until the next call; nothing if the time is over first or
  /// one of `others` can be read. Of those at hand it is the one that was sent first by its stamp:
  /// on a busy host a sender may be late, and so may this process. Throws Broken.
  Bytes receive(SteadyTime deadline, const Others& others = {-1, -1});

 private:
  struct Peer {
    SocketAddress address;
    SteadyTime heard;
    bool greets;  // Boards of others may only listen, without a word.
  };
  struct Arrived {
    std::int64_t time_ns;
    SocketAddress from;
    std::vector<std::uint8_t> bytes;
  };
  static std::string greeting();
  void greet();
  int take_arrived();
  void relay(Bytes datagram, const SocketAddress* from);
  void note(const SocketAddress& from, bool greets);
  void forget_the_gone();

  HostPort at_;
  Milliseconds forgets_after_;
  Descriptor socket_;
  bool is_hub_ = false;
  std::vector<Peer> peers_;  // Of a hub.
  SteadyTime next_greeting_;
  SteadyTime met_;  // When a hub was looked for.
  bool is_answered_ = false;
  std::vector<std::uint8_t> room_;
  std::deque<Arrived> arrived_;  // By time.
  std::vector<std::uint8_t> current_;
};

/// Returns when a frame that comes now was sent, in nanoseconds since 1970: by the sender's stamp
/// if that is at most ten seconds off, as of a process on this host, else now.
std::int64_t air_time_ns(std::int64_t stamp_ns);

}  // namespace rubric::lines
