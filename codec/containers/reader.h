// One interface for all sources of packets.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "codec/containers/packet.h"

namespace rubric {

/// A place where packets of a capture were heard. A stream has one interface, a capture file many.
struct Interface {
  std::string name;                            ///< if_name; empty where there is none.
  std::string comment;                         ///< opt_comment of its description.
  std::uint16_t link_type = 0;                 ///< LINKTYPE_; 0 for a stream.
  std::uint64_t ticks_per_second = 1'000'000;  ///< Resolution of its time stamps.
  std::int64_t offset_seconds = 0;             ///< Added to each time stamp.
};

/// Reads packets from bytes that come in chunks of any size; the chunks' borders do not matter.
/// Uses bounded memory for any input. A reader never fails: it delivers malformed data as a packet
/// with an error, and finds the packets after it where the format allows.
class Reader {
 public:
  virtual ~Reader() = default;

  /// Takes the next bytes and delivers the packets that they complete.
  virtual void feed(Bytes chunk, PacketSink sink) = 0;

  /// Ends the input: delivers the rest of it. Afterwards the reader takes a new input; interfaces()
  /// stays until then.
  virtual void finish(PacketSink sink) = 0;

  /// Lines of text that are no packets and no mistakes either.
  struct Noise {
    std::uint64_t lines = 0;
    std::uint64_t first = 0;     ///< Its number, from 1.
    std::uint64_t prefixed = 0;  ///< Number of the first that has hex text after an unknown prefix.
    std::string prefix = {};     ///< What that line begins with.
    std::string marker = {};     ///< The first word for "received" before bytes, as 'RX:'.
  };
  virtual Noise noise() const { return {}; }

  /// Returns the interfaces met so far; a Packet's interface_id is an index into them.
  const std::vector<Interface>& interfaces() const { return interfaces_; }

 protected:
  std::vector<Interface> interfaces_;
};

enum class InputFormat : std::uint8_t {
  kUnknown,
  kHdlc,  ///< Bytes of a serial line.
  kSf,    ///< Bytes of one direction of a serial forwarder connection.
  kPcap,
  kPcapng,
  kHex,    ///< Text, a packet a line.
  kLog,    ///< The same among other lines, as tools log it.
  kJsonl,  ///< JSON lines; no reader here.
};

/// Facts that the input itself lacks.
struct ReaderOptions {
  Direction direction = Direction::kUnknown;  ///< For packets of a stream or of hex text.
  std::string interface_name;                 ///< For a stream or hex text.
  Framing hex_framing = Framing::kSf;         ///< Framing of the lines of hex text.
  bool hex_has_fcs = false;                   ///< Lines of kRadio end with an FCS.
  /// Link types in whose place USER0 to USER15 (147 to 162) are read; 0: as they are.
  std::array<std::uint16_t, 16> user_links{};
};

/// Returns the link type in whose place `link_type` is read.
std::uint16_t link_read_as(std::uint16_t link_type, const ReaderOptions& options);

/// Returns a reader of that format; null for kUnknown and kJsonl.
std::unique_ptr<Reader> make_reader(InputFormat format, const ReaderOptions& options = {});

/// Returns the format of an input that begins with these bytes (a few kilobytes are plenty), by
/// content alone.
InputFormat detect(Bytes first_bytes);

/// Returns whether lines of hex text that begin like this are radio frames with their FCS: whether
/// at least half of them end with the check sum of the bytes before.
bool lines_end_with_fcs(Bytes first_bytes);

/// Returns whether text that begins like this is a hex dump whose rows begin with offsets, which is
/// no hex text.
bool is_hex_dump(Bytes first_bytes);

/// A line of text in which words precede a packet as hex text.
struct PrefixedLine {
  std::uint64_t number = 0;  ///< From 1; 0: there is none.
  Bytes prefix;
};

/// Returns the first such line of text that begins like this.
PrefixedLine find_prefixed_line(Bytes first_bytes);

}  // namespace rubric
