// A mote's serial line while it is in use: a device, TCP, or a serial forwarder.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "codec/containers/packet.h"
#include "codec/containers/reader.h"
#include "codec/lines/stream.h"

namespace rubric::lines {

/// An address in the form of TinyOS hosts: `serial@DEVICE:BAUD`, where BAUD may be a platform's
/// name; `network@HOST:PORT`, a serial line through TCP; `sf@HOST:PORT`, a serial forwarder. Or a
/// virtual air, which is no serial line: `zep:PORT` or `zep:HOST:PORT`.
struct Address {
  enum class Kind : std::uint8_t { kSerial, kNetwork, kForwarder, kAir };
  Kind kind = Kind::kSerial;
  std::string name;  ///< As given.
  std::string device;
  std::uint32_t baud = 0;
  lines::HostPort at;
};

/// Returns nothing if the text is no such name, so that it is a file's. Throws
/// std::invalid_argument with what is wrong if it begins like one.
std::optional<Address> parse_address(std::string_view text);
/// Does the same where only a serial line will do: throws for any other text.
Address required_address(std::string_view text);

/// Returns $MOTECOM, or sf@localhost:9002, as TinyOS hosts do.
std::string default_address();
/// Returns whether a user who names no source wants that: at a terminal, with $MOTECOM set.
bool asked_by_motecom();

/// The address is a serial line's. All functions throw Broken, with what is wrong, if the other end
/// cannot be reached or is gone.
class Line {
 public:
  /// `listen_only`: nothing is ever written to a serial line.
  Line(Address address, bool listen_only) : address_(std::move(address)), mute_(listen_only) {}

  const Address& address() const { return address_; }
  /// Returns the format of the bytes.
  InputFormat format() const;

  void open(lines::SteadyTime deadline);
  void close() { stream_.close(); }
  /// Reads the next bytes; returns 0 if there are none for a short while.
  std::size_t read(MutableBytes out);
  /// Does the same until the deadline; returns 0 if the time is over first.
  std::size_t read(MutableBytes out, lines::SteadyTime deadline);
  /// Returns how many of the bytes the line takes at once; 0: none.
  std::size_t write_some(Bytes bytes) { return stream_.write_some(bytes); }
  /// Signals the other end of a connection that nothing more comes from here.
  void end_output() { stream_.end_output(); }
  /// Returns the descriptor, to wait for it beside others; -1: it is not open.
  int fd() const { return stream_.fd(); }
  /// Confirms a sound PACKET_ACK frame and answers one of an unknown kind, as hosts do. Source: TEP
  /// 113, section 3.1.
  void answer(const Packet& packet);

 private:
  Address address_;
  bool mute_;
  bool began_ = false;  // The other end has sent something since open().
  lines::ByteStream stream_;
};

}  // namespace rubric::lines
