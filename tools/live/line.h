// A mote's serial line while it is in use: a device, TCP, or a serial forwarder.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "codec/containers/packet.h"
#include "codec/containers/reader.h"
#include "conformance/attach/stream.h"

namespace rubric::live {

/// As TinyOS hosts name them: `serial@DEVICE:BAUD`, where BAUD may be a platform's name;
/// `network@HOST:PORT`, a serial line through TCP; `sf@HOST:PORT`, a serial forwarder.
struct Address {
  enum class Kind : std::uint8_t { kSerial, kNetwork, kForwarder };
  Kind kind = Kind::kSerial;
  std::string name;  ///< As given.
  std::string device;
  std::uint32_t baud = 0;
  attach::HostPort at;
};

/// Nothing where the text is no such name, so that it is a file's. Throws std::invalid_argument
/// with what is wrong where it begins as one.
std::optional<Address> parse_address(std::string_view text);
/// As above, where the text cannot be a file's: throws for any that is no such name.
Address required_address(std::string_view text);

/// $MOTECOM, or sf@localhost:9002, as TinyOS hosts have it.
std::string default_address();
/// Whether that is what somebody wants who names no source: at a terminal, with $MOTECOM set.
bool asked_by_motecom();

/// All throw runner::TargetBroken, with what is wrong, when the other end cannot be had or is gone.
class Line {
 public:
  /// `listen_only`: nothing is ever written to a serial line.
  Line(Address address, bool listen_only) : address_(std::move(address)), mute_(listen_only) {}

  const Address& address() const { return address_; }
  /// What the bytes are.
  InputFormat format() const;

  void open(attach::SteadyTime deadline);
  void close() { stream_.close(); }
  /// The next bytes; 0 when there are none for a short while.
  std::size_t read(MutableBytes out);
  /// As above; 0 when the time is over first.
  std::size_t read(MutableBytes out, attach::SteadyTime deadline) {
    return stream_.read(out, deadline);
  }
  /// How many of the bytes the line takes at once; 0: none.
  std::size_t write_some(Bytes bytes) { return stream_.write_some(bytes); }
  /// Tells the other end of a connection that nothing more comes from here.
  void end_output() { stream_.end_output(); }
  /// To wait for, beside others; -1: it is not open.
  int fd() const { return stream_.fd(); }
  /// Confirms a sound PACKET_ACK frame and answers one of an unknown kind, as hosts do. Source:
  /// TEP 113, section 3.1.
  void answer(const Packet& packet);

 private:
  Address address_;
  bool mute_;
  attach::ByteStream stream_;
};

}  // namespace rubric::live
