// A target's input as its packets, to be changed one by one and written again.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "codec/containers/reader.h"
#include "codec/containers/writer.h"
#include "codec/generate/frame_generator.h"

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

}  // namespace rubric::fuzz
