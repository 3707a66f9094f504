// Sends packets over a line in use, one at a time, and reads its frames meanwhile.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "codec/containers/reader.h"
#include "codec/lines/host_link.h"
#include "codec/lines/line.h"

namespace rubric::lines {

/// Throws Broken, with what is wrong, if the other end cannot be reached or is gone;
/// send() alone reports that in its result. Everything ends early when the user asks to stop
/// (stop.h).
class Sender {
 public:
  /// The result of sending a packet. A serial forwarder confirms nothing: the packet is done once
  /// it was written.
  struct Result {
    bool done = false;
    int tries = 0;         ///< How often it was sent.
    int strange_acks = 0;  ///< Confirmations of other numbers that came meanwhile.
    lines::Milliseconds took{0};
    std::string broken;  ///< Why the line is gone, if it is.
  };
  /// Called for each frame that came, stamped with this host's time.
  using OnFrame = std::function<void(const Packet&)>;

  Sender(Address address, const lines::HostLinkOptions& options, OnFrame on_frame);

  /// Opens the line; for a serial forwarder, waits for its first bytes.
  void open();
  /// Returns the longest packet that this line takes, in bytes from the dispatch byte on.
  std::size_t packet_bytes_max() const;
  /// Returns whether packets are confirmed.
  bool confirms() const { return line_.address().kind != Address::Kind::kForwarder; }

  /// Sends a packet of 1 to packet_bytes_max() bytes.
  Result send(Bytes packet);
  /// Reads until then, or until `fd` has something to read or has ended; returns true in that case.
  /// -1: no descriptor.
  bool hear(lines::SteadyTime until, int fd = -1);
  /// Ends the connection without losing any output.
  void close();

 private:
  Result send_to_forwarder(Bytes packet);
  Result result_of(const lines::HostLink::Outcome& outcome) const;
  void greet();
  bool step(lines::SteadyTime until, int fd);
  std::size_t read();
  Bytes output() const;
  void written(std::size_t count);
  void flush();

  Line line_;
  OnFrame on_frame_;
  std::optional<lines::HostLink::Outcome> outcome_;
  lines::HostLink link_;            // For a serial line.
  std::unique_ptr<Reader> reader_;  // For a serial forwarder.
  std::vector<std::uint8_t> out_;   // For a serial forwarder: what is still to be written.
  std::optional<lines::SteadyTime> stuck_since_;  // The line takes nothing.
};

}  // namespace rubric::lines
