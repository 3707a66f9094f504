// Captures as sniffers and taps make them: that begin late or end early, with stamps that scatter,
// with frames that came damaged or are another network's. Of none of these anybody is blamed.
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <random>
#include <string>

#include "conformance/check/tests/failures.h"
#include "conformance/check/tests/recorded.h"

namespace rubric::check {
namespace {

constexpr const char* kScenarios[] = {"timeline", "home", "open_door", "two_sinks", "hospital"};

Options complete() {
  Options options;
  options.sniffer_complete = options.start_cold = true;
  return options;
}

int in_one_file(Packet&) { return 0; }

bool is_radio(const Packet& packet) { return packet.framing == Framing::kRadio; }

TEST(LawfulCaptures, ATapBeginsLateOrEndsEarly) {
  for (const char* scenario : kScenarios) {
    const Recorded run = recorded(scenario);
    std::int64_t begin_ns = 0;
    std::int64_t end_ns = 0;
    read_apart(run.capture, 1,
               [&](Packet& packet) {
                 if (begin_ns == 0) begin_ns = packet.time_ns;
                 end_ns = packet.time_ns;
                 return 0;
               },
               {});
    for (const int tenth : {1, 3, 5, 7, 9}) {
      const std::int64_t cut_ns = begin_ns + (end_ns - begin_ns) / 10 * tenth;
      for (const bool late : {false, true}) {
        for (const bool of_radio : {false, true}) {
          const auto files = [&](Packet& packet) {
            if (is_radio(packet) == of_radio && (packet.time_ns < cut_ns) == late) return -1;
            return is_radio(packet) ? 0 : 1;
          };
          EXPECT_EQ(broken_in(judge(read_apart(run.capture, 2, files, {}), {})), "")
              << scenario << " " << tenth << " " << late << " " << of_radio;
          EXPECT_EQ(broken_in(judge(read_apart(run.capture, 2, files, {run.log}), {})), "")
              << scenario << " " << tenth << " " << late << " " << of_radio << ", with a log";
        }
      }
    }
  }
}

TEST(LawfulCaptures, StampsScatter) {
  for (const char* scenario : {"timeline", "home", "open_door", "inter_island", "two_sinks"}) {
    const Recorded run = recorded(scenario);
    for (const std::int64_t most_us : {1000, 10'000, 20'000}) {
      for (const std::uint32_t seed : {1U, 2U, 3U}) {
        std::minstd_rand random(seed);
        const auto late = [&](Packet& packet) {
          packet.time_ns += static_cast<std::int64_t>(random()) % most_us * 1000;
          return 0;
        };
        EXPECT_EQ(broken_in(judge(read_apart(run.capture, 1, late, {}), complete())), "")
            << scenario << " " << most_us << " " << seed;
      }
    }
  }
}

// A sniffer hears noise; what it hears damaged, nodes may have heard well.
TEST(LawfulCaptures, FramesComeDamaged) {
  for (const char* scenario : kScenarios) {
    const Recorded run = recorded(scenario);
    for (const int part : {5, 11}) {
      int frames = 0;
      const auto damaged = [&](Packet& packet) {
        if (is_radio(packet) && ++frames % part == 0) packet.fcs ^= 1;
        return 0;
      };
      EXPECT_EQ(broken_in(judge(read_apart(run.capture, 1, damaged, {}), complete())), "")
          << scenario << " " << part;
    }
  }
}

// Every fifth frame again, by a node of a network with another PAN, which shares the air.
TEST(LawfulCaptures, AnotherNetworkIsInTheAir) {
  for (const char* scenario : kScenarios) {
    const Recorded run = recorded(scenario);
    const std::unique_ptr<Reader> packets = make_reader(InputFormat::kPcapng, {});
    RunReader reader;
    const std::uint32_t file = reader.open("capture");
    int frames = 0;
    auto take = [&](const Packet& packet) {
      reader.take(file, packet, packets->interfaces()[packet.interface_id].name);
      constexpr std::size_t kPanOffset = 3;
      if (!is_radio(packet) || packet.bytes.size() < 12 || ++frames % 5 != 0) return;
      std::string bytes(reinterpret_cast<const char*>(packet.bytes.data()), packet.bytes.size());
      bytes[kPanOffset] = '\x33';
      Packet other = packet;
      other.bytes = Bytes(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
      other.fcs = kAbsent;
      other.time_ns += 1000;
      reader.take(file, other, packets->interfaces()[packet.interface_id].name);
    };
    packets->feed(
        Bytes(reinterpret_cast<const std::uint8_t*>(run.capture.data()), run.capture.size()),
        PacketSink(take));
    packets->finish(PacketSink(take));
    const Report report = judge(reader.finish(), complete());
    const Report alone = judge(read_apart(run.capture, 1, in_one_file, {}), complete());
    EXPECT_EQ(broken_in(report), "") << scenario;
    EXPECT_EQ(report.verdict, alone.verdict) << scenario;
    bool said = false;
    for (const std::string& fact : report.facts) {
      said = said || fact.find("PAN 0x0033") != fact.npos;
    }
    EXPECT_TRUE(said) << scenario;
  }
}

TEST(LawfulCaptures, ALengthThatIsNotThatOfThePacketIsFound) {
  const Recorded run = recorded("timeline");
  std::string changed;
  int packets = 0;
  const auto shortened = [&](Packet& packet) {
    constexpr std::size_t kLengthOffset = 5;  // Of the header of a serial packet (TEP 113).
    if (is_radio(packet) || ++packets != 7) return 0;
    changed.assign(reinterpret_cast<const char*>(packet.bytes.data()), packet.bytes.size());
    changed[kLengthOffset] = static_cast<char>(changed[kLengthOffset] - 1);
    packet.bytes = Bytes(reinterpret_cast<const std::uint8_t*>(changed.data()), changed.size());
    return 0;
  };
  EXPECT_EQ(broken_in(judge(read_apart(run.capture, 1, shortened, {}), complete())),
            "WIRE-AM-LENGTH");
  EXPECT_EQ(broken_in(judge(read_apart(run.capture, 1, in_one_file, {}), complete())), "");
}

}  // namespace
}  // namespace rubric::check
