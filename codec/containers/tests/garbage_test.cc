// Random input of every kind: nothing crashes, and the splits of the input do not matter.
#include <gtest/gtest.h>

#include "codec/containers/tests/testing.h"

namespace rubric {
namespace {

using namespace testing;

const InputFormat kFormats[] = {InputFormat::kHdlc,   InputFormat::kSf,  InputFormat::kPcap,
                                InputFormat::kPcapng, InputFormat::kHex, InputFormat::kLog};

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

// Checks a good input with some bytes changed, dropped or doubled, which gets further than noise.
void check_damaged(InputFormat format, const std::string& good, std::mt19937& random) {
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
  std::cout << "format " << static_cast<int>(format) << ": " << packets << " packets\n";
}

TEST(Garbage, DamagedFiles) {
  const std::pair<InputFormat, const char*> kInputs[] = {
      {InputFormat::kHdlc, "spec/captures/firmware/h10_hdlc_escape_and_bad_serial.serial.bin"},
      {InputFormat::kSf, "spec/captures/basestation/s04_acks.from_sink.sfstream"},
      {InputFormat::kPcapng, "spec/captures/firmware/h4_stale_bytes.pcapng"},
      {InputFormat::kPcapng, "spec/captures/firmware/d1_lose_request.pcapng"},
  };
  std::mt19937 random(78);
  for (const auto& [format, path] : kInputs) check_damaged(format, read_file(path), random);
}

TEST(Garbage, DamagedLogs) {
  constexpr const char* kLog =
      "booted\n"
      "received: 4188012200020001003f04010252b1 power: -44 lqi: 220 time: 1500000\n"
      "psdu: 4188022200020001003f040102 power: -90 lqi: 7 time: 2500000\n"
      "1000\t1\t2,3\t13: 0x41880322 00020001 003f0401 02\n"
      "00 FF FF 00 00 04 22 06 00 02 00 01\n"
      "7E 45 00 FF FF 00 00 04 22 06 00 02 00 01 5B 02 7E\n";
  std::mt19937 random(80);
  check_damaged(InputFormat::kLog, kLog, random);
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
