#include "tools/encode/packet_output.h"

#include <fmt/format.h>

#include "codec/containers/link_record.h"
#include "codec/reflect/fault_text.h"

namespace rubric::encode {
namespace {

constexpr std::string_view kHdlc = "hdlc";
constexpr std::string_view kSf = "sf";
constexpr std::string_view kHex = "hex";
constexpr std::string_view kPcap = "pcap";

std::string_view link_type_name(std::uint16_t link_type) {
  switch (link_type) {
    case kLinkSerial: return "serial frames";
    case kLinkSf: return "serial forwarder packets";
    case kLinkRadioFcs: return "radio frames with FCS";
    case kLinkRadioNoFcs: return "radio frames without FCS";
    case kLinkRadioTap: return "radio frames with TAP header";
    default: return "packets of no link type";
  }
}

// Returns why a writer refused a packet.
std::string reason(std::string_view container, const Packet& packet, std::uint16_t link_type) {
  if (container == kPcap && link_type_of(packet) != link_type) {
    return fmt::format("pcap holds one link type, here {}, and no {}", link_type_name(link_type),
                       link_type_name(link_type_of(packet)));
  }
  if (packet.framing == Framing::kBare && packet.error.fault == Fault::kNone) {
    return fmt::format("{} holds framed packets, no bare messages", container);
  }
  if (packet.framing == Framing::kRadio && (container == kHdlc || container == kSf)) {
    return fmt::format("{} holds no radio frames", container);
  }
  if (packet.cut_by_capture()) {
    return fmt::format("{} holds no frames of which the capture has a part", container);
  }
  if (packet.error.fault != Fault::kNone) {
    return fmt::format("{} holds no malformed frames: {}", container,
                       reflect::fault_sentence(packet.error.fault));
  }
  if (packet.bytes.empty()) return fmt::format("{} holds no frames without a packet", container);
  return fmt::format("{} holds no packet of {} bytes", container, packet.bytes.size());
}

}  // namespace

const std::vector<std::string>& container_names() {
  static const std::vector<std::string> names = {"hex", "hdlc", "sf", "pcap", "pcapng"};
  return names;
}

Holds holds(std::string_view container) {
  const bool pcapng = container == "pcapng";
  return {pcapng || container == kPcap, pcapng, pcapng, pcapng};
}

PacketOutput::PacketOutput(std::string_view container, const std::string& path)
    : container_(container), output_(path, cli::Output::Mode::kWhole) {}

// Makes the writer. A pcap file takes the link type of its first packet.
bool PacketOutput::make_writer(const Packet& first) {
  if (container_ == kHdlc) writer_ = std::make_unique<HdlcWriter>();
  if (container_ == kSf) writer_ = std::make_unique<SfWriter>();
  if (container_ == kHex) writer_ = std::make_unique<HexWriter>();
  if (container_ == "pcapng") writer_ = std::make_unique<PcapngWriter>();
  if (container_ == kPcap) {
    link_type_ = link_type_of(first);
    if (link_type_ == 0) return false;
    writer_ = std::make_unique<PcapWriter>(link_type_);
  }
  writer_->begin(bytes_);
  output_.buffer().append(bytes_);
  return true;
}

std::string PacketOutput::write(const Packet& packet, std::string_view interface_name) {
  cut_refused_ = false;
  const bool cut_short = packet.error.fault == Fault::kTooLong ||
                         (packet.error.fault == Fault::kCut && container_ == kHdlc);
  if (packet.framing == Framing::kHdlc && cut_short && packet.dropped_bytes) {
    return fmt::format("{} bytes of this frame were dropped when it was read",
                       packet.dropped_bytes);
  }
  if (packet.error.requirement == "WIRE-SF-HANDSHAKE"_rule) {
    return "the handshake of a stream is written whole, or not at all";
  }
  if (!writer_ && !make_writer(packet)) return reason(container_, packet, link_type_);
  bytes_.clear();
  if (!writer_->write(packet, interface_name, bytes_)) {
    return reason(container_, packet, link_type_);
  }
  cut_refused_ = !cut_.empty();
  cut_.clear();
  const bool is_stream = container_ == kHdlc || container_ == kSf;
  if (is_stream && packet.error.fault == Fault::kCut) {
    cut_ = bytes_;
  } else {
    output_.buffer().append(bytes_);
    output_.drain();
  }
  return {};
}

bool PacketOutput::finish() {
  if (!writer_) {
    Packet none{.framing = Framing::kHdlc};
    make_writer(none);
  }
  output_.buffer().append(cut_);
  bytes_.clear();
  writer_->finish(bytes_);
  output_.buffer().append(bytes_);
  return output_.finish();
}

}  // namespace rubric::encode
