#include "codec/containers/reader.h"

#include <algorithm>

#include "codec/containers/hdlc_reader.h"
#include "codec/containers/hex_reader.h"
#include "codec/containers/link_record.h"
#include "codec/containers/pcap_reader.h"
#include "codec/containers/pcapng_format.h"
#include "codec/containers/pcapng_reader.h"
#include "codec/containers/sf_reader.h"
#include "codec/runtime/hdlc.h"

namespace rubric {
namespace {

// More would not make the guess better.
constexpr std::size_t kSampleMax = 16 * 1024;
// A serial packet's header of 8 bytes; a shorter line of hex digits may be a word.
constexpr std::size_t kPacketLineBytes = 8;

bool is_pcap(Bytes first) {
  if (first.size() < 4) return false;
  for (std::uint32_t magic : {0xA1B2C3D4u, 0xA1B23C4Du}) {
    if (load_le32(first.data()) == magic || load_be32(first.data()) == magic) return true;
  }
  return false;
}

bool is_json(Bytes first) {
  for (std::uint8_t c : first) {
    if (c == ' ' || c == '\t' || c == '\r' || c == '\n') continue;
    return c == '{';
  }
  return false;
}

struct TextLines {
  bool hex = false;      // There is a line of hex text, or a comment.
  bool packets = false;  // There is a line that is long enough for a packet.
  bool others = false;   // There is a line that is neither hex text, nor a comment, nor empty.
  bool noise = true;     // All of those look like what tools print between packets.
};

TextLines look_at_lines(Bytes sample) {
  TextLines found;
  std::vector<std::uint8_t> bytes;
  for (const std::uint8_t* p = sample.begin(); p != sample.end();) {
    const std::uint8_t* const newline = std::find(p, sample.end(), '\n');
    const bool whole = newline != sample.end();
    const Bytes line(p, static_cast<std::size_t>(newline - p));
    const Error error = decode_hex_line(line, bytes);
    // The sample may end within a byte of its last line.
    if (error.fault != Fault::kNone && (whole || error.offset_bytes < line.size())) {
      found.others = true;
      found.noise = found.noise && is_noise(line);
    } else {
      const bool comment = std::find(line.begin(), line.end(), '#') != line.end();
      found.hex = found.hex || !bytes.empty() || comment;
      found.packets = found.packets || bytes.size() >= kPacketLineBytes;
    }
    p = whole ? newline + 1 : newline;
  }
  return found;
}

// Returns kHex if every line is hex text, a comment or empty, and not all are empty; kLog if there
// are packets among lines of noise.
InputFormat text_format(Bytes sample) {
  const TextLines found = look_at_lines(sample);
  if (found.hex && !found.others) return InputFormat::kHex;
  return found.packets && found.noise ? InputFormat::kLog : InputFormat::kUnknown;
}

// Returns whether there is an intact frame anywhere, or at least the beginning of one: a stream may
// begin in mid-frame.
bool is_hdlc(Bytes sample) {
  bool found = false;
  auto look = [&](const Packet& packet) {
    const bool known = packet.kind == kSerialAck || packet.kind == kSerialPacketAck ||
                       packet.kind == kSerialPacketNoAck || packet.kind == kSerialUnknown;
    const bool opened = packet.offset_bytes != 0 && packet.error.fault == Fault::kCut;
    // Bytes from the very start, between flags: a line that garbles its check sums is still one.
    const bool garbled = packet.error.fault == Fault::kCrc && sample[0] == kHdlcFlag;
    found = found || (known && (packet.error.fault == Fault::kNone || opened || garbled));
  };
  HdlcReader reader;
  reader.feed(sample, look);
  reader.finish(look);
  return found;
}

}  // namespace

std::uint16_t link_read_as(std::uint16_t link_type, const ReaderOptions& options) {
  if (link_type < kLinkUserFirst || link_type > kLinkUserLast) return link_type;
  const std::uint16_t other = options.user_links[link_type - kLinkUserFirst];
  return other == 0 ? link_type : other;
}

std::unique_ptr<Reader> make_reader(InputFormat format, const ReaderOptions& options) {
  switch (format) {
    case InputFormat::kHdlc: return std::make_unique<HdlcReader>(options);
    case InputFormat::kSf: return std::make_unique<SfReader>(options);
    case InputFormat::kPcap: return std::make_unique<PcapReader>(options);
    case InputFormat::kPcapng: return std::make_unique<PcapngReader>(options);
    case InputFormat::kHex: return std::make_unique<HexReader>(options);
    case InputFormat::kLog: return std::make_unique<HexReader>(options, true);
    case InputFormat::kUnknown:
    case InputFormat::kJsonl: break;
  }
  return nullptr;
}

InputFormat detect(Bytes first_bytes) {
  const Bytes sample = first_bytes.first(std::min(first_bytes.size(), kSampleMax));
  if (sample.size() >= 4 && load_le32(sample.data()) == pcapng::kSectionHeader) {
    return InputFormat::kPcapng;
  }
  if (is_pcap(sample)) return InputFormat::kPcap;
  if (sample.size() >= 2 && sample[0] == kSfMagic && sample[1] == kSfVersion) {
    return InputFormat::kSf;
  }
  if (is_json(sample)) return InputFormat::kJsonl;
  const InputFormat text = text_format(sample);
  if (text != InputFormat::kUnknown) return text;
  if (is_hdlc(sample)) return InputFormat::kHdlc;
  return InputFormat::kUnknown;
}

}  // namespace rubric
