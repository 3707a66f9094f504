#include "codec/containers/pcapng_reader.h"

#include <algorithm>

#include "codec/containers/capture_time.h"
#include "codec/containers/link_record.h"
#include "codec/containers/pcapng_format.h"

namespace rubric {
namespace {

using namespace pcapng;

// Bounds on memory for interface descriptions.
constexpr std::size_t kInterfacesMax = 65536;
constexpr std::size_t kTextMax = 1024;

// The largest block that the search for a sound one accepts: a longest packet and its options.
constexpr std::size_t kSearchBlockMax = 2 * kCaptureRecordMax;

std::string_view text_of(Bytes value) {
  return {reinterpret_cast<const char*>(value.data()), value.size()};
}

// The end of the options, before the block's second length.
std::size_t content_end(Bytes block) { return block.size() - kBlockTrailerBytes; }

}  // namespace

UnitReader::Step PcapngReader::step(Bytes input, PacketSink sink) {
  if (damaged_) return search(input, sink);
  if (input.size() < kBlockMin) return want(kBlockMin);
  const Bytes header = input.first(kBlockMin);
  if (load_le32(input.data()) == kSectionHeader) {
    const bool little = load_le32(input.data() + 8) == kByteOrderMagic;
    if (!little && load_be32(input.data() + 8) != kByteOrderMagic) return damage(header, 8);
    big_endian_ = !little;
  } else if (!in_section_) {
    return damage(header, 0);
  }
  const std::size_t size = load32(input.data() + 4);
  if (size < kBlockMin || size % 4 != 0 || size > kPcapngBlockMax) return damage(header, 4);
  if (input.size() < size) return want(size);
  if (load32(input.data() + size - kBlockTrailerBytes) != size) {
    return damage(header, static_cast<std::uint32_t>(size - kBlockTrailerBytes));
  }
  block(input.first(size), sink);
  return used(size);
}

void PcapngReader::block(Bytes bytes, PacketSink sink) {
  const std::uint32_t type = load32(bytes.data());
  if (type == kSectionHeader) return section(bytes, sink);
  if (!supported_) return;
  switch (type) {
    case kInterfaceDescription: return interface_description(bytes, sink);
    case kEnhancedPacket:
    case kSimplePacket:
    case kObsoletePacket: return packet_block(bytes, type, sink);
    default: return;
  }
}

void PcapngReader::section(Bytes bytes, PacketSink sink) {
  in_section_ = true;
  supported_ = true;
  first_interface_ = interfaces_.size();
  snap_lengths_.clear();
  if (bytes.size() < kSectionHeaderMin) return deliver_bad_block(bytes, Fault::kContainer, 4, sink);
  if (load16(bytes.data() + 12) != kMajorVersion) {
    supported_ = false;
    deliver_bad_block(bytes, Fault::kUnsupported, 12, sink);
  }
}

// Takes the next option off `options`. Returns false at their end; `*sound` is false if they
// overrun.
bool PcapngReader::next_option(Bytes& options, Option* option, bool* sound) const {
  *sound = true;
  if (options.size() < 4) return false;
  option->code = load16(options.data());
  const std::size_t size = load16(options.data() + 2);
  if (option->code == kOptEnd) return false;
  const std::size_t padded = 4 + (size + 3) / 4 * 4;
  *sound = padded <= options.size();
  if (!*sound) return false;
  option->value = options.sub(4, size);
  options = options.from(padded);
  return true;
}

void PcapngReader::interface_description(Bytes bytes, PacketSink sink) {
  if (bytes.size() < kInterfaceMin || interfaces_.size() >= kInterfacesMax) {
    return deliver_bad_block(bytes, Fault::kContainer, 4, sink);
  }
  Interface interface;
  interface.link_type = link_read_as(load16(bytes.data() + 8), options_);
  Bytes options = bytes.sub(16, content_end(bytes) - 16);
  Option option;
  bool sound = true;
  while (next_option(options, &option, &sound)) {
    const Bytes value = option.value;
    const std::string_view text = text_of(value.first(std::min(value.size(), kTextMax)));
    if (option.code == kOptComment) interface.comment = text;
    if (option.code == kOptIfName) interface.name = text;
    if (option.code == kOptIfTsresol && value.size() == 1) {
      interface.ticks_per_second = ticks_of_resolution(value[0]);
    }
    if (option.code == kOptIfTsoffset && value.size() == 8) {
      const std::uint64_t high = load32(value.data() + (big_endian_ ? 0 : 4));
      const std::uint64_t low = load32(value.data() + (big_endian_ ? 4 : 0));
      interface.offset_seconds = static_cast<std::int64_t>(high << 32 | low);
    }
  }
  interfaces_.push_back(interface);
  snap_lengths_.push_back(load32(bytes.data() + 12));
  if (!sound) {
    const auto at = static_cast<std::size_t>(options.data() - bytes.data());
    deliver_bad_block(bytes, Fault::kContainer, at, sink);
  }
}

void PcapngReader::packet_block(Bytes bytes, std::uint32_t type, PacketSink sink) {
  const std::uint8_t* const p = bytes.data();
  const bool simple = type == kSimplePacket;
  const std::size_t fixed = simple ? kSimplePacketFixed : kEnhancedPacketFixed;
  if (bytes.size() < fixed + kBlockTrailerBytes) {
    return deliver_bad_block(bytes, Fault::kContainer, 4, sink);
  }
  Captured captured{};
  captured.data_at = fixed;
  captured.has_options = !simple;
  const std::size_t room = content_end(bytes) - fixed;
  if (simple) {
    captured.original_bytes = load32(p + 8);
    captured.captured_bytes = std::min<std::size_t>(captured.original_bytes, room);
    if (!snap_lengths_.empty() && snap_lengths_[0] != 0) {
      captured.captured_bytes = std::min<std::size_t>(captured.captured_bytes, snap_lengths_[0]);
    }
  } else {
    captured.interface = type == kEnhancedPacket ? load32(p + 8) : load16(p + 8);
    captured.ticks = std::uint64_t{load32(p + 12)} << 32 | load32(p + 16);
    captured.captured_bytes = load32(p + 20);
    captured.original_bytes = load32(p + 24);
  }
  if (captured.interface >= snap_lengths_.size()) {
    return deliver_bad_block(bytes, Fault::kContainer, 8, sink);
  }
  if (captured.captured_bytes > room || captured.captured_bytes > kCaptureRecordMax) {
    return deliver_bad_block(bytes, Fault::kContainer, simple ? 8 : 20, sink);
  }
  deliver(bytes, captured, sink);
}

void PcapngReader::deliver(Bytes bytes, const Captured& captured, PacketSink sink) {
  Packet packet{.interface_id = static_cast<std::uint32_t>(first_interface_ + captured.interface)};
  const Interface& interface = interfaces_[packet.interface_id];
  packet.offset_bytes = offset() + captured.data_at;
  if (captured.ticks) packet.time_ns = time_ns_of_ticks(*captured.ticks, interface);
  if (captured.has_options) {
    const std::size_t at = captured.data_at + (captured.captured_bytes + 3) / 4 * 4;
    // Accepts unpadded data at the end of a block that is too small for it.
    Bytes options = bytes.sub(std::min(at, content_end(bytes)),
                              content_end(bytes) - std::min(at, content_end(bytes)));
    Option option;
    bool sound = true;
    while (next_option(options, &option, &sound)) {
      if (option.code == kOptComment) packet.comment = text_of(option.value);
      // The same code and bits in enhanced and obsolete packet blocks.
      if (option.code == kOptPacketFlags && option.value.size() == 4) {
        const std::uint32_t direction = load32(option.value.data()) & kDirectionMask;
        if (direction == kDirectionInbound) packet.direction = Direction::kInbound;
        if (direction == kDirectionOutbound) packet.direction = Direction::kOutbound;
      }
    }
  }
  decode_record(bytes.sub(captured.data_at, captured.captured_bytes), captured.original_bytes,
                interface.link_type, "WIRE-PCAPNG"_rule, packet);
  sink(packet);
}

void PcapngReader::deliver_bad_block(Bytes bytes, Fault fault, std::size_t at, PacketSink sink) {
  Packet packet;
  packet.offset_bytes = offset();
  packet.bytes = bytes;
  packet.error = fail(fault, at, "WIRE-PCAPNG"_rule).error;
  sink(packet);
}

UnitReader::Step PcapngReader::damage(Bytes header, std::uint32_t offset_bytes) {
  damaged_ = true;
  damage_ = Packet();
  damage_.offset_bytes = offset();
  damage_.error = Error{Fault::kContainer, offset_bytes, "WIRE-PCAPNG"_rule};
  std::copy(header.begin(), header.end(), damaged_header_.begin());
  damage_.bytes = Bytes(damaged_header_.data(), damaged_header_.size());
  // The next sound block may begin anywhere after the first byte, even within these twelve.
  return used(1);
}

void PcapngReader::deliver_damage(PacketSink sink) {
  // The first twelve of the skipped bytes are in the packet.
  const std::uint64_t passed = offset() - damage_.offset_bytes;
  damage_.bytes = damage_.bytes.first(std::min<std::size_t>(damage_.bytes.size(), passed));
  damage_.dropped_bytes = passed - damage_.bytes.size();
  damaged_ = false;
  sink(damage_);
}

// Returns the size that a block at the front of `input` (at least 12 bytes) would have, if it can
// be one.
std::optional<std::size_t> PcapngReader::plausible_block(Bytes input, bool* big_endian) const {
  const std::uint8_t* const p = input.data();
  *big_endian = big_endian_;
  if (load_le32(p) == kSectionHeader) {
    *big_endian = load_be32(p + 8) == kByteOrderMagic;
    if (!*big_endian && load_le32(p + 8) != kByteOrderMagic) return std::nullopt;
  } else {
    const std::uint32_t type = *big_endian ? load_be32(p) : load_le32(p);
    if (!in_section_ || type == 0 || type > kEnhancedPacket) return std::nullopt;
  }
  const std::size_t size = *big_endian ? load_be32(p + 4) : load_le32(p + 4);
  if (size < kBlockMin || size % 4 != 0 || size > kSearchBlockMax) return std::nullopt;
  return size;
}

// Returns where the first sound block in `input` begins, or one that may become sound when more
// input comes (then *wanted is the number of bytes it needs); input.size() if there is none.
std::size_t PcapngReader::find_block(Bytes input, std::size_t* wanted) const {
  *wanted = 0;
  for (std::size_t at = 0; at < input.size(); ++at) {
    const Bytes rest = input.from(at);
    std::size_t needed = kBlockMin;
    bool big_endian = false;
    if (rest.size() >= kBlockMin) {
      const std::optional<std::size_t> size = plausible_block(rest, &big_endian);
      if (!size) continue;
      needed = *size;
    }
    if (rest.size() < needed) {
      if (final_) continue;
      *wanted = needed;
      return at;
    }
    const std::uint8_t* const trailer = rest.data() + needed - kBlockTrailerBytes;
    if ((big_endian ? load_be32(trailer) : load_le32(trailer)) == needed) return at;
  }
  return input.size();
}

UnitReader::Step PcapngReader::search(Bytes input, PacketSink sink) {
  std::size_t wanted = 0;
  const std::size_t at = find_block(input, &wanted);
  if (at != 0) return used(at);
  if (wanted != 0) return want(wanted);
  deliver_damage(sink);
  return step(input, sink);
}

void PcapngReader::end(Bytes rest, PacketSink sink) {
  final_ = true;
  const bool nothing_at_all = rest.empty() && !in_section_ && !damaged_;
  while (!rest.empty()) {
    Step done = step(rest, sink);
    if (done.used_bytes == 0) {
      // A block that the file cuts off, unless it is a length that hides sound blocks.
      std::size_t wanted = 0;
      if (rest.size() < kBlockMin || find_block(rest.from(1), &wanted) == rest.size() - 1) break;
      done = damage(rest.first(kBlockMin), 4);
    }
    advance(done.used_bytes);
    rest = rest.from(done.used_bytes);
  }
  if (damaged_) deliver_damage(sink);
  if (!rest.empty() || nothing_at_all) deliver_bad_block(rest, Fault::kCut, rest.size(), sink);
  final_ = false;
  in_section_ = false;
}

}  // namespace rubric
