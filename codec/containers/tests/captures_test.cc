// Captures of the original firmware and base station, read by every reader that can.
#include "codec/containers/tests/captures.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <iostream>

#include "codec/containers/hdlc_reader.h"
#include "codec/containers/tests/testing.h"

namespace rubric {
namespace {

using nlohmann::json;
using namespace testing;

const char* const kFirmware = "spec/captures/firmware";
const char* const kBaseStation = "spec/captures/basestation";

// Returns the number after ".node" in a file's name, or `otherwise`.
int node_of(const std::string& path, int otherwise) {
  const std::size_t at = path.find(".node");
  return at == std::string::npos ? otherwise : std::stoi(path.substr(at + 5));
}

std::string hdlc_of(const Kept& kept) {
  std::string frame;
  HdlcWriter().write(kept.get(), frame);
  return to_hex(view(frame));
}

TEST(Captures, SerialBytesAreTheFramesListed) {
  std::size_t frames = 0;
  std::size_t streams = 0;
  for (const std::string& path : files(kFirmware, ".bin")) {
    const bool inbound = path.ends_with(".serial_in.bin");
    const std::string stem = path.substr(0, path.find('.'));
    std::vector<json> rows;
    for (const json& row : read_jsonl(stem + ".sf.jsonl")) {
      if (row["dir"] == (inbound ? "serial_in" : "serial_out") && row["node"] == node_of(path, 1)) {
        rows.push_back(row);
      }
    }
    const std::string stream = read_file(path);
    HdlcReader reader;
    const std::vector<Kept> got = read_all(reader, view(stream));
    ASSERT_EQ(got.size(), rows.size()) << path;
    std::string rewritten;
    for (std::size_t i = 0; i < got.size(); ++i) {
      const json& row = rows[i];
      const Packet& p = got[i].packet;
      EXPECT_EQ(hdlc_of(got[i]), row["hdlc"]) << path << ' ' << i;
      EXPECT_EQ(p.kind, row["proto"]);
      EXPECT_EQ(p.error.fault == Fault::kNone, row["crc_ok"].get<bool>());
      const int absent = kAbsent;
      EXPECT_EQ(p.serial_seq, row.value("seqno", row.value("ack_token", absent)));
      EXPECT_EQ(to_hex(view(got[i].bytes)), row.value("sf", ""));
      HdlcWriter().write(got[i].get(), rewritten);
    }
    EXPECT_EQ(rewritten, stream) << path;
    std::mt19937 random(5);
    EXPECT_EQ(read_split(reader, view(stream), random, 64), got) << path;
    frames += got.size();
    ++streams;
  }
  std::cout << streams << " serial streams, " << frames << " frames\n";
  std::size_t listed = 0;
  for (const std::string& path : files(kFirmware, ".sf.jsonl")) listed += read_jsonl(path).size();
  EXPECT_EQ(frames, listed);
  EXPECT_EQ(streams, 17u);
}

TEST(Captures, ForwarderStreamsAreThePacketsListed) {
  std::size_t packets = 0;
  std::size_t streams = 0;
  for (const std::string& path : files(kBaseStation, ".sfstream")) {
    const bool to_sink = path.ends_with(".to_sink.sfstream");
    const std::string stem = path.substr(0, path.find('.'));
    std::vector<std::string> expected;
    for (const json& row : read_jsonl(stem + ".sf.jsonl")) {
      if (row["dir"] == (to_sink ? "to_sink" : "from_sink")) expected.push_back(row["hex"]);
    }
    const std::string stream = read_file(path);
    EXPECT_EQ(detect(view(stream)), InputFormat::kSf) << path;
    const auto reader = make_reader(InputFormat::kSf);
    const std::vector<Kept> got = read_all(*reader, view(stream));
    std::vector<std::string> found;
    SfWriter writer;
    std::string rewritten;
    writer.begin(rewritten);
    for (const Kept& kept : got) {
      // One scenario sends an empty packet on purpose.
      EXPECT_EQ(kept.packet.error.fault, kept.bytes.empty() ? Fault::kEmpty : Fault::kNone);
      found.push_back(to_hex(view(kept.bytes)));
      EXPECT_TRUE(writer.write(kept.get(), rewritten));
    }
    EXPECT_EQ(found, expected) << path;
    EXPECT_EQ(rewritten, stream) << path;
    packets += found.size();
    ++streams;
  }
  std::cout << streams << " forwarder streams, " << packets << " packets\n";
  EXPECT_EQ(streams, 12u);
}

// Returns a capture file's packets as lines that sort and compare.
std::string line(std::int64_t time_us, const std::string& interface, Direction direction,
                 const std::string& bytes) {
  return std::to_string(time_us) + ' ' + interface + ' ' +
         std::to_string(static_cast<int>(direction)) + ' ' + bytes;
}

std::vector<std::string> expected_lines(const std::string& stem) {
  std::vector<std::string> lines;
  for (const json& row : read_jsonl(stem + ".sf.jsonl")) {
    const std::string hdlc = row["hdlc"];
    const auto direction = row["dir"] == "serial_in" ? Direction::kInbound : Direction::kOutbound;
    lines.push_back(
        line(row["t_us"], "serial:" + std::to_string(row["node"].get<int>()), direction, hdlc));
  }
  for (const json& row : read_jsonl(stem + ".radio.jsonl")) {
    if (row["dir"] != "tx" && row["dir"] != "inj") continue;
    char header[32];
    const auto swap = [](int v) { return (v & 0xFF) << 8 | v >> 8; };
    std::snprintf(header, sizeof(header), "%s88%02x%04x%04x%04x3f%02x",
                  row.value("ackreq", 0) == 1 ? "61" : "41", row.value("dsn", 0),
                  swap(row["group"]), swap(row["dst"]), swap(row["src"]),
                  row["am_type"].get<int>());
    lines.push_back(line(row["t_us"], "radio", Direction::kUnknown,
                         header + row["payload"].get<std::string>()));
  }
  std::sort(lines.begin(), lines.end());
  return lines;
}

TEST(Captures, CaptureFilesAreTheFramesListed) {
  std::size_t packets = 0;
  std::size_t acks = 0;
  for (const std::string& path : files(kFirmware, ".pcapng")) {
    const std::string stem = path.substr(0, path.find('.'));
    const std::string file = read_file(path);
    EXPECT_EQ(detect(view(file)), InputFormat::kPcapng);
    const auto reader = make_reader(InputFormat::kPcapng);
    const std::vector<Kept> got = read_all(*reader, view(file));
    std::vector<std::string> lines;
    for (const Kept& kept : got) {
      const Packet& p = kept.packet;
      const std::string& name = reader->interfaces().at(p.interface_id).name;
      ASSERT_EQ(p.time_ns % 1000, 0);
      if (p.framing == Framing::kHdlc) {
        EXPECT_EQ(p.link_type, 147);
        lines.push_back(line(p.time_ns / 1000, name, p.direction, hdlc_of(kept)));
        continue;
      }
      ASSERT_EQ(p.framing, Framing::kRadio);
      EXPECT_EQ(p.error.fault, Fault::kNone) << kept;
      EXPECT_NE(p.fcs, kAbsent);
      if (p.bytes.size() == 3) {  // A link ack; .radio.jsonl lists those at their sender.
        ++acks;
        continue;
      }
      lines.push_back(line(p.time_ns / 1000, name, p.direction, to_hex(view(kept.bytes))));
    }
    std::sort(lines.begin(), lines.end());
    EXPECT_EQ(lines, expected_lines(stem)) << path;
    std::mt19937 random(9);
    EXPECT_EQ(read_split(*reader, view(file), random, 100).size(), got.size());
    packets += got.size();
  }
  std::cout << packets << " captured packets, " << acks << " of them link acks\n";
}

}  // namespace
}  // namespace rubric
