// Property: a captured record of any radio link type is split like a plain reading of 802.15.4, FCS
// and addresses included, and its output reads back as the same; so does one in a ZEP datagram.
#include <cstddef>
#include <cstdint>

#include "codec/containers/link_record.h"
#include "codec/containers/zep_packet.h"
#include "codec/reflect/frame.h"
#include "codec/reflect/registry.h"
#include "codec/runtime/crc16.h"
#include "fuzz/support/input.h"
#include "fuzz/support/readers.h"
#include "fuzz/support/require.h"
#include "fuzz/support/sums.h"

namespace {

using namespace rubric;
using fuzz::Kept;
using fuzz::require;

void check_sum(const Kept& kept, std::size_t record_size) {
  const Packet& packet = kept.packet;
  require(packet.framing == Framing::kRadio, "a radio record holds a radio frame");
  require(kept.bytes.size() + (packet.fcs == kAbsent ? 0 : 2) <= record_size,
          "a frame lies within its record");
  const Fault fault = packet.error.fault;
  if (packet.fcs == kAbsent || (fault != Fault::kNone && fault != Fault::kFcs)) return;
  require(
      (fuzz::fcs_by_definition(testing::view(kept.bytes)) == packet.fcs) == (fault == Fault::kNone),
      "a frame is sound where its FCS is that of its bytes");
}

// A frame that lost four bytes behind it lost its FCS of 32 bits.
void check_wide_sum(Bytes record, const Kept& kept) {
  const Fault fault = kept.packet.error.fault;
  const std::size_t begin = kept.packet.offset_bytes;
  const std::size_t size = kept.bytes.size();
  if (begin + size + 4 != record.size() || (fault != Fault::kNone && fault != Fault::kFcs)) return;
  std::string padded = kept.bytes;
  padded.resize(size < 4 ? 4 : size);
  const std::uint32_t sum = load_le32(record.end() - 4);
  const bool fits = sum == fuzz::crc32_by_definition(testing::view(kept.bytes)) ||
                    sum == fuzz::crc32_by_definition(testing::view(padded));
  require(fits == (fault == Fault::kNone), "a frame is sound where its wide FCS is that of it");
}

unsigned little(const Kept& kept, std::size_t at) {
  const auto low = static_cast<std::uint8_t>(kept.bytes[at]);
  return static_cast<unsigned>(static_cast<std::uint8_t>(kept.bytes[at + 1])) << 8 | low;
}

// IEEE 802.15.4-2006, section 7.2.1.1, by the fields of the frame control. Later versions place
// short addresses of one PAN alike.
void check_addresses(const Kept& kept, const reflect::Frame& frame) {
  require(frame.mac.present == (kept.bytes.size() >= 3), "three bytes have control and number");
  if (kept.bytes.size() < 9) return require(!frame.mac.has_addresses, "addresses need nine bytes");
  const unsigned control = little(kept, 0);
  const bool data = (control & 7u) == 1;
  const bool secured = (control >> 3 & 1u) != 0;
  const bool one_pan = (control >> 6 & 1u) != 0;
  const bool short_dest = (control >> 10 & 3u) == 2;
  const bool short_src = (control >> 14 & 3u) == 2;
  const bool newer = (control >> 8 & 3u) != 0;  // Of 2015: no number, or information elements.
  const bool usual = data && !secured && one_pan && short_dest && short_src && !newer;
  require(frame.mac.has_addresses == usual, "short addresses of one PAN are read, others not");
  if (!usual) return require(!frame.am.present, "only data frames carry active messages");
  require(frame.mac.destpan == little(kept, 3) && frame.mac.dest == little(kept, 5) &&
              frame.mac.src == little(kept, 7),
          "addresses follow the sequence number");
  if (kept.bytes.size() < 10) return;
  const bool network = kept.bytes[9] == 0x3F;
  const std::size_t type_at = network ? 10 : 9;
  require(frame.am.present == (kept.bytes.size() > type_at), "an AM type makes an active message");
  if (!frame.am.present) return;
  require(frame.am.type == static_cast<std::uint8_t>(kept.bytes[type_at]) &&
              frame.am.length == kept.bytes.size() - type_at - 1,
          "type and length of the active message");
}

void check_append(const Kept& kept) {
  const Packet packet = kept.get();
  std::string record;
  append_record(packet, record);
  Packet again;
  decode_record(testing::view(record), record.size() + packet.dropped_bytes, link_type_of(packet),
                "WIRE-PCAP"_rule, again);
  Kept wanted = fuzz::placeless(kept);
  wanted.packet.link_type = link_type_of(packet);
  if (packet.error.fault == Fault::kFcs && packet.fcs == kAbsent) {  // One of 32 bits.
    require(again.fcs != kAbsent, "a wrong FCS that is not known is written as another wrong one");
    wanted.packet.fcs = again.fcs;
  }
  fuzz::require_same({fuzz::placeless(Kept(again))}, {wanted}, "a record reads back as the same");
}

// Any bytes as a datagram, and as the frame in a sound one.
void check_zep(Bytes bytes) {
  Packet packet;
  if (decode_zep_datagram(bytes, packet)) {
    require(packet.offset_bytes + packet.bytes.size() <= bytes.size(), "a frame in its datagram");
  }
  ZepPacket zep;
  if (const auto foreign = parse_zep(bytes)) zep = *foreign;
  if (zep.time_ns < 0) zep.time_ns = kNoTime;  // Before 1970; it is not written.
  zep.has_fcs = true;
  zep.type = ZepPacket::Type::kData;
  zep.frame = bytes.first(bytes.size() < 255 ? bytes.size() : 255);
  std::string datagram;
  append_zep(zep, datagram);
  const Bytes written = testing::view(datagram);
  const auto again = parse_zep(written);
  require(again && again->sequence == zep.sequence && again->device == zep.device &&
              again->channel == zep.channel && again->time_ns == zep.time_ns,
          "a ZEP packet reads back as the same");
  Packet wrapped;
  Packet plain;
  require(decode_zep_datagram(written, wrapped) == !zep.frame.empty(), "a frame is found");
  if (zep.frame.empty()) return;
  decode_radio_record(zep.frame, kLinkRadioFcs, plain);
  if (plain.error.fault == Fault::kFcs && plain.fcs == crc16(plain.bytes)) {  // RIOT's.
    plain.error = Packet().error;
    plain.fcs = kAbsent;
  }
  require(wrapped.error == plain.error && wrapped.fcs == plain.fcs &&
              Kept(wrapped).bytes == Kept(plain).bytes,
          "a frame in a ZEP packet is read as one in a capture");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::uint16_t kLinks[] = {kLinkRadioFcs, kLinkRadioNoFcs, kLinkRadioTap};
  fuzz::Input input(data, size);
  const std::uint16_t link_type = kLinks[input.below(std::size(kLinks))];
  // Mostly a record is captured whole.
  const std::size_t missing = input.u8() % 8 == 7 ? 1 + input.u8() : 0;
  const Bytes record = input.rest();
  check_zep(record);
  Packet packet;
  decode_record(record, record.size() + missing, link_type, "WIRE-PCAP"_rule, packet);
  require(packet.offset_bytes + packet.bytes.size() <= record.size(), "a frame lies in its record");
  if (packet.framing == Framing::kBare) {
    require(link_type == kLinkRadioTap && packet.error.fault != Fault::kNone,
            "a record has no radio frame where its header cannot be read");
    return 0;
  }
  const Kept kept(packet);
  check_sum(kept, record.size());
  if (missing != 0 || link_type == kLinkRadioNoFcs) {
    require(packet.fcs == kAbsent, "a frame without its end has no FCS");
  } else if (link_type == kLinkRadioFcs && record.size() >= 2) {
    require(packet.fcs == load_le16(record.end() - 2), "the FCS is what the frame ends with");
  }
  if (missing == 0 && link_type == kLinkRadioTap && packet.fcs == kAbsent) {
    check_wide_sum(record, kept);
  }
  check_append(kept);

  static const reflect::FrameDecoder decoder(*reflect::find_protocol("rubicon"));
  static reflect::Frame frame;
  decoder.decode(packet, frame);
  check_addresses(kept, frame);
  return 0;
}
