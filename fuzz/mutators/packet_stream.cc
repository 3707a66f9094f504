#include "fuzz/mutators/packet_stream.h"

#include <algorithm>
#include <cstring>
#include <memory>

#include "codec/containers/crc16_fast.h"
#include "codec/containers/link_record.h"
#include "codec/containers/serial_frame.h"
#include "codec/reflect/am_frames.h"
#include "codec/runtime/hdlc.h"

namespace rubric::fuzz {
namespace {

using IFrame = rubicon::RadioIFrameLayout;
using Mac = tinyos::MacHeaderLayout;
constexpr std::size_t kAmLengthMax = 255;

void put(std::vector<std::uint8_t>& out, std::size_t at, std::size_t width, bool little,
         std::uint32_t value) {
  if (at + width > out.size()) return;
  for (std::size_t i = 0; i < width; ++i) {
    const std::size_t shift = 8 * (little ? i : width - 1 - i);
    out[at + i] = static_cast<std::uint8_t>(value >> shift);
  }
}

// Returns whether the bytes lead to the route's message by their types. Wider choices are
// addresses, of which any but one may occur as well.
bool follows(const reflect::Route& route, const std::vector<std::uint8_t>& bytes) {
  for (std::size_t i = 0; i < route.choice_count; ++i) {
    const reflect::RouteChoice& choice = route.choices[i];
    if (choice.width_bytes != 1) continue;
    if (choice.offset >= bytes.size() || bytes[choice.offset] != choice.value) return false;
  }
  return true;
}

const char* carrier_of(const StreamPacket& packet) {
  if (packet.packet.framing != Framing::kRadio) return "serial";
  const bool network = packet.bytes.size() >= IFrame::NetworkAt::kEnd &&
                       IFrame::NetworkAt::allows(packet.bytes[IFrame::NetworkAt::kAt]);
  return network ? "radio_i" : "radio_t";
}

// Returns the serial packet with the contents of an I-frame.
std::vector<std::uint8_t> as_serial(const std::vector<std::uint8_t>& frame) {
  if (frame.size() < reflect::kRadioIHeaderBytes) return frame;
  const std::uint8_t* const p = frame.data();
  const Bytes payload = Bytes(p, frame.size()).from(reflect::kRadioIHeaderBytes);
  std::vector<std::uint8_t> out =
      reflect::serial_packet({.dest = Mac::DestAt::load(p),
                              .src = Mac::SrcAt::load(p),
                              .group = static_cast<std::uint8_t>(Mac::DestpanAt::load(p)),
                              .type = static_cast<std::uint8_t>(IFrame::TypeAt::load(p))},
                             payload);
  const std::size_t length = std::min(payload.size(), kAmLengthMax);
  tinyos::AmHeaderLayout::LengthAt::store(out.data(), static_cast<std::uint8_t>(length));
  return out;
}

}  // namespace

Packet StreamPacket::view() const {
  Packet out = packet;
  out.bytes = Bytes(bytes.data(), bytes.size());
  out.comment = comment;
  return out;
}

PacketStream read_stream(InputFormat format, Bytes input) {
  PacketStream stream;
  stream.format = format;
  const std::unique_ptr<Reader> reader = make_reader(format);
  auto take = [&](const Packet& packet) {
    StreamPacket kept;
    kept.packet = packet;
    kept.packet.bytes = Bytes();
    kept.packet.comment = {};
    kept.bytes.assign(packet.bytes.begin(), packet.bytes.end());
    kept.comment = packet.comment;
    const std::vector<Interface>& interfaces = reader->interfaces();
    if (packet.interface_id < interfaces.size()) {
      kept.interface_name = interfaces[packet.interface_id].name;
    }
    stream.packets.push_back(std::move(kept));
  };
  reader->feed(input, take);
  reader->finish(take);
  if (format == InputFormat::kPcap && !reader->interfaces().empty()) {
    stream.link_type = reader->interfaces()[0].link_type;
  }
  return stream;
}

std::vector<std::uint8_t> write_stream(const PacketStream& stream) {
  const std::unique_ptr<Writer> writer = make_writer(stream.format, stream.link_type);
  std::string out;
  writer->begin(out);
  for (const StreamPacket& packet : stream.packets) {
    writer->write(packet.view(), packet.interface_name, out);
  }
  writer->finish(out);
  return {out.begin(), out.end()};
}

std::vector<std::uint8_t> write_within(PacketStream& stream, std::size_t max_size,
                                       generate::Random& random) {
  for (;;) {
    std::vector<std::uint8_t> out = write_stream(stream);
    if (out.size() <= max_size) return out;
    if (stream.packets.empty()) {
      out.resize(max_size);
      return out;
    }
    // In proportion to the excess, so that long streams are not written a hundred times.
    const std::size_t excess = out.size() - max_size;
    std::size_t gone = std::max<std::size_t>(1, stream.packets.size() * excess / out.size());
    for (; gone > 0; --gone) {
      const std::size_t at = random.below(stream.packets.size());
      stream.packets.erase(stream.packets.begin() + static_cast<std::ptrdiff_t>(at));
    }
  }
}

bool takes_radio(const PacketStream& stream) {
  if (stream.format == InputFormat::kPcapng) return true;
  return stream.format == InputFormat::kPcap &&
         (stream.link_type == kLinkRadioFcs || stream.link_type == kLinkRadioNoFcs);
}

bool takes_serial(const PacketStream& stream) {
  if (stream.format != InputFormat::kPcap) return true;
  return stream.link_type == kLinkSerial || stream.link_type == kLinkSf;
}

StreamPacket make_packet(const generate::Generated& frame, const PacketStream& stream,
                         generate::Random& random) {
  StreamPacket out;
  out.bytes = frame.bytes;
  Packet& packet = out.packet;
  const bool file = stream.format == InputFormat::kPcap || stream.format == InputFormat::kPcapng;
  if (frame.framing == Framing::kRadio && takes_radio(stream)) {
    packet.framing = Framing::kRadio;
    const bool has_fcs = stream.format == InputFormat::kPcap ? stream.link_type == kLinkRadioFcs
                                                             : random.below(4) != 0;
    packet.fcs = has_fcs ? 0 : kAbsent;
    packet.link_type = has_fcs ? kLinkRadioFcs : kLinkRadioNoFcs;
  } else {
    if (frame.framing == Framing::kRadio) out.bytes = as_serial(frame.bytes);
    const bool hdlc = stream.format == InputFormat::kHdlc || stream.link_type == kLinkSerial ||
                      (stream.format == InputFormat::kPcapng && random.below(4) != 0);
    packet.framing = hdlc ? Framing::kHdlc : Framing::kSf;
    if (hdlc) packet.kind = random.below(4) == 0 ? kSerialPacketAck : kSerialPacketNoAck;
    if (hdlc && packet.kind == kSerialPacketAck) {
      packet.serial_seq = static_cast<std::int32_t>(random.below(256));
    }
    if (file) packet.link_type = hdlc ? kLinkSerial : kLinkSf;
  }
  repair_sums(out);
  return out;
}

void repair_sums(StreamPacket& packet) {
  packet.packet.error = Error{Fault::kNone, 0, ReqId::kNone};
  packet.packet.dropped_bytes = 0;
  if (packet.packet.framing == Framing::kRadio && packet.packet.fcs != kAbsent) {
    packet.packet.fcs = fcs_fast(Bytes(packet.bytes.data(), packet.bytes.size()));
  }
  if (packet.packet.framing != Framing::kHdlc) return;
  if (packet.packet.kind == kAbsent) packet.packet.kind = kSerialPacketNoAck;
  const bool has_seq = serial_kind_has_seq(packet.packet.kind);
  if (has_seq == (packet.packet.serial_seq == kAbsent)) {
    packet.packet.serial_seq = has_seq ? 0 : kAbsent;
  }
  packet.packet.crc = kAbsent;
  std::string content;
  append_serial_content(packet.view(), content);
  packet.packet.crc =
      crc16_fast(Bytes(reinterpret_cast<const std::uint8_t*>(content.data()), content.size()));
}

void repair_lengths(StreamPacket& packet, const reflect::RouteTable& routes) {
  const char* const carrier = carrier_of(packet);
  const reflect::Route* best = nullptr;
  for (std::size_t i = 0; i < routes.count; ++i) {
    const reflect::Route& route = routes.routes[i];
    if (std::strcmp(route.carrier, carrier) != 0 || !follows(route, packet.bytes)) continue;
    if (best == nullptr || route.choice_count > best->choice_count) best = &route;
  }
  if (best == nullptr) return;
  for (std::size_t i = 0; i < best->length_count; ++i) {
    const reflect::RouteLength& length = best->lengths[i];
    const std::size_t from = std::min<std::size_t>(length.from, packet.bytes.size());
    const std::size_t bytes = packet.bytes.size() - from;
    put(packet.bytes, length.offset, length.width_bytes, length.little_endian,
        static_cast<std::uint32_t>(std::min(bytes, kAmLengthMax)));
  }
}

}  // namespace rubric::fuzz
