// An input of a target as the packets in it, to be changed one by one and written again.
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

/// What a capture file or line says beside its packets.
struct PacketStream {
  InputFormat format = InputFormat::kHdlc;
  std::uint16_t link_type = 0;  ///< Of a pcap file.
  std::vector<StreamPacket> packets;
};

/// Everything that the format's reader finds in `input`, malformed packets included.
PacketStream read_stream(InputFormat format, Bytes input);

/// The stream by the format's writer; what the writer does not take is left out.
std::vector<std::uint8_t> write_stream(const PacketStream& stream);

/// Takes random packets out of the stream until what is written of it has at most `max_size` bytes
/// (or nothing is left; the beginning of a file is then cut off). Returns what is written.
std::vector<std::uint8_t> write_within(PacketStream& stream, std::size_t max_size,
                                       generate::Random& random);

/// Whether packets of that framing can stand in the stream.
bool takes_radio(const PacketStream& stream);
bool takes_serial(const PacketStream& stream);

/// A packet of `frame` as it stands in the stream, check sums right. Radio frames become serial
/// packets where the stream takes no others, as in a trace.
StreamPacket make_packet(const generate::Generated& frame, const PacketStream& stream,
                         generate::Random& random);

/// Makes the packet what a sound one with its bytes would be: check sums right, nothing missing.
void repair_sums(StreamPacket& packet);
/// Sets the lengths in the packet's bytes by the most particular route that they follow.
void repair_lengths(StreamPacket& packet, const reflect::RouteTable& routes);

}  // namespace rubric::fuzz
