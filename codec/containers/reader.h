// One interface for everything that packets are read from.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "codec/containers/packet.h"

namespace rubric {

/// Where packets of a capture were heard. A stream has one interface, a capture file many.
struct Interface {
  std::string name;                               ///< if_name; empty where there is none.
  std::string comment;                            ///< opt_comment of its description.
  std::uint16_t link_type = 0;                    ///< LINKTYPE_; 0 for a stream.
  std::uint64_t ticks_per_second = 1'000'000;     ///< Resolution of its time stamps.
  std::int64_t offset_seconds = 0;                ///< Added to each time stamp.
};

/// Reads packets from bytes that come in chunks of any size; the chunks' borders do not matter.
/// Bounded memory whatever the input says. A reader never fails: what is malformed is delivered
/// as a packet with an error, and the packets behind it are found where the format lets them be.
class Reader {
 public:
  virtual ~Reader() = default;

  /// Takes the next bytes and delivers the packets that they complete.
  virtual void feed(Bytes chunk, PacketSink sink) = 0;

  /// The input has ended: delivers what is left of it. Afterwards the reader takes a new input;
  /// interfaces() stays until then.
  virtual void finish(PacketSink sink) = 0;

  /// The interfaces met so far; a Packet's interface_id counts in them.
  const std::vector<Interface>& interfaces() const { return interfaces_; }

 protected:
  std::vector<Interface> interfaces_;
};

enum class InputFormat : std::uint8_t {
  kUnknown,
  kHdlc,    ///< Bytes of a serial line.
  kSf,      ///< Bytes of one direction of a serial forwarder connection.
  kPcap,
  kPcapng,
  kHex,     ///< Text, a packet a line.
  kJsonl,   ///< JSON lines; no reader here.
};

/// What the input itself does not say.
struct ReaderOptions {
  Direction direction = Direction::kUnknown;  ///< Of the packets of a stream or of hex text.
  std::string interface_name;                 ///< Of a stream or of hex text.
  Framing hex_framing = Framing::kSf;         ///< What the lines of hex text are.
  bool hex_has_fcs = false;                   ///< Whether lines of kRadio end with an FCS.
};

/// A reader of that format; null for kUnknown and kJsonl.
std::unique_ptr<Reader> make_reader(InputFormat format, const ReaderOptions& options = {});

/// The format of an input that begins with these bytes (a few kilobytes are plenty), by content
/// alone.
InputFormat detect(Bytes first_bytes);

}  // namespace rubric
