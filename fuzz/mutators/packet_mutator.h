// Mutates streams of packets by their meaning: fields, messages, sequences; for any engine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "codec/containers/reader.h"
#include "codec/containers/writer.h"
#include "codec/frame_generator/frame_generator.h"
#include "codec/reflect/frame.h"

namespace rubric::fuzz {

/// A packet that owns its bytes.
struct StreamPacket {
  Packet packet;  ///< Without bytes and comment.
  std::vector<std::uint8_t> bytes;
  std::string comment;
  std::string interface_name;

  Packet view() const;
};

/// The packets of a capture file or line, and its other facts.
struct PacketStream {
  InputFormat format = InputFormat::kHdlc;
  std::uint16_t link_type = 0;  ///< For a pcap file.
  std::vector<StreamPacket> packets;
};

/// Returns everything that the format's reader finds in `input`, malformed packets included.
PacketStream read_stream(InputFormat format, Bytes input);

/// Writes the stream by the format's writer; leaves out what the writer refuses.
std::vector<std::uint8_t> write_stream(const PacketStream& stream);

/// Removes random packets from the stream until its output has at most `max_size` bytes (or nothing
/// is left; the beginning of a file is then cut off). Returns the output.
std::vector<std::uint8_t> write_within(PacketStream& stream, std::size_t max_size,
                                       generate::Random& random);

/// Returns whether the stream can hold packets of that framing.
bool takes_radio(const PacketStream& stream);
bool takes_serial(const PacketStream& stream);

/// Returns a packet of `frame` for the stream, with right check sums. Radio frames become serial
/// packets if the stream takes no others, as in a trace.
StreamPacket make_packet(const generate::Generated& frame, const PacketStream& stream,
                         generate::Random& random);

/// Repairs the packet to a sound one with its bytes: check sums right, nothing missing.
void repair_sums(StreamPacket& packet);
/// Sets the lengths in the packet's bytes by the most specific route that they follow.
void repair_lengths(StreamPacket& packet, const reflect::RouteTable& routes);

/// Makes mutants of the streams of one protocol. The same seed and calls give the same mutants.
class PacketMutator {
 public:
  PacketMutator(const reflect::Protocol& protocol, const reflect::RouteTable& routes,
                std::uint64_t seed);

  /// Returns a mutant of `input`, a stream or file of that format, of at most `max_size` bytes.
  /// Most are the packets with a few changes and check sums that match; some are bytes changed
  /// anywhere.
  std::vector<std::uint8_t> mutate(InputFormat format, Bytes input, std::size_t max_size);
  /// Returns the packets of two inputs in one: the beginning of one and the end of the other, or
  /// some of each in their order.
  std::vector<std::uint8_t> cross_over(InputFormat format, Bytes one, Bytes other,
                                       std::size_t max_size);

  /// Makes one change to one or a few packets of the stream.
  void change(PacketStream& stream);
  /// Changes the contents of one packet, with check sums repaired or, rarely, left wrong.
  void change_packet(PacketStream& stream, std::size_t at);

  generate::Random& random() { return generator_.random(); }
  /// Continues like a new mutator of that seed.
  void reseed(std::uint64_t seed) { random() = generate::Random(seed); }

 private:
  /// A number of a packet of the stream.
  struct Number {
    std::size_t packet;
    std::size_t offset;
    std::size_t width;
    bool little;
    const char* name;
  };
  /// A packet's innermost message, and its fault.
  using Message = std::pair<const reflect::Type*, Fault>;

  void insert_message(PacketStream& stream);
  void adopt_values(PacketStream& stream, std::size_t at);
  void copy_number(PacketStream& stream);
  void change_frame(StreamPacket& packet);
  void change_outside(StreamPacket& packet);
  std::vector<Number> numbers(const PacketStream& stream, std::size_t begin, std::size_t end);
  void copy_some(PacketStream& stream, const std::vector<Number>& known,
                 const std::vector<Number>& own, std::size_t to, bool by_name);
  Message message_of(const StreamPacket& packet);
  void copy(PacketStream& stream, const Number& from, const Number& to, const Message& message);
  static bool answers(const reflect::Type& type, const std::vector<Number>& numbers);
  const reflect::Route* pick_route(const PacketStream& stream);
  std::size_t pick_packet(const PacketStream& stream);

  const reflect::Protocol& protocol_;
  const reflect::RouteTable& routes_;
  generate::FrameGenerator generator_;
  reflect::FrameDecoder decoder_;
  reflect::Frame frame_;
  std::vector<const reflect::Route*> ways_;     // Those that frames can take.
  std::vector<const reflect::Type*> messages_;  // To which they lead, each once.
};

}  // namespace rubric::fuzz
