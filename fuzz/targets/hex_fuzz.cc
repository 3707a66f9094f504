// Property: any split of hex text gives the same packets, one for each line in which a plain parser
// finds bytes or which it cannot read; and the output of the sound ones reads back as the same.
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <sstream>

#include "codec/containers/hex_reader.h"
#include "codec/containers/link_record.h"
#include "fuzz/support/readers.h"
#include "fuzz/support/require.h"

namespace {

using namespace rubric;
using fuzz::Kept;
using fuzz::require;

// Returns the bytes of a line; nothing if it is no hex text.
std::optional<std::string> plain_line(std::string line) {
  line = line.substr(0, line.find('#'));
  std::string bytes;
  std::istringstream words(line);
  for (std::string word; words >> word;) {
    const bool led = word.size() >= 2 && word[0] == '0' && (word[1] == 'x' || word[1] == 'X');
    if (led) word.erase(0, 2);
    if (word.empty() || word.size() % 2 != 0) return std::nullopt;
    for (const char c : word) {
      if (std::isxdigit(static_cast<unsigned char>(c)) == 0) return std::nullopt;
    }
    bytes += testing::from_hex(word);
  }
  return bytes;
}

void check_lines(const std::string& text, const std::vector<Kept>& packets) {
  std::size_t next = 0;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string line = text.substr(begin, end - begin);
    if (begin == 0 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
    const std::optional<std::string> bytes =
        plain_line(line.substr(read_stamp(testing::view(line)).size));
    if (!bytes || !bytes->empty()) {
      require(next < packets.size(), "every line with bytes gives a packet");
      const Kept& packet = packets[next++];
      require(packet.packet.offset_bytes == begin, "a packet begins where its line does");
      require(packet.bytes == bytes.value_or(line), "a packet holds what its line says");
      const bool unreadable = packet.packet.error.fault == Fault::kUnexpected;
      require(unreadable == !bytes, "a line that is not hex text is refused");
    }
    begin = end + 1;
  }
  require(next == packets.size(), "no packet without a line");
}

void check_writer(const std::vector<Kept>& packets, const ReaderOptions& options) {
  HexWriter writer;
  std::string written;
  std::vector<Kept> wanted;
  for (const Kept& kept : packets) {
    const Framing framing = kept.packet.framing;
    const bool serial = framing == Framing::kHdlc || framing == Framing::kSf;
    const bool sound = kept.packet.error.fault == Fault::kNone && !kept.bytes.empty();
    const bool held = sound && !(serial && begins_serial_frame(testing::view(kept.bytes)));
    require(writer.write(kept.get(), written) == held, "sound packets can be written");
    if (!held) continue;
    wanted.push_back(fuzz::placeless(kept));
    // Lines begin at the dispatch byte, or end before the FCS.
    Packet& packet = wanted.back().packet;
    packet.kind = packet.serial_seq = packet.crc = packet.fcs = kAbsent;
    packet.time_ns = kNoTime;
    if (packet.framing == Framing::kHdlc) packet.framing = Framing::kSf;
    if (packet.framing == Framing::kRadio) packet.link_type = kLinkRadioNoFcs;
  }
  ReaderOptions plain{.hex_framing = options.hex_framing};
  if (plain.hex_framing == Framing::kHdlc) plain.hex_framing = Framing::kSf;
  HexReader reader(plain);
  std::vector<Kept> again = testing::read_all(reader, testing::view(written));
  for (Kept& kept : again) kept = fuzz::placeless(kept);
  fuzz::require_same(again, wanted, "what is written reads back as the same");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Bytes input(data, size);
  const std::string text(input.begin(), input.end());
  for (const Framing framing : {Framing::kBare, Framing::kSf, Framing::kHdlc, Framing::kRadio}) {
    ReaderOptions options{.hex_framing = framing, .hex_has_fcs = fuzz::hash_of(input) % 2 == 0};
    const auto make = [&] { return std::make_unique<HexReader>(options); };
    const std::vector<Kept> packets = fuzz::read_in_any_pieces(make, input);
    if (framing == Framing::kBare) check_lines(text, packets);
    check_writer(packets, options);
  }
  return 0;
}
