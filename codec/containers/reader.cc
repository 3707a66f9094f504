#include "codec/containers/reader.h"

#include <algorithm>

#include "codec/containers/hdlc_reader.h"
#include "codec/containers/hex_reader.h"
#include "codec/containers/link_record.h"
#include "codec/containers/pcap_reader.h"
#include "codec/containers/pcapng_format.h"
#include "codec/containers/pcapng_reader.h"
#include "codec/containers/radio_line.h"
#include "codec/containers/sf_reader.h"
#include "codec/runtime/hdlc.h"

namespace rubric {
namespace {

// More would not make the guess better.
constexpr std::size_t kSampleMax = 16 * 1024;

Bytes sample_of(Bytes first_bytes) {
  return first_bytes.first(std::min(first_bytes.size(), kSampleMax));
}

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
  bool hex = false;           // There is a line of hex text, or a comment.
  bool packets = false;       // There is a line that is long enough for a packet.
  bool others = false;        // There is a line that is neither hex text, nor a comment, nor empty.
  bool noise = true;          // All of those look like what tools print between packets.
  std::size_t of_bytes = 0;   // Lines of hex text that have bytes.
  std::size_t with_fcs = 0;   // Of those: end with the FCS of the bytes before.
  std::size_t dump_rows = 0;  // Lines that are as a row of a hex dump.
};

// Returns whether a line is as a row of a hex dump: an offset that is a multiple of 16, a colon or
// blanks, and bytes. One that begins with 0000 has eight bytes at least, as it may be hex text,
// too.
bool is_dump_row(Bytes line) {
  constexpr std::ptrdiff_t kEightBytes = 24;
  const auto* const end = std::find_if_not(line.begin(), line.end(), is_hex_digit);
  const auto digits = end - line.begin();
  if (digits < 4 || digits > 8 || end[-1] != '0' || line.end() - end < 4) return false;
  if (*end == ':') return true;
  const auto* const byte = std::find_if(end, line.end(), [](char c) { return c != ' '; });
  const bool apart = line.end() - byte > 1 && is_hex_digit(byte[0]) && is_hex_digit(byte[1]) &&
                     (line.end() - byte == 2 || byte[2] == ' ');
  const bool first = std::all_of(line.begin(), end, [](char c) { return c == '0'; });
  return *end == ' ' && apart && (!first || line.end() - byte >= kEightBytes - 1);
}

TextLines look_at_lines(Bytes sample) {
  TextLines found;
  std::vector<std::uint8_t> bytes;
  RadioLine stated;
  for (const std::uint8_t* p = sample.begin(); p != sample.end();) {
    const std::uint8_t* const newline = std::find(p, sample.end(), '\n');
    const bool whole = newline != sample.end();
    const Bytes written(p, static_cast<std::size_t>(newline - p));
    p = whole ? newline + 1 : newline;
    const std::size_t stamp = read_stamp(written).size;
    const Bytes line = written.from(stamp);
    found.others = found.others || stamp != 0;
    found.dump_rows += is_dump_row(line);
    if (read_radio_line(line, stated, bytes)) {
      found.packets = found.others = true;
      continue;
    }
    const Error error = decode_hex_line(line, bytes);
    // A line may be cut within a byte, and the sample may end there.
    const bool cut = error.fault != Fault::kNone && error.offset_bytes >= line.size();
    if (error.fault != Fault::kNone && !cut) {
      found.others = true;
      found.noise = found.noise && is_noise(line);
    } else if (!cut || !whole) {
      const bool comment = std::find(line.begin(), line.end(), '#') != line.end();
      found.hex = found.hex || !bytes.empty() || comment;
      found.packets = found.packets || bytes.size() >= kPacketLineBytes;
      found.of_bytes += !bytes.empty();
      found.with_fcs += ends_with_fcs(Bytes(bytes.data(), bytes.size()));
    }
  }
  return found;
}

bool is_hex_dump(const TextLines& found) {
  return found.dump_rows != 0 && 2 * found.dump_rows >= found.of_bytes;
}

// Returns kHex if every line is hex text, a comment or empty, and not all are empty; kLog if there
// are packets among lines of noise.
InputFormat text_format(Bytes sample) {
  const TextLines found = look_at_lines(sample);
  if (is_hex_dump(found)) return InputFormat::kUnknown;
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

bool is_hex_dump(Bytes first_bytes) { return is_hex_dump(look_at_lines(sample_of(first_bytes))); }

PrefixedLine find_prefixed_line(Bytes first_bytes) {
  Bytes rest = sample_of(first_bytes);
  for (std::uint64_t number = 1; !rest.empty(); ++number) {
    const auto size =
        static_cast<std::size_t>(std::find(rest.begin(), rest.end(), '\n') - rest.begin());
    const std::size_t prefix = unknown_prefix(rest.first(size));
    if (prefix != 0) return {number, rest.first(prefix)};
    rest = rest.from(std::min(size + 1, rest.size()));
  }
  return {};
}

bool lines_end_with_fcs(Bytes first_bytes) {
  const Bytes sample = sample_of(first_bytes);
  const TextLines found = look_at_lines(sample.from(mark_size(sample)));
  return found.with_fcs != 0 && 2 * found.with_fcs >= found.of_bytes;
}

InputFormat detect(Bytes first_bytes) {
  const Bytes sample = sample_of(first_bytes);
  if (sample.size() >= 4 && load_le32(sample.data()) == pcapng::kSectionHeader) {
    return InputFormat::kPcapng;
  }
  if (is_pcap(sample)) return InputFormat::kPcap;
  if (sample.size() >= 2 && sample[0] == kSfMagic && sample[1] == kSfVersion) {
    return InputFormat::kSf;
  }
  const Bytes written = sample.from(mark_size(sample));
  if (is_json(written)) return InputFormat::kJsonl;
  const InputFormat text = text_format(written);
  if (text != InputFormat::kUnknown) return text;
  if (is_hdlc(sample)) return InputFormat::kHdlc;
  return InputFormat::kUnknown;
}

}  // namespace rubric
