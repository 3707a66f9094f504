// The source of a serial forwarder's packets: a serial line, or another forwarder.
#pragma once

#include <poll.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "codec/containers/reader.h"
#include "codec/lines/forward/sockets.h"
#include "codec/lines/host_link.h"
#include "codec/lines/line.h"
#include "codec/lines/stream.h"

namespace rubric::forward {

/// Nothing here blocks, except that a name is looked up at the first opening.
class Source {
 public:
  struct Options {
    lines::Address address;
    lines::HostLinkOptions link;           ///< For a serial line.
    lines::Milliseconds patience{10'000};  ///< For a forwarder's handshake.
  };
  struct Handlers {
    /// Gets everything that passes, in both directions, malformed frames and confirmations
    /// included.
    std::function<void(const Packet&)> on_frame;
    /// Gets a packet for the clients, from its dispatch byte on.
    std::function<void(Bytes)> on_packet;
    std::function<void()> on_malformed;
    /// Called when a packet of a client was written, and by a mote confirmed; or was not confirmed.
    std::function<void(bool confirmed)> on_given;
  };

  Source(Options options, Handlers handlers);

  const std::string& name() const { return options_.address.name; }
  /// Returns the longest packet that it takes, in bytes.
  std::size_t packet_max() const;

  /// Begins to open it. All functions that are not const throw lines::Broken if it is gone,
  /// or is not what it should be; close() is due then.
  void open(lines::SteadyTime now);
  /// Closes it. Throws nothing. A packet that was not given yet is kept for the next time.
  void close(lines::SteadyTime now);
  bool is_up() const { return state_ == State::kUp; }
  /// Returns its socket, if it is one and connected.
  int socket() const;

  pollfd wanted() const;
  std::optional<lines::SteadyTime> next() const;
  /// Continues when poll found something, or next() may be over.
  void turn(short found, lines::SteadyTime now);

  /// Returns whether send() may be called.
  bool takes() const { return is_up() && given_.empty(); }
  void send(Bytes packet, lines::SteadyTime now);
  /// Returns whether it has a packet of a client that was not given yet.
  bool is_giving() const { return !given_.empty(); }

 private:
  enum class State { kClosed, kConnecting, kGreeting, kUp };
  bool is_forwarder() const { return options_.address.kind == lines::Address::Kind::kForwarder; }

  void connected(lines::SteadyTime now);
  void up(lines::SteadyTime now);
  void begin_given(lines::SteadyTime now);
  void read(lines::SteadyTime now);
  void write();
  void heard(const Packet& packet);
  Bytes output() const;
  void written(std::size_t count);
  void outcome(const lines::HostLink::Outcome& outcome);

  Options options_;
  Handlers handlers_;
  State state_ = State::kClosed;
  lines::ByteStream stream_;
  std::optional<Connector> connector_;
  lines::SteadyTime greet_by_;
  std::uint64_t heard_bytes_ = 0;      // Since it was opened.
  lines::HostLink link_;               // For a serial line.
  std::unique_ptr<Reader> forwarded_;  // For a forwarder.
  std::unique_ptr<Reader> sent_;       // Reads the output, for on_frame.
  std::vector<std::uint8_t> output_;   // For a forwarder.
  std::vector<std::uint8_t> given_;    // The packet that is being given.
  bool closing_ = false;
  std::string broken_;  // An error found in a callback.
};

}  // namespace rubric::forward
