#include "fuzz/mutators/packet_mutator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "codec/containers/tests/testing.h"
#include "codec/generated/rubicon/messages.h"
#include "codec/reflect/registry.h"

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed);

namespace rubric::fuzz {
namespace {

using testing::read_file;
using testing::view;

constexpr std::size_t kRoom = 4096;
constexpr std::size_t kMutants = 1500;

const reflect::Protocol& rubicon() { return *reflect::find_protocol("rubicon"); }

PacketMutator mutator(std::uint64_t seed) {
  return PacketMutator(rubicon(), rubicon::messages::kRoutes, seed);
}

struct Input {
  const char* name;
  InputFormat format;
  const char* path;
};
constexpr Input kInputs[] = {
    {"hdlc", InputFormat::kHdlc, "spec/captures/firmware/e1_simultaneous_join.serial.bin"},
    {"sf", InputFormat::kSf, "spec/captures/basestation/s02_serial_joined.from_sink.sfstream"},
    {"pcap", InputFormat::kPcap, "fuzz/corpora/pcap/d1_lose_request_radio.pcap"},
    {"pcapng", InputFormat::kPcapng, "spec/captures/firmware/f_synaptic.pcapng"},
    {"hex", InputFormat::kHex, "fuzz/corpora/hex/s03_reliable_no_ack.hex"},
};

Bytes bytes_of(const std::vector<std::uint8_t>& bytes) { return {bytes.data(), bytes.size()}; }

/// Packets, those whose framing is sound, and those that decode to a message besides.
struct Count {
  std::size_t packets = 0;
  std::size_t sound = 0;
  std::size_t messages = 0;
  std::set<std::string> names;

  void add(const PacketStream& stream) {
    const reflect::FrameDecoder decoder(rubicon());
    reflect::Frame frame;
    for (const StreamPacket& packet : stream.packets) {
      const Packet bytes = packet.view();
      decoder.decode(bytes, frame);
      ++packets;
      sound += bytes.error.fault == Fault::kNone;
      messages += !frame.malformed() && frame.decoded.message() != nullptr;
      for (std::size_t i = 0; !frame.malformed() && i < frame.decoded.path_count(); ++i) {
        names.insert(frame.decoded.path()[i]->name);
      }
    }
  }
};

TEST(PacketMutator, MutantsOfValidStreamsMostlyParse) {
  PacketMutator one = mutator(1);
  for (const Input& input : kInputs) {
    const std::string good = read_file(input.path);
    ASSERT_FALSE(good.empty()) << input.path;
    Count count;
    for (std::size_t i = 0; i < kMutants; ++i) {
      const auto mutant = one.mutate(input.format, view(good), kRoom);
      count.add(read_stream(input.format, bytes_of(mutant)));
    }
    const auto share = [&](std::size_t part) {
      return static_cast<double>(part) / static_cast<double>(count.packets);
    };
    std::cout << input.name << ": " << count.packets << " packets, framing sound "
              << share(count.sound) << ", a message " << share(count.messages) << "\n";
    EXPECT_GT(share(count.sound), 0.85) << input.name;
    EXPECT_GT(share(count.messages), 0.75) << input.name;
    EXPECT_LT(share(count.messages), 0.99) << input.name;  // Some are to be broken.
  }
}

TEST(PacketMutator, TheSeedDecides) {
  for (const Input& input : kInputs) {
    const std::string good = read_file(input.path);
    std::set<std::string> different;
    PacketMutator again = mutator(0);
    for (std::size_t seed = 1; seed <= 50; ++seed) {
      const auto mutant = mutator(seed).mutate(input.format, view(good), kRoom);
      again.reseed(seed);
      EXPECT_EQ(again.mutate(input.format, view(good), kRoom), mutant) << input.name;
      different.emplace(mutant.begin(), mutant.end());
    }
    EXPECT_GT(different.size(), 40U) << input.name;
  }
}

TEST(PacketMutator, KeepsToTheRoom) {
  PacketMutator one = mutator(1);
  for (const Input& input : kInputs) {
    const std::string good = read_file(input.path);
    for (const std::size_t room : {0U, 1U, 2U, 9U, 40U, 150U, 600U}) {
      for (int i = 0; i < 100; ++i) {
        EXPECT_LE(one.mutate(input.format, view(good), room).size(), room) << input.name;
        const auto both = one.cross_over(input.format, view(good), view(good), room);
        EXPECT_LE(both.size(), room) << input.name;
      }
    }
  }
}

TEST(PacketMutator, MakesEveryMessageOfTheTable) {
  std::set<std::string> wanted;
  for (std::size_t i = 0; i < rubicon::messages::kRoutes.count; ++i) {
    wanted.insert(rubicon::messages::kRoutes.routes[i].type->name);
  }
  for (const InputFormat format : {InputFormat::kHdlc, InputFormat::kSf, InputFormat::kPcapng}) {
    Count count;
    PacketMutator one = mutator(1);
    for (int i = 0; i < 3000; ++i) {
      count.add(read_stream(format, bytes_of(one.mutate(format, Bytes(), 1000))));
    }
    for (const std::string& name : wanted) {
      EXPECT_EQ(count.names.count(name), 1U) << name << ", format " << static_cast<int>(format);
    }
  }
}

// Even where only the sums would show it.
TEST(PacketMutator, ChangedPacketsHaveTheirCheckSums) {
  const std::string good = read_file("spec/captures/firmware/f_synaptic.pcapng");
  std::size_t changed = 0;
  std::size_t matching = 0;
  PacketMutator one = mutator(1);
  for (std::size_t i = 0; i < 1000; ++i) {
    PacketStream stream = read_stream(InputFormat::kPcapng, view(good));
    const std::size_t at = i % stream.packets.size();
    const StreamPacket before = stream.packets[at];
    one.change_packet(stream, at);
    if (stream.packets[at].bytes == before.bytes) continue;
    ++changed;
    const auto written = write_stream(stream);
    const PacketStream again = read_stream(InputFormat::kPcapng, bytes_of(written));
    const Fault fault = again.packets.at(at).packet.error.fault;
    matching += fault != Fault::kCrc && fault != Fault::kFcs;
  }
  EXPECT_GT(changed, 700U);
  EXPECT_GT(matching, changed * 88 / 100);
  EXPECT_LT(matching, changed);  // Rarely they are left wrong.
}

TEST(PacketMutator, AnswersRepeatWhatWasAsked) {
  constexpr std::string_view kRequest = "00 ffff 0002 06 22 0e c4f5 01 2043 01";
  StreamPacket request;
  const std::string bytes = testing::from_hex(kRequest);
  request.bytes.assign(bytes.begin(), bytes.end());
  request.packet.framing = Framing::kSf;
  std::size_t replies = 0;
  std::size_t repeated = 0;
  PacketMutator one = mutator(1);
  for (int i = 0; i < 20'000; ++i) {
    PacketStream stream{.format = InputFormat::kSf, .packets = {request}};
    one.change(stream);
    if (stream.packets.size() < 2 || stream.packets[1].bytes.size() != 18) continue;
    const std::vector<std::uint8_t>& reply = stream.packets[1].bytes;
    if (reply[7] != 15) continue;
    ++replies;
    repeated += reply[16] == 0xC4 && reply[17] == 0xF5;
  }
  EXPECT_GT(replies, 50U);
  EXPECT_GT(repeated, replies / 5);
}

TEST(PacketStream, LengthsFollowTheRoute) {
  StreamPacket packet;
  // A net_msg of ten bytes of payload, whose header and nbytes disagree.
  const std::string bytes = testing::from_hex(
      "00 ffff 0000 ff 00 1c 000b fffd 000b 0002 00 b0d3 99 03 0a 24 0001 0040 1234 56");
  packet.bytes.assign(bytes.begin(), bytes.end());
  packet.packet.framing = Framing::kSf;
  repair_lengths(packet, rubicon::messages::kRoutes);
  EXPECT_EQ(packet.bytes[5], packet.bytes.size() - 8);
  EXPECT_EQ(packet.bytes[19], packet.bytes.size() - 20);
}

TEST(PacketStream, WhatIsNotChangedStays) {
  for (const Input& input : kInputs) {
    const std::string good = read_file(input.path);
    const PacketStream stream = read_stream(input.format, view(good));
    const PacketStream again = read_stream(input.format, bytes_of(write_stream(stream)));
    ASSERT_EQ(again.packets.size(), stream.packets.size()) << input.name;
    for (std::size_t i = 0; i < stream.packets.size(); ++i) {
      EXPECT_EQ(again.packets[i].bytes, stream.packets[i].bytes) << input.name << " " << i;
      EXPECT_EQ(again.packets[i].packet.error, stream.packets[i].packet.error) << input.name;
    }
  }
}

TEST(DecodeEntry, KeepsTheHeadAndTheRoom) {
  const std::string good = read_file("fuzz/corpora/decode/d1_lose_request.hdlc");
  std::size_t kept = 0;
  for (unsigned seed = 1; seed <= 300; ++seed) {
    std::vector<std::uint8_t> data(good.begin(), good.end());
    data.resize(500);
    const std::size_t size = LLVMFuzzerCustomMutator(data.data(), good.size(), data.size(), seed);
    ASSERT_LE(size, data.size());
    kept += std::equal(data.begin(), data.begin() + 2, view(good).begin());
    std::uint8_t tiny[3] = {0, 0, 0};
    EXPECT_LE(LLVMFuzzerCustomMutator(tiny, seed % 2, 1 + seed % 3, seed), 1 + seed % 3);
  }
  EXPECT_GT(kept, 250U);
}

}  // namespace
}  // namespace rubric::fuzz
