// One interface for all destinations of packets.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "codec/containers/packet.h"
#include "codec/containers/reader.h"

namespace rubric {

/// Writes packets as bytes that are appended to a string; the caller stores them.
class Writer {
 public:
  virtual ~Writer() = default;

  /// Appends the begin of the format.
  virtual void begin(std::string& out);

  /// Appends a packet heard on the interface of that name. Returns false, and appends nothing, if
  /// the format cannot hold such a packet.
  virtual bool write(const Packet& packet, std::string_view interface_name, std::string& out) = 0;
  bool write(const Packet& packet, std::string& out) { return write(packet, {}, out); }

  /// Appends the end of the format.
  virtual void finish(std::string& out);

  /// Returns how many packets without a time had to be given one.
  std::uint64_t given_times() const { return given_times_; }

 protected:
  std::uint64_t given_times_ = 0;
};

/// Writes serial frames, each between two flags of its own, since motes drop a frame that shares
/// its opening flag. Joins a kHdlc packet from its pieces, the CRC as received, so that a malformed
/// one comes out as it went in; an aborted one ends with escape and flag, one that was cut without
/// any flag. A kSf packet becomes a PACKET_NOACK frame with a fresh CRC. Refuses others. Source:
/// TEP 113, section 3.1.
class HdlcWriter final : public Writer {
 public:
  using Writer::write;
  bool write(const Packet& packet, std::string_view interface_name, std::string& out) override;
};

/// Writes one direction of a serial forwarder connection: handshake, then length byte and packet.
/// Takes kSf packets, empty and cut ones included, and sound kHdlc ones that carry a packet of 1 to
/// 255 bytes. Source: TinyOS serial forwarder protocol, version 2.
class SfWriter final : public Writer {
 public:
  using Writer::write;
  void begin(std::string& out) override;
  bool write(const Packet& packet, std::string_view interface_name, std::string& out) override;
};

/// Writes a pcap file of one link type (see link_record.h), little-endian, nanoseconds. Refuses
/// packets of other framings, and kBare ones without link type. Writes a missing time as 0, as one
/// before 1970, and one beyond the 32 bits of its seconds (2106) as the last possible one. Source:
/// draft-ietf-opsawg-pcap.
class PcapWriter final : public Writer {
 public:
  explicit PcapWriter(std::uint16_t link_type) : link_type_(link_type) {}
  using Writer::write;
  void begin(std::string& out) override;
  bool write(const Packet& packet, std::string_view interface_name, std::string& out) override;

 private:
  std::uint16_t link_type_;
};

/// Writes a pcapng file: an interface for each pair of link type and interface name, described
/// before its first packet; times in nanoseconds; direction flags; comments; at the end statistics
/// with the times of the first and the last packet. Takes everything but a kBare packet without
/// link type. A packet without time becomes a simple packet block, which has none; where such a
/// block cannot say all (another interface than the first, direction, comment, bytes that the
/// capture cut), it gets the time of the one before it. Source: draft-ietf-opsawg-pcapng.
class PcapngWriter final : public Writer {
 public:
  using Writer::write;
  void begin(std::string& out) override;
  bool write(const Packet& packet, std::string_view interface_name, std::string& out) override;
  void finish(std::string& out) override;

 private:
  struct Described {
    std::uint16_t link_type;
    std::string name;
    std::uint64_t packets;
  };
  std::uint32_t interface_of(std::uint16_t link_type, std::string_view name, std::string& out);

  std::vector<Described> interfaces_;
  std::string record_;
  std::int64_t last_ns_ = 0;
  std::int64_t first_ns_ = kNoTime;
  std::int64_t latest_ns_ = kNoTime;
};

/// Writes a packet a line in hex, bytes separated by spaces, as Listen prints them (from the
/// dispatch byte on; a radio frame from the frame control field on, without FCS). Refuses malformed
/// packets and frames that carry no packet. Source: TinyOS Listen tool.
class HexWriter final : public Writer {
 public:
  explicit HexWriter(bool upper_case = true) : upper_case_(upper_case) {}
  using Writer::write;
  bool write(const Packet& packet, std::string_view interface_name, std::string& out) override;

 private:
  bool upper_case_;
};

/// Returns a writer of that format, with its defaults; null for kUnknown and kJsonl. `link_type` is
/// that of a pcap file, which can hold only one.
std::unique_ptr<Writer> make_writer(InputFormat format, std::uint16_t link_type = 0);

/// Returns the link type under which a capture file holds `packet`; 0 if none.
std::uint16_t link_type_of(const Packet& packet);

/// Appends the record of `packet` in a capture file, as link_record.h reads it back.
void append_record(const Packet& packet, std::string& out);

}  // namespace rubric
