// Every packet of the captures, and of captures damaged on purpose, survives the way through JSON
// lines and back byte for byte.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "codec/containers/reader.h"
#include "codec/containers/writer.h"
#include "codec/generated/rubicon/tables.h"
#include "codec/reflect/frame.h"
#include "tools/encode/members.h"
#include "tools/encode/packet_output.h"
#include "tools/encode/record.h"
#include "tools/format/jsonl.h"
#include "tools/tests/made_inputs.h"
#include "tools/tests/readme/number.h"

namespace rubric::encode {
namespace {

using reflect::Value;

const reflect::Protocol& kProtocol = rubicon::tables::kProtocol;
constexpr int kDamagedCopies = 50;  // For each capture.

std::vector<std::string> captures() {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator("spec/captures")) {
    const std::string name = entry.path().string();
    if (name.ends_with(".bin") || name.ends_with(".pcapng") || name.ends_with(".sfstream")) {
      files.push_back(name);
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::string read_file(const std::string& name) {
  std::ifstream in(name, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

Bytes bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

struct Kept {
  Packet packet;
  std::string bytes;
  std::string interface_name;
  std::string line;
};

std::vector<Kept> read_all(const std::string& input, InputFormat format) {
  std::vector<Kept> all;
  const auto reader = make_reader(format);
  const reflect::FrameDecoder decoder(kProtocol);
  reflect::Frame frame;
  format::JsonlFormatter formatter(kProtocol, false);
  format::Buffer buffer;
  auto keep = [&](const Packet& packet) {
    Kept kept{.packet = packet};
    kept.bytes.assign(reinterpret_cast<const char*>(packet.bytes.data()), packet.bytes.size());
    if (packet.interface_id < reader->interfaces().size()) {
      kept.interface_name = reader->interfaces()[packet.interface_id].name;
    }
    decoder.decode(packet, frame);
    format::Record record{
        .interface_name = kept.interface_name, .time_ns = packet.time_ns, .frame = &frame};
    buffer.clear();
    formatter.print(record, buffer);
    kept.line = buffer.view();
    all.push_back(std::move(kept));
  };
  reader->feed(bytes_of(input), keep);
  reader->finish(keep);
  return all;
}

std::string_view container_of(InputFormat format) {
  if (format == InputFormat::kHdlc) return "hdlc";
  return format == InputFormat::kSf ? "sf" : "pcapng";
}

void expect_same(const Kept& kept, const OwnedPacket& owned) {
  const Packet& a = kept.packet;
  const Packet b = owned.view();
  ASSERT_TRUE(equal(bytes_of(kept.bytes), b.bytes)) << kept.line;
  ASSERT_EQ(a.framing, b.framing);
  ASSERT_EQ(a.direction, b.direction);
  ASSERT_EQ(a.time_ns, b.time_ns);
  ASSERT_EQ(a.kind, b.kind) << kept.line;
  ASSERT_EQ(a.serial_seq, b.serial_seq) << kept.line;
  ASSERT_EQ(a.crc, b.crc);
  ASSERT_EQ(a.fcs, b.fcs);
  ASSERT_EQ(a.dropped_bytes, b.dropped_bytes);
  ASSERT_EQ(a.offset_bytes, b.offset_bytes);
  ASSERT_EQ(a.error.fault, b.error.fault);
  ASSERT_EQ(kept.interface_name, owned.interface_name);
}

// Returns whether a frame that is rebuilt from fields alone must be the same: text keeps neither
// which NaN it was, nor opaque payloads.
bool rebuildable(const Value& line) {
  const Value* fields = line.find("fields");
  const Value* error = line.find("error");
  return fields->is(Value::Kind::kObject) && error->is(Value::Kind::kNull);
}

// Returns whether no file can hold the packet: bytes that are none.
bool is_lost(const Packet& packet) {
  return packet.error.requirement == "WIRE-SF-HANDSHAKE"_rule ||
         (packet.error.fault == Fault::kTooLong && packet.dropped_bytes > 0);
}

struct Tally {
  std::size_t packets = 0;
  std::size_t malformed = 0;
  std::size_t rebuilt = 0;
};

void round_trip(const std::string& input, InputFormat format, Tally& tally) {
  const std::vector<Kept> first = read_all(input, format);
  const std::string file = testing::TempDir() + "rubric_round_trip_" + std::to_string(getpid());
  PacketOutput output(container_of(format), file);
  RecordReader reader(kProtocol);
  OwnedPacket owned;
  std::vector<std::string> written_lines;
  for (const Kept& kept : first) {
    ++tally.packets;
    Value line = parse_json(kept.line);
    tally.malformed += line.find("error")->is(Value::Kind::kObject);
    try {
      reader.read(line, owned);
    } catch (const RecordError& error) {
      FAIL() << error.what() << "\n" << kept.line;
    }
    ASSERT_NO_FATAL_FAILURE(expect_same(kept, owned));
    const std::string refused = output.write(owned.view(), owned.interface_name);
    if (refused.empty()) {
      written_lines.push_back(kept.line);
    } else {
      ASSERT_TRUE(is_lost(kept.packet)) << refused << "\n" << kept.line;
    }
    if (!rebuildable(line) || kept.line.find("\"NaN\"") != std::string::npos) continue;
    for (std::size_t i = 0; i < line.keys.size(); ++i) {
      if (line.keys[i] == "raw") line.items[i] = Value{};
    }
    ++tally.rebuilt;
    try {
      reader.read(line, owned);
    } catch (const RecordError& error) {
      FAIL() << error.what() << "\n" << kept.line;
    }
    ASSERT_NO_FATAL_FAILURE(expect_same(kept, owned));
  }
  ASSERT_TRUE(output.finish());
  // The output reads as the same frames; only places differ.
  const std::vector<Kept> second = read_all(read_file(file), format);
  ASSERT_EQ(second.size(), written_lines.size());
  const auto without_offset = [](const std::string& line) {
    const std::size_t from = line.find("\"offset\"");
    return line.substr(0, from) + line.substr(line.find(',', from));
  };
  for (std::size_t i = 0; i < second.size(); ++i) {
    ASSERT_EQ(without_offset(second[i].line), without_offset(written_lines[i]));
  }
}

class RoundTrip : public testing::TestWithParam<std::string> {};

TEST_P(RoundTrip, Capture) {
  const std::string input = read_file(GetParam());
  const InputFormat format = detect(bytes_of(input));
  ASSERT_NE(format, InputFormat::kUnknown);
  Tally tally;
  round_trip(input, format, tally);
  EXPECT_GT(tally.packets, 0u);
  RecordProperty("packets", static_cast<int>(tally.packets));
  RecordProperty("rebuilt", static_cast<int>(tally.rebuilt));
}

std::string damaged(std::string input, std::mt19937& random) {
  const auto pick = [&](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n ? n - 1 : 0)(random);
  };
  const std::size_t changes = 1 + pick(12);
  for (std::size_t i = 0; i < changes && input.size() > 2; ++i) {
    const std::size_t at = pick(input.size());
    switch (pick(6)) {
      case 0: input[at] = static_cast<char>(input[at] ^ (1 << pick(8))); break;
      case 1: input.erase(at, 1 + pick(8)); break;
      case 2: input.insert(at, 1 + pick(4), static_cast<char>(pick(256))); break;
      case 3: input.insert(at, "\x7d\x7e"); break;
      case 4: input[at] = '\x7e'; break;
      default: input.resize(input.size() - pick(std::min<std::size_t>(20, input.size()))); break;
    }
  }
  return input;
}

// Returns damaged frames of an input: a damaged capture file ends at the damage, so there it is the
// frames that are damaged.
std::string damaged_frames(const std::string& input, InputFormat format, std::mt19937& random) {
  PcapngWriter writer;
  std::string output;
  writer.begin(output);
  for (const Kept& kept : read_all(input, format)) {
    const std::string bytes = random() % 2 ? damaged(kept.bytes, random) : kept.bytes;
    Packet packet = kept.packet;
    packet.bytes = bytes_of(bytes);
    packet.comment = {};
    writer.write(packet, kept.interface_name, output);
  }
  writer.finish(output);
  return output;
}

TEST_P(RoundTrip, DamagedCapture) {
  const std::string input = read_file(GetParam());
  const InputFormat format = detect(bytes_of(input));
  ASSERT_NE(format, InputFormat::kUnknown);
  std::mt19937 random(20240607);
  Tally tally;
  for (int i = 0; i < made_inputs(kDamagedCopies); ++i) {
    const std::string bad = format == InputFormat::kPcapng ? damaged_frames(input, format, random)
                                                           : damaged(input, random);
    ASSERT_NO_FATAL_FAILURE(round_trip(bad, format, tally)) << "round " << i;
  }
  EXPECT_TRUE(tally.malformed > 0 || input.size() < 200);
  RecordProperty("packets", static_cast<int>(tally.packets));
  RecordProperty("malformed", static_cast<int>(tally.malformed));
}

TEST(RoundTripCaptures, Count) {
  EXPECT_EQ(captures().size() * kDamagedCopies, readme_number("# damaged copies"));
}

INSTANTIATE_TEST_SUITE_P(Captures, RoundTrip, testing::ValuesIn(captures()), [](const auto& row) {
  std::string name = std::filesystem::path(row.param).filename();
  for (char& c : name) {
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  }
  return name;
});

}  // namespace
}  // namespace rubric::encode
