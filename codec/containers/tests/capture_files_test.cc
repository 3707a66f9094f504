// Capture files: both formats, both byte orders, damage, and the writers' output.
#include <gtest/gtest.h>

#include "codec/containers/link_record.h"
#include "codec/containers/pcap_reader.h"
#include "codec/containers/pcapng_reader.h"
#include "codec/containers/tests/testing.h"

namespace rubric {
namespace {

using namespace testing;

// Builds files by hand, in either byte order.
struct File {
  bool big = false;
  std::string out;

  std::string n(std::uint64_t value, int size) const {
    std::string text;
    for (int i = 0; i < size; ++i) {
      const int shift = 8 * (big ? size - 1 - i : i);
      text += static_cast<char>(value >> shift);
    }
    return text;
  }
  static std::string padded(std::string text) {
    text.resize((text.size() + 3) / 4 * 4);
    return text;
  }
  std::string option(unsigned code, const std::string& value) const {
    return n(code, 2) + n(value.size(), 2) + padded(value);
  }
  void block(std::uint32_t type, const std::string& body) {
    const std::string length = n(body.size() + 12, 4);
    out += n(type, 4) + length + body + length;
  }
  void section(unsigned major = 1) {
    block(0x0A0D0D0A, n(0x1A2B3C4D, 4) + n(major, 2) + n(0, 2) + n(UINT64_MAX, 8));
  }
  void interface(unsigned link_type, const std::string& options = {}, unsigned snap = 0) {
    block(1, n(link_type, 2) + n(0, 2) + n(snap, 4) + options);
  }
  void packet(unsigned interface_id, std::uint64_t ticks, const std::string& data,
              const std::string& options = {}, std::size_t more = 0) {
    block(6, n(interface_id, 4) + n(ticks >> 32, 4) + n(ticks & 0xFFFFFFFF, 4) + n(data.size(), 4) +
                 n(data.size() + more, 4) + padded(data) + options);
  }
};

std::vector<Kept> read(InputFormat format, const std::string& file,
                       std::vector<Interface>* interfaces = nullptr) {
  const auto reader = make_reader(format);
  std::vector<Kept> got = read_all(*reader, view(file));
  if (interfaces != nullptr) *interfaces = reader->interfaces();
  std::mt19937 random(4);
  for (std::size_t piece_max : {1u, 11u, 1000u}) {
    const auto again = make_reader(format);
    EXPECT_EQ(read_split(*again, view(file), random, piece_max), got);
  }
  return got;
}

const std::string kAckFrame = from_hex("43 01 be 48");
const std::string kRadioAck = from_hex("02 00 01 31 a4");

TEST(WirePcapng, BothOrdersManyInterfacesAndSections) {
  for (bool big : {false, true}) {
    File file{big, {}};
    file.section();
    file.interface(195, file.option(2, "radio") + file.option(1, "on the roof") +
                            file.option(9, "\x09") + file.option(14, file.n(100, 8)) +
                            file.option(0, ""));
    file.interface(147, file.option(2, "serial:1") + file.option(9, std::string(1, '\x8a')));
    file.block(0x0BAD, "skip me.");
    file.packet(0, 5'000'000'001, kRadioAck, file.option(2, file.n(1, 4)));
    file.packet(1, 1536, kAckFrame,
                file.option(1, "hello") + file.option(2, file.n(0x12, 4)) + file.option(0, ""));
    file.block(3, file.n(kRadioAck.size(), 4) + File::padded(kRadioAck));
    file.block(2, file.n(1, 2) + file.n(0, 2) + file.n(0, 4) + file.n(1024, 4) + file.n(4, 4) +
                      file.n(4, 4) + kAckFrame);
    file.block(5, file.n(0, 4) + file.n(0, 8));
    file.big = !big;  // A section of the other order.
    file.section();
    file.interface(148, file.option(2, "sf"));
    file.packet(0, 7, std::string("\0\x11", 2));
    file.interface(1);
    file.packet(1, 8, "ethernet");
    std::vector<Interface> interfaces;
    const std::vector<Kept> got = read(InputFormat::kPcapng, file.out, &interfaces);
    ASSERT_EQ(interfaces.size(), 4u);
    EXPECT_EQ(interfaces[0].name, "radio");
    EXPECT_EQ(interfaces[0].comment, "on the roof");
    EXPECT_EQ(interfaces[0].link_type, 195);
    EXPECT_EQ(interfaces[0].ticks_per_second, 1'000'000'000u);
    EXPECT_EQ(interfaces[0].offset_seconds, 100);
    EXPECT_EQ(interfaces[1].ticks_per_second, 1024u);
    EXPECT_EQ(interfaces[2].name, "sf");
    EXPECT_EQ(interfaces[2].ticks_per_second, 1'000'000u);
    ASSERT_EQ(got.size(), 6u);
    EXPECT_EQ(got[0].packet.framing, Framing::kRadio);
    EXPECT_EQ(got[0].packet.time_ns, 105'000'000'001);
    EXPECT_EQ(got[0].packet.direction, Direction::kInbound);
    EXPECT_EQ(got[0].packet.fcs, 0xa431);
    EXPECT_EQ(got[0].packet.error, kSound);
    EXPECT_EQ(file.out.substr(got[0].packet.offset_bytes, 5), kRadioAck);
    EXPECT_EQ(got[1].packet.framing, Framing::kHdlc);
    EXPECT_EQ(got[1].packet.time_ns, 1'500'000'000);
    EXPECT_EQ(got[1].packet.direction, Direction::kOutbound);
    EXPECT_EQ(got[1].packet.serial_seq, 1);
    EXPECT_EQ(got[1].packet.interface_id, 1u);
    EXPECT_EQ(got[1].comment, "hello");
    EXPECT_EQ(got[2].packet.time_ns, kNoTime);
    EXPECT_EQ(got[2].packet.fcs, 0xa431);
    EXPECT_EQ(got[3].packet.time_ns, 1'000'000'000);
    EXPECT_EQ(got[3].packet.kind, 0x43);
    EXPECT_EQ(got[4].packet.framing, Framing::kSf);
    EXPECT_EQ(got[4].packet.interface_id, 2u);
    EXPECT_EQ(got[4].packet.time_ns, 7000);
    EXPECT_EQ(got[5].packet.framing, Framing::kBare);
    EXPECT_EQ(got[5].bytes, "ethernet");
    EXPECT_EQ(got[5].packet.link_type, 1);
    EXPECT_EQ(got[5].packet.error, (Error{Fault::kUnsupported, 0, "WIRE-PCAPNG"_rule}));
  }
}

TEST(WirePcapng, RecordsCapturedInPart) {
  File file;
  file.section();
  file.interface(147);
  file.interface(195);
  file.packet(0, 0, kAckFrame, {}, 3);
  file.packet(1, 0, kRadioAck, {}, 1);
  const std::vector<Kept> got = read(InputFormat::kPcapng, file.out);
  ASSERT_EQ(got.size(), 2u);
  EXPECT_EQ(got[0].packet.error, (Error{Fault::kCut, 4, ReqId::kNone}));
  EXPECT_EQ(got[0].packet.crc, kAbsent);
  EXPECT_EQ(got[0].packet.dropped_bytes, 3u);
  EXPECT_EQ(to_hex(view(got[0].bytes)), "be48");
  EXPECT_EQ(got[1].packet.error, (Error{Fault::kCut, 5, ReqId::kNone}));
  EXPECT_EQ(got[1].packet.fcs, kAbsent);
}

struct Damage {
  const char* name;
  // Puts something wrong between two good packets.
  void (*put)(File&);
  std::uint32_t offset;   // Of the fault, in bytes.
  std::uint64_t dropped;  // 0: the bad block is delivered whole.
};
const Damage kDamages[] = {
    {"LengthsDisagree",
     [](File& f) {
       f.packet(0, 2, kRadioAck);
       f.out.back() ^= 1;
     },
     36, 28},
    {"LengthNotOfFour", [](File& f) { f.out += f.n(6, 4) + f.n(41, 4) + std::string(32, 'x'); }, 4,
     28},
    {"LengthTooSmall", [](File& f) { f.out += f.n(6, 4) + f.n(8, 4) + std::string(8, 'x'); }, 4, 4},
    {"LengthAbsurd",
     [](File& f) { f.out += f.n(6, 4) + f.n(0xFFFFFFF0, 4) + std::string(101, 'x'); }, 4, 97},
    {"LengthBeyondTheFile",
     [](File& f) { f.out += f.n(6, 4) + f.n(0x100000, 4) + std::string(24, 'x'); }, 4, 20},
    {"WrongByteOrderMagic",
     [](File& f) { f.out += f.n(0x0A0D0D0A, 4) + f.n(28, 4) + std::string(20, 'x'); }, 8, 16},
    {"CapturedMoreThanTheBlock",
     [](File& f) {
       f.packet(0, 2, kRadioAck);
       f.out[f.out.size() - 20] = 9;  // The captured length.
     },
     20, 0},
    {"UnknownInterface", [](File& f) { f.packet(7, 2, kRadioAck); }, 8, 0},
    {"PacketBlockTooShort", [](File& f) { f.block(6, std::string(12, 'x')); }, 4, 0},
    {"InterfaceTooShort", [](File& f) { f.block(1, "abcd"); }, 4, 0},
    {"InterfaceOptionOverruns", [](File& f) { f.interface(147, f.n(2, 2) + f.n(5, 2) + "abcd"); },
     16, 0},
};

TEST(WirePcapng, DamageIsReportedAndTheNextBlockFound) {
  for (const Damage& row : kDamages) {
    File file;
    file.section();
    file.interface(195);
    file.packet(0, 1, kRadioAck);
    const std::size_t begin = file.out.size();
    row.put(file);
    const std::size_t end = file.out.size();
    file.packet(0, 3, kRadioAck);
    const std::vector<Kept> got = read(InputFormat::kPcapng, file.out);
    ASSERT_EQ(got.size(), 3u) << row.name;
    EXPECT_EQ(got[0].packet.error, kSound) << row.name;
    EXPECT_EQ(got[1].packet.offset_bytes, begin) << row.name;
    EXPECT_EQ(got[1].packet.error, (Error{Fault::kContainer, row.offset, "WIRE-PCAPNG"_rule}))
        << row.name << got[1];
    EXPECT_EQ(got[1].packet.dropped_bytes, row.dropped) << row.name;
    EXPECT_EQ(got[1].bytes, file.out.substr(begin, end - begin - row.dropped)) << row.name;
    EXPECT_EQ(got[2].packet.time_ns, 3000) << row.name;
    EXPECT_EQ(got[2].packet.error, kSound) << row.name;
  }
}

TEST(WirePcapng, FilesThatEndOrBeginWrong) {
  File file;
  file.section();
  file.interface(195);
  file.packet(0, 1, kRadioAck);
  const std::size_t last = file.out.size();
  file.packet(0, 2, kRadioAck);
  for (std::size_t size = last + 1; size < file.out.size(); ++size) {
    const std::vector<Kept> got = read(InputFormat::kPcapng, file.out.substr(0, size));
    ASSERT_EQ(got.size(), 2u) << size;
    EXPECT_EQ(got[0].packet.error, kSound);
    EXPECT_EQ(got[1].packet.error,
              (Error{Fault::kCut, static_cast<std::uint32_t>(size - last), "WIRE-PCAPNG"_rule}));
    EXPECT_EQ(got[1].packet.offset_bytes, last);
    EXPECT_EQ(got[1].bytes, file.out.substr(last, size - last));
  }
  EXPECT_EQ(read(InputFormat::kPcapng, "").at(0).packet.error,
            (Error{Fault::kCut, 0, "WIRE-PCAPNG"_rule}));
  // Bytes before a section that are no pcapng at all.
  const std::vector<Kept> got = read(InputFormat::kPcapng, std::string(50, 'x') + file.out);
  ASSERT_EQ(got.size(), 3u);
  EXPECT_EQ(got[0].packet.error, (Error{Fault::kContainer, 0, "WIRE-PCAPNG"_rule}));
  EXPECT_EQ(got[0].packet.dropped_bytes, 38u);
  File other;
  other.section(2);
  other.interface(195);
  other.section();
  other.interface(195);
  other.packet(0, 1, kRadioAck);
  const std::vector<Kept> versions = read(InputFormat::kPcapng, other.out);
  ASSERT_EQ(versions.size(), 2u);
  EXPECT_EQ(versions[0].packet.error, (Error{Fault::kUnsupported, 12, "WIRE-PCAPNG"_rule}));
  EXPECT_EQ(versions[1].packet.error, kSound);
}

// Damage full of bytes that look like blocks, each nearly as long as the search allows.
TEST(WirePcapng, TheSearchIsNotLedAstray) {
  File file;
  file.section();
  file.interface(195);
  file.out += file.n(6, 4) + file.n(13, 4);
  for (int i = 0; i < 100'000; ++i) file.out += file.n(6, 4) + file.n(0x7FFEC, 4);
  file.packet(0, 3, kRadioAck);
  const std::vector<Kept> got = read(InputFormat::kPcapng, file.out);
  ASSERT_EQ(got.size(), 2u);
  EXPECT_EQ(got[0].packet.error, (Error{Fault::kContainer, 4, "WIRE-PCAPNG"_rule}));
  EXPECT_EQ(got[0].packet.dropped_bytes, 8u + 800'000u - 12u);
  EXPECT_EQ(got[1].packet.error, kSound);
}

std::string pcap(const File& f, std::uint32_t magic, unsigned link_type) {
  return f.n(magic, 4) + f.n(2, 2) + f.n(4, 2) + f.n(0, 8) + f.n(65535, 4) + f.n(link_type, 4);
}
std::string record(const File& f, unsigned seconds, unsigned fraction, const std::string& data,
                   std::size_t more = 0) {
  return f.n(seconds, 4) + f.n(fraction, 4) + f.n(data.size(), 4) + f.n(data.size() + more, 4) +
         data;
}

TEST(WirePcap, BothOrdersAndResolutions) {
  for (bool big : {false, true}) {
    for (std::uint32_t magic : {0xA1B2C3D4u, 0xA1B23C4Du}) {
      const File f{big, {}};
      const std::string file =
          pcap(f, magic, 195) + record(f, 3, 5, kRadioAck) + record(f, 4, 0, kRadioAck, 2);
      std::vector<Interface> interfaces;
      const std::vector<Kept> got = read(InputFormat::kPcap, file, &interfaces);
      ASSERT_EQ(got.size(), 2u);
      EXPECT_EQ(got[0].packet.time_ns, 3'000'000'000 + (magic == 0xA1B23C4D ? 5 : 5000));
      EXPECT_EQ(got[0].packet.error, kSound);
      EXPECT_EQ(got[0].packet.offset_bytes, 40u);
      EXPECT_EQ(got[1].packet.error, (Error{Fault::kCut, 5, ReqId::kNone}));
      EXPECT_EQ(got[1].packet.dropped_bytes, 2u);
      EXPECT_EQ(interfaces.at(0).link_type, 195);
    }
  }
}

TEST(WirePcap, Damage) {
  const File f;
  const std::string good = pcap(f, 0xA1B2C3D4, 148) + record(f, 1, 0, "abc");
  std::vector<Kept> got = read(InputFormat::kPcap, good + f.n(0, 8) + f.n(0x40001, 4) + "12345678");
  ASSERT_EQ(got.size(), 2u);
  EXPECT_EQ(got[0].bytes, "abc");
  EXPECT_EQ(got[1].packet.error, (Error{Fault::kContainer, 8, "WIRE-PCAP"_rule}));
  EXPECT_EQ(got[1].packet.offset_bytes, good.size());
  EXPECT_EQ(got[1].packet.dropped_bytes, 4u);
  got = read(InputFormat::kPcap, good + record(f, 2, 0, "abcdef").substr(0, 20));
  ASSERT_EQ(got.size(), 2u);
  EXPECT_EQ(got[1].packet.error, (Error{Fault::kCut, 20, "WIRE-PCAP"_rule}));
  got = read(InputFormat::kPcap, std::string(30, 'x'));
  ASSERT_EQ(got.size(), 1u);
  EXPECT_EQ(got[0].packet.error, (Error{Fault::kContainer, 0, "WIRE-PCAP"_rule}));
  EXPECT_EQ(got[0].packet.dropped_bytes, 6u);
  EXPECT_EQ(read(InputFormat::kPcap, good.substr(0, 10)).at(0).packet.error,
            (Error{Fault::kCut, 10, "WIRE-PCAP"_rule}));
}

// Every capture file of the project, written again, reads the same.
TEST(WirePcapng, WriterIsReadBack) {
  const std::string file = read_file("spec/captures/firmware/b_reliable.pcapng");
  std::vector<Interface> names;
  const std::vector<Kept> first = read(InputFormat::kPcapng, file, &names);
  ASSERT_FALSE(first.empty());
  PcapngWriter writer;
  std::string written;
  writer.begin(written);
  for (const Kept& kept : first) {
    ASSERT_TRUE(writer.write(kept.get(), names[kept.packet.interface_id].name, written));
  }
  writer.finish(written);
  std::vector<Interface> names_again;
  const std::vector<Kept> again = read(InputFormat::kPcapng, written, &names_again);
  ASSERT_EQ(again.size(), first.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    Kept want = first[i];
    want.packet.offset_bytes = again[i].packet.offset_bytes;
    EXPECT_EQ(names_again[again[i].packet.interface_id].name, names[want.packet.interface_id].name);
    want.packet.interface_id = again[i].packet.interface_id;
    EXPECT_EQ(again[i], want);
  }
}

TEST(WirePcap, WriterIsReadBack) {
  Packet packet{.framing = Framing::kHdlc,
                .time_ns = 1'234'567'890,
                .kind = 0x43,
                .serial_seq = 1,
                .crc = 0x48be};
  PcapWriter writer(kLinkSerial);
  std::string file;
  writer.begin(file);
  EXPECT_TRUE(writer.write(packet, file));
  packet.framing = Framing::kRadio;
  EXPECT_FALSE(writer.write(packet, file));
  const std::vector<Kept> got = read(InputFormat::kPcap, file);
  ASSERT_EQ(got.size(), 1u);
  EXPECT_EQ(got[0].packet.time_ns, 1'234'567'890);
  EXPECT_EQ(got[0].packet.serial_seq, 1);
  EXPECT_EQ(got[0].packet.error, kSound);
}

}  // namespace
}  // namespace rubric
