#include "codec/text/packed.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace rubric::text {
namespace {

Bytes view(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::string packed(Packing packing, const std::string& text) {
  const auto packer = make_packer(packing);
  std::string out;
  for (std::size_t at = 0; at < text.size(); at += 1000) packer->pack(text.substr(at, 1000), out);
  packer->finish(out);
  return out;
}

// Neither all the same nor random, and larger than every buffer.
std::string long_text() {
  std::string text;
  for (int i = 0; i < 40'000; ++i) text += std::to_string(i * i) + ' ';
  return text;
}

constexpr Packing kBoth[] = {Packing::kGzip, Packing::kZstd};

TEST(Packed, ReadsBackInPiecesOfAnySize) {
  const std::string text = long_text();
  for (const Packing packing : kBoth) {
    const std::string file = packed(packing, text);
    EXPECT_LT(file.size(), text.size() / 2);
    EXPECT_EQ(packing_of(view(file)), packing);
    for (const std::size_t piece : {1u, 3u, 777u, 1u << 20}) {
      const auto unpacker = make_unpacker(packing);
      std::string got;
      std::uint8_t buffer[1009];
      for (std::size_t at = 0; at < file.size(); at += piece) {
        Bytes rest = view(file).from(at);
        rest = rest.first(std::min(piece, rest.size()));
        while (const std::size_t size = unpacker->unpack(rest, {buffer, sizeof buffer})) {
          got.append(reinterpret_cast<const char*>(buffer), size);
        }
        EXPECT_TRUE(rest.empty());
      }
      EXPECT_EQ(got, text) << piece;
      EXPECT_TRUE(unpacker->may_end());
    }
  }
}

TEST(Packed, JoinedFilesAreOne) {
  for (const Packing packing : kBoth) {
    EXPECT_EQ(unpacked(packing, packed(packing, "one ") + packed(packing, "two")), "one two");
    EXPECT_EQ(unpacked(packing, packed(packing, "") + packed(packing, "two")), "two");
  }
}

TEST(Packed, DamageAndCutsAreSaid) {
  const std::string text = long_text();
  for (const Packing packing : kBoth) {
    const std::string file = packed(packing, text);
    for (const std::size_t size : {5u, 100u}) {
      EXPECT_THROW(unpacked(packing, file.substr(0, size)), PackedDamage);
    }
    EXPECT_THROW(unpacked(packing, file.substr(0, file.size() - 1)), PackedDamage);
    std::string damaged = file;
    damaged[file.size() / 2] = static_cast<char>(damaged[file.size() / 2] ^ 0x55);
    EXPECT_THROW(unpacked(packing, damaged), PackedDamage);
  }
}

TEST(Packed, WhatComesBeforeADamageIsUnpacked) {
  const std::string text = long_text();
  for (const Packing packing : kBoth) {
    std::string file = packed(packing, text);
    file.back() = static_cast<char>(file.back() ^ 0x55);  // Of the checksum, or the length.
    const auto unpacker = make_unpacker(packing);
    std::string got;
    std::vector<std::uint8_t> buffer(text.size());
    Bytes rest = view(file);
    const auto all = [&] {
      while (const std::size_t size = unpacker->unpack(rest, {buffer.data(), buffer.size()})) {
        got.append(reinterpret_cast<const char*>(buffer.data()), size);
      }
    };
    EXPECT_THROW(all(), PackedDamage);
    constexpr std::size_t kLost = 64 * 1024;  // At most, by zstd.
    EXPECT_GE(got.size(), text.size() - (packing == Packing::kZstd ? kLost : 0));
    EXPECT_TRUE(text.starts_with(got));
  }
}

TEST(Packed, Names) {
  EXPECT_EQ(packing_of_name("a.pcap.gz"), Packing::kGzip);
  EXPECT_EQ(packing_of_name("a.pcapng.zst"), Packing::kZstd);
  EXPECT_EQ(packing_of_name("a.pcap"), Packing::kNone);
  EXPECT_EQ(packing_of_name(".gz"), Packing::kNone);
  EXPECT_EQ(name_unpacked("a.pcap.gz"), "a.pcap");
  EXPECT_EQ(name_unpacked("a.pcap"), "a.pcap");
}

}  // namespace
}  // namespace rubric::text
