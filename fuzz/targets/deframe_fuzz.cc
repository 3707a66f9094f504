// Property: any split of a serial line's bytes, on every path of this processor, gives the frames,
// places and faults that a plain byte-by-byte deframer finds, the mote's deframer agrees on the
// sound ones, and their output reads back as the same; so do any bytes that a mote writes.
#include <array>
#include <cstddef>
#include <cstdint>

#include "codec/containers/hdlc_reader.h"
#include "codec/containers/serial_frame.h"
#include "codec/runtime/hdlc.h"
#include "fuzz/support/readers.h"
#include "fuzz/support/require.h"
#include "fuzz/support/sums.h"

namespace {

using namespace rubric;
using fuzz::Kept;
using fuzz::require;

// The deframer's rules as a plain program, one byte after the other, to check the fast one.

constexpr std::size_t kKept = 4096;

enum class End { kFlag, kAborted, kInput };

Error error_at(Fault fault, std::size_t at, ReqId rule) {
  return Error{fault, static_cast<std::uint32_t>(at), rule};
}

Error judge(const std::string& content, const std::string& kept, End end) {
  if (end == End::kInput) return error_at(Fault::kCut, kept.size(), "WIRE-HDLC-FLAG"_rule);
  if (end == End::kAborted) return error_at(Fault::kAborted, kept.size(), "WIRE-HDLC-ESCAPE"_rule);
  const std::uint8_t kind = static_cast<std::uint8_t>(content[0]);
  const std::size_t most = kind == 0x43 || kind == 0x44 ? 256 : 255;
  if (content.size() > most) return error_at(Fault::kTooLong, most, "WIRE-HDLC-LONG"_rule);
  if (content.size() < 4) return error_at(Fault::kTooShort, content.size(), "WIRE-HDLC-SHORT"_rule);
  const std::size_t crc_at = content.size() - 2;
  const std::uint16_t crc = fuzz::crc_by_definition(testing::view(content).first(crc_at));
  const bool matches = content[crc_at] == static_cast<char>(crc & 0xFF) &&
                       content[crc_at + 1] == static_cast<char>(crc >> 8);
  if (!matches) return error_at(Fault::kCrc, crc_at, "WIRE-SERIAL-CRC"_rule);
  return error_at(Fault::kNone, 0, ReqId::kNone);
}

testing::Kept packet_of(const std::string& content, std::uint64_t offset, End end) {
  const std::string kept = content.substr(0, kKept);
  Packet packet;
  packet.framing = Framing::kHdlc;
  packet.offset_bytes = offset;
  packet.error = judge(content, kept, end);
  packet.dropped_bytes = content.size() - kept.size();
  std::string middle = kept;
  if (!middle.empty()) {
    packet.kind = static_cast<std::uint8_t>(middle[0]);
    middle.erase(0, 1);
  }
  if (packet.dropped_bytes == 0 && middle.size() >= 2) {
    const auto low = static_cast<std::uint8_t>(middle[middle.size() - 2]);
    const auto high = static_cast<std::uint8_t>(middle[middle.size() - 1]);
    packet.crc = high * 256 + low;
    middle.resize(middle.size() - 2);
  }
  if ((packet.kind == 0x43 || packet.kind == 0x44) && !middle.empty()) {
    packet.serial_seq = static_cast<std::uint8_t>(middle[0]);
    middle.erase(0, 1);
  }
  packet.bytes = testing::view(middle);
  return testing::Kept(packet);
}

/// Returns the required result of a HdlcReader for the whole of `stream`. Written from TEP 113,
/// section 3.1, and the rules in hdlc_reader.h and serial_frame.h; shares no code with the reader.
std::vector<Kept> plain_deframe(Bytes stream) {
  std::vector<testing::Kept> packets;
  std::string content;
  std::uint64_t begin = 0;
  bool open = false;
  bool escaped = false;
  for (std::size_t i = 0; i < stream.size(); ++i) {
    const std::uint8_t byte = stream[i];
    if (byte == 0x7E) {
      if (open) packets.push_back(packet_of(content, begin, escaped ? End::kAborted : End::kFlag));
      open = escaped = false;
      content.clear();
      continue;
    }
    if (!open) begin = i;
    open = true;
    if (byte == 0x7D && !escaped) {
      escaped = true;
      continue;
    }
    content += static_cast<char>(escaped ? byte ^ 0x20 : byte);
    escaped = false;
  }
  if (open) packets.push_back(packet_of(content, begin, End::kInput));
  return packets;
}

// Checks the frames that a mote with a buffer of any size finds.
void check_mote(Bytes stream, const std::vector<Kept>& wanted) {
  std::array<std::uint8_t, kHdlcKeptMax> buffer;
  HdlcDeframer deframer(MutableBytes(buffer.data(), buffer.size()));
  std::size_t next = 0;
  for (const std::uint8_t byte : stream) {
    const HdlcEvent event = deframer.push(byte);
    if (event == HdlcEvent::kNone) continue;
    require(next < wanted.size(), "the mote's deframer finds no frame more");
    const Kept& frame = wanted[next++];
    const bool sound = frame.packet.error.fault == Fault::kNone;
    require((event == HdlcEvent::kFrame) == sound, "the mote's deframer agrees on what is sound");
    if (!sound) {
      require(deframer.error() == frame.packet.error, "the mote's deframer finds the same fault");
      continue;
    }
    std::string content;
    append_serial_content(frame.get(), content);
    content.resize(content.size() - kSerialCrcBytes);
    require(equal(deframer.content(), testing::view(content)), "the mote's frames hold the same");
  }
  const bool rest = !wanted.empty() && wanted.back().packet.error.fault == Fault::kCut;
  require(next + rest == wanted.size(), "the mote's deframer misses no frame");
}

void check_writer(const std::vector<Kept>& packets) {
  HdlcWriter writer;
  std::string written;
  std::vector<Kept> wanted;
  for (const Kept& kept : packets) {
    if (kept.packet.dropped_bytes != 0) continue;  // It cannot be written whole.
    require(writer.write(kept.get(), written), "every packet of a serial line can be written");
    wanted.push_back(fuzz::placeless(kept));
  }
  HdlcReader reader;
  std::vector<Kept> again = testing::read_all(reader, testing::view(written));
  for (Kept& kept : again) kept = fuzz::placeless(kept);
  fuzz::require_same(again, wanted, "what is written reads back as the same");
}

// Writes any bytes as the content of a frame, in a buffer of exactly their size.
void check_mote_writer(Bytes content) {
  std::array<std::uint8_t, hdlc_frame_room(kHdlcKeptMax)> room;
  const std::size_t max = serial_content_max(content.empty() ? 0 : content[0]) - kSerialCrcBytes;
  const auto size = write_hdlc_frame(content, MutableBytes(room.data(), room.size()));
  require(size.has_value() == (content.size() <= max), "just too long a frame is refused");
  if (!size) return require(size.error().fault == Fault::kTooLong, "and that is why");
  const Bytes frame(room.data(), *size);

  std::array<std::uint8_t, kHdlcKeptMax> buffer;
  HdlcDeframer deframer(MutableBytes(buffer.data(), buffer.size()));
  HdlcEvent event = HdlcEvent::kNone;
  for (const std::uint8_t byte : frame) event = deframer.push(byte);
  const bool shown = content.size() + kSerialCrcBytes >= kSerialContentMin;
  require((event == HdlcEvent::kFrame) == shown, "what a mote writes is a sound frame");
  if (shown) require(equal(deframer.content(), content), "of the same content");

  std::array<std::uint8_t, hdlc_frame_room(kHdlcKeptMax)> other;
  const auto less = write_hdlc_frame(content, MutableBytes(other.data(), *size - 1));
  require(!less && less.error().fault == Fault::kNoRoom, "a byte less of room is refused");
  if (content.empty() || (content[0] != kSerialPacketAck && content[0] != kSerialPacketNoAck)) {
    return;
  }
  const bool numbered = content[0] == kSerialPacketAck;
  if (numbered && content.size() < 2) return;
  const Bytes packet = content.from(numbered ? 2 : 1);
  const MutableBytes out(other.data(), other.size());
  const auto again = numbered ? write_serial_packet_ack(content[1], packet, out)
                              : write_serial_packet(packet, out);
  require(again && equal(Bytes(other.data(), *again), frame), "a packet makes the same frame");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Bytes stream(data, size);
  const std::vector<Kept> wanted = plain_deframe(stream);
  for (const CpuPath path : {CpuPath::kPortable, CpuPath::kVector, CpuPath::kWide}) {
    if (!cpu_has(path)) continue;
    const auto make = [path] { return std::make_unique<HdlcReader>(ReaderOptions{}, path); };
    fuzz::require_same(fuzz::read_in_any_pieces(make, stream), wanted,
                       "the reader finds what a plain deframer finds");
  }
  check_mote(stream, wanted);
  check_writer(wanted);
  check_mote_writer(stream);
  return 0;
}
