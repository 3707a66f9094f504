// Random input of every kind: nothing crashes, and the splits of the input do not matter.
#include <gtest/gtest.h>

#include "codec/containers/test/testing.h"

namespace rubric {
namespace {

using testing::Kept;
using testing::read_all;
using testing::read_file;
using testing::read_split;
using testing::view;

const InputFormat kFormats[] = {InputFormat::kHdlc, InputFormat::kSf, InputFormat::kPcap,
                                InputFormat::kPcapng, InputFormat::kHex};

void check(InputFormat format, const std::string& input, std::mt19937& random,
           std::size_t* packets) {
  const auto whole = make_reader(format);
  const std::vector<Kept> got = read_all(*whole, view(input));
  for (std::size_t piece_max : {3u, 64u, 4096u}) {
    const auto split = make_reader(format);
    ASSERT_EQ(read_split(*split, view(input), random, piece_max), got);
  }
  detect(view(input));
  // Whatever was read can be offered to every writer.
  HdlcWriter hdlc;
  SfWriter sf;
  PcapngWriter pcapng;
  HexWriter hex(false);
  Writer* const writers[] = {&hdlc, &sf, &pcapng, &hex};
  for (Writer* writer : writers) {
    std::string out;
    writer->begin(out);
    for (const Kept& kept : got) {
      const std::size_t size = out.size();
      const bool written = writer->write(kept.get(), out);
      ASSERT_EQ(written, out.size() > size);
    }
    writer->finish(out);
  }
  *packets += got.size();
}

TEST(Garbage, RandomBytes) {
  std::mt19937 random(77);
  for (InputFormat format : kFormats) {
    std::size_t packets = 0;
    for (int round = 0; round < 200; ++round) {
      std::string input(random() % 3000, '\0');
      const unsigned range = round % 3 == 0 ? 256 : 1 + static_cast<unsigned>(random() % 256);
      for (char& c : input) c = static_cast<char>(random() % range);
      check(format, input, random, &packets);
    }
    std::cout << "format " << static_cast<int>(format) << ": " << packets << " packets\n";
  }
}

// Good files with some bytes changed, dropped or doubled get further than noise does.
TEST(Garbage, DamagedFiles) {
  const std::pair<InputFormat, const char*> kInputs[] = {
      {InputFormat::kHdlc, "spec/captures/firmware/h10_hdlc_escape_and_bad_serial.serial.bin"},
      {InputFormat::kSf, "spec/captures/basestation/s04_acks.from_sink.sfstream"},
      {InputFormat::kPcapng, "spec/captures/firmware/h4_stale_bytes.pcapng"},
      {InputFormat::kPcapng, "spec/captures/firmware/d1_lose_request.pcapng"},
  };
  std::mt19937 random(78);
  for (const auto& [format, path] : kInputs) {
    const std::string good = read_file(path);
    ASSERT_FALSE(good.empty());
    std::size_t packets = 0;
    for (int round = 0; round < 200; ++round) {
      std::string input = good;
      for (unsigned i = 0, n = static_cast<unsigned>(1 + random() % 6); i < n; ++i) {
        const std::size_t at = random() % input.size();
        switch (random() % 4) {
          case 0: input.erase(at, 1 + random() % 9); break;
          case 1: input.insert(at, input.substr(random() % input.size(), random() % 9)); break;
          default: input[at] = static_cast<char>(random()); break;
        }
        if (input.empty()) input = good;
      }
      check(format, input, random, &packets);
    }
    std::cout << path << ": " << packets << " packets\n";
  }
}

// A pcapng file damaged in one block loses that block alone.
TEST(Garbage, PcapngFindsItsWayBack) {
  const std::string good = read_file("spec/captures/firmware/b_reliable.pcapng");
  const auto count = [](const std::string& input) {
    const auto reader = make_reader(InputFormat::kPcapng);
    std::size_t sound = 0;
    for (const Kept& kept : read_all(*reader, view(input))) {
      sound += kept.packet.error.fault == Fault::kNone;
    }
    return sound;
  };
  const std::size_t all = count(good);
  std::mt19937 random(79);
  for (int round = 0; round < 300; ++round) {
    std::string input = good;
    // After section header and interfaces, which all later blocks need.
    const std::size_t at = 0x80 + random() % (input.size() - 0x80);
    if (round % 2 == 0) {
      input[at] = static_cast<char>(input[at] ^ 1 << random() % 8);
    } else {
      input.erase(at, 1 + random() % 3);
    }
    EXPECT_GE(count(input), all - 2) << at;
  }
}

}  // namespace
}  // namespace rubric
