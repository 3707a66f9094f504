// One client of a serial forwarder.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "codec/lines/forward/backlog.h"
#include "codec/lines/stream.h"

namespace rubric::forward {

/// A client owns its socket, which never blocks, and a small buffer for its input; its output is in
/// the Backlog. If it breaks the protocol, fault() says so from then on.
class Client {
 public:
  /// `packet_max`: the longest packet that the source takes, in bytes. `patience`: how long a
  /// client may take to shake hands, and for a packet from its first byte to its last.
  struct Limits {
    std::size_t packet_max = 255;
    lines::Milliseconds patience{10'000};
  };

  /// It gets packets from now on. Its peer's address is its name.
  Client(lines::Descriptor socket, std::string name, std::uint64_t offset, const Limits& limits,
         lines::SteadyTime now);

  const std::string& name() const { return name_; }
  /// Returns the socket; -1 if the client is gone, though its packets may be left.
  int fd() const { return socket_.get(); }
  /// Returns why it has to be cut off; empty if it does not.
  const std::string& fault() const { return fault_; }
  /// Returns when it last sent something, or came.
  lines::SteadyTime heard() const { return heard_; }
  /// Returns whether it sends nothing more; its packets may be left.
  bool has_left() const { return ended_ || fd() < 0; }
  /// Returns whether it is gone, with nothing of it left.
  bool is_over() const { return has_left() && !packet(); }

  /// Returns the descriptor for poll. -1: none.
  int poll_fd() const { return lost_ && in_used_ == kRoom ? -1 : fd(); }
  short events() const;
  /// Handles the result of poll.
  void turn(short found, const Backlog& backlog, lines::SteadyTime now);
  /// Writes the bytes that it lacks, as far as the socket takes them. Cuts it off if the backlog
  /// has lost some of them.
  void write(const Backlog& backlog, lines::SteadyTime now);
  /// Returns the end of any wait for it.
  std::optional<lines::SteadyTime> deadline() const;
  /// Cuts it off if the time is over.
  void tick(lines::SteadyTime now);

  /// Returns the first packet that it sent; valid until the next call that is not const.
  std::optional<Bytes> packet() const;
  void drop_packet();
  /// Returns how many whole packets wait.
  std::size_t packets_waiting() const;
  /// Returns whether everything was written to it.
  bool is_served(const Backlog& backlog) const {
    return fd() < 0 || lost_ || offset_ == backlog.end();
  }

 private:
  static constexpr std::size_t kRoom = 4096;

  void read(lines::SteadyTime now);
  void drop(std::size_t count);
  void check_input();
  void look_behind_the_last();
  bool is_cut_short() const { return in_used_ > 0 && !packet(); }

  lines::Descriptor socket_;
  std::string name_;
  Limits limits_;
  std::string fault_;
  std::array<std::uint8_t, kRoom> in_{};
  std::size_t in_used_ = 0;
  lines::SteadyTime begun_;   // Time of the first byte of a packet, or of its coming.
  lines::SteadyTime heard_;   // Time of its last input.
  lines::SteadyTime served_;  // Time of its last output.
  std::uint64_t offset_;      // Offset of the first byte that it lacks.
  bool greeted_ = false;
  bool blocked_ = false;  // The socket takes no more for now.
  bool ended_ = false;    // It will send no more.
  bool lost_ = false;     // It takes no more, but there may be something to read.
};

}  // namespace rubric::forward
