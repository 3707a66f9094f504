// A run that is followed finds what `rubric check` finds of the whole, in memory that does not
// grow.
#include "conformance/check/judge/follow.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "codec/containers/reader.h"
#include "codec/reflect/requirements.h"
#include "conformance/check/observation.h"
#include "conformance/check/tests/frames_testing.h"
#include "conformance/check/tests/lawful_testing.h"
#include "conformance/selftest/lawful_traffic/generate.h"
#include "conformance/selftest/lawful_traffic/variants.h"
#include "conformance/simulate/recorder.h"
#include "conformance/simulate/scenarios.h"
#include "conformance/simulate/simulation.h"

namespace rubric::check {
namespace {

constexpr std::int64_t kSecondUs = 1'000'000;
constexpr std::size_t kJudgeEvery = 40;  // Frames.

// A finding without its text: rule, severity, node, frames, count.
using Name =
    std::tuple<std::string, Severity, std::string, std::uint64_t, std::uint64_t, std::uint32_t>;

Name name_of(const Finding& finding) {
  return {reflect::requirement(finding.requirement).id,
          finding.severity,
          finding.node,
          finding.place.frame,
          finding.last.frame,
          finding.count};
}

std::string text_of(const Name& name) {
  const auto& [rule, severity, node, frame, last, count] = name;
  return rule + " of " + node + ", severity " + std::to_string(static_cast<int>(severity)) +
         ", frame " + std::to_string(frame) + " to " + std::to_string(last) + ", " +
         std::to_string(count) + " times";
}

// A capture, of which some frames are spoilt.
template <class Take>
void each_packet(const std::string& capture, double spoilt, std::uint64_t seed, const Take& take) {
  const std::unique_ptr<Reader> reader = make_reader(InputFormat::kPcapng);
  std::mt19937_64 random(seed);
  std::vector<std::uint8_t> bytes;
  auto one = [&](const Packet& packet) {
    Packet sent = packet;
    bytes.assign(packet.bytes.begin(), packet.bytes.end());
    const bool spoil = static_cast<double>(random() % 10'000) < spoilt * 10'000;
    // Behind the headers of the link, so that it stays a frame of its sender.
    constexpr std::size_t kHeader = 12;
    if (spoil && bytes.size() > kHeader) {
      bytes[kHeader + random() % (bytes.size() - kHeader)] ^= static_cast<std::uint8_t>(random());
      sent.fcs = kAbsent;
      sent.crc = kAbsent;
    }
    sent.bytes = Bytes(bytes.data(), bytes.size());
    take(sent, reader->interfaces()[packet.interface_id].name);
  };
  reader->feed(Bytes(reinterpret_cast<const std::uint8_t*>(capture.data()), capture.size()),
               PacketSink(one));
  reader->finish(PacketSink(one));
}

struct Sum {
  std::uint64_t runs = 0;
  std::uint64_t frames = 0;
  std::uint64_t findings = 0;  // Of the whole runs.
  std::uint64_t fails = 0;
  std::uint64_t equal = 0;
  std::uint64_t missing = 0;  // Not found, or found as something else.
  std::uint64_t missing_fails = 0;
  std::uint64_t other = 0;  // Found in the followed run alone.
  std::uint64_t false_fails = 0;
  std::uint64_t let_go = 0;
};

void compare(const std::string& what, const std::string& capture, double spoilt, std::uint64_t seed,
             const Options& options, std::int64_t horizon, Sum& sum) {
  RunReader reader;
  reader.open(what);
  Follow follow({}, options, horizon);
  follow.open(what);
  std::size_t fed = 0;
  each_packet(capture, spoilt, seed, [&](const Packet& packet, std::string_view name) {
    reader.take(0, packet, name);
    follow.take(0, packet, name);
    if (++fed % kJudgeEvery != 0) return;
    ASSERT_TRUE(follow.judge()) << follow.why();
  });
  const Run whole = reader.finish();
  const Report expected = judge(whole, options);
  ASSERT_TRUE(follow.judge()) << follow.why();
  const Report& found = follow.report();
  EXPECT_EQ(found.frames, expected.frames) << what;
  ++sum.runs;
  sum.frames += expected.frames;
  sum.let_go += follow.run().past.frames;
  std::map<Name, int> names;
  for (const Finding& finding : expected.findings) ++names[name_of(finding)];
  std::map<Name, int> others;
  for (const Finding& finding : found.findings) {
    const Name name = name_of(finding);
    if (names[name] > 0) {
      --names[name];
      ++sum.equal;
      continue;
    }
    ++sum.other;
    ++others[name];
    if (finding.severity == Severity::kFail) ++sum.false_fails;
    if (std::getenv("RUBRIC_VERBOSE") != nullptr) {
      std::printf("  %s: only followed: %s: %s\n", what.c_str(), text_of(name).c_str(),
                  finding.text.c_str());
    }
  }
  for (const Finding& finding : expected.findings) {
    ++sum.findings;
    sum.fails += finding.severity == Severity::kFail ? 1 : 0;
  }
  for (const auto& [name, count] : names) {
    sum.missing += static_cast<std::uint64_t>(count);
    const bool fails = std::get<Severity>(name) == Severity::kFail;
    if (fails) sum.missing_fails += static_cast<std::uint64_t>(count);
    if (count > 0 && std::getenv("RUBRIC_VERBOSE") != nullptr) {
      std::printf("  %s: only whole: %s\n", what.c_str(), text_of(name).c_str());
    }
  }
}

void print(const char* what, const Sum& sum) {
  std::printf(
      "%s: %llu runs of %llu frames, of which %llu were let go; %llu findings (%llu failures), "
      "%llu equal, %llu missing (%llu failures), %llu others, %llu failures among these\n",
      what, static_cast<unsigned long long>(sum.runs), static_cast<unsigned long long>(sum.frames),
      static_cast<unsigned long long>(sum.let_go), static_cast<unsigned long long>(sum.findings),
      static_cast<unsigned long long>(sum.fails), static_cast<unsigned long long>(sum.equal),
      static_cast<unsigned long long>(sum.missing),
      static_cast<unsigned long long>(sum.missing_fails),
      static_cast<unsigned long long>(sum.other), static_cast<unsigned long long>(sum.false_fails));
}

std::string simulated(const simulate::ScenarioOptions& how, std::int64_t length_us) {
  simulate::Network network = simulate::make_network(*simulate::find_scenario("free"), how);
  simulate::CaptureRecorder capture(network);
  simulate::Simulation simulation(std::move(network), {&capture});
  simulation.run_until(length_us);
  return capture.finish();
}

TEST(Follow, SimulatedRuns) {
  Sum honest;
  Sum spoilt;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const simulate::ScenarioOptions how{seed, 0.1 * static_cast<double>(seed % 3), 0.1,
                                        2 + seed % 4, 1 + seed % 2};
    const std::string capture = simulated(how, 120 * kSecondUs);
    for (const bool complete : {false, true}) {
      Options options{.sniffer_complete = complete, .start_cold = complete};
      const std::string what = "free " + std::to_string(seed) + (complete ? " complete" : "");
      compare(what, capture, 0, seed, options, 10 * kSecondUs, honest);
      compare(what + " spoilt", capture, 0.02, seed, options, 10 * kSecondUs, spoilt);
    }
  }
  print("honest", honest);
  print("spoilt", spoilt);
  EXPECT_EQ(honest.false_fails, 0U);
  EXPECT_EQ(spoilt.false_fails, 0U);
  EXPECT_GT(honest.let_go * 2, honest.frames);
  EXPECT_GT(spoilt.fails, 100U);
  // Whose DSNs begin elsewhere has rebooted, if all of its frames are there; of a followed run they
  // are not, so who goes on sending without a join is an unknown sender there (J11-SEND).
  EXPECT_GE(spoilt.equal * 100, spoilt.findings * 94);
  EXPECT_LE(spoilt.missing_fails * 13, spoilt.fails);
}

TEST(Follow, LawfulTraffic) {
  Sum sum;
  for (const lawful::Variant& variant : lawful::variants()) {
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
      const lawful::Traffic traffic = lawful::generate(std::string(variant.name), seed);
      compare(traffic.variant, lawful::to_pcapng(traffic), 0, seed, options_of_whole(traffic),
              2 * kSecondUs, sum);
    }
  }
  print("lawful", sum);
  EXPECT_EQ(sum.false_fails, 0U);
  EXPECT_GT(sum.let_go, 1000U);
}

// Shows what a network does to a followed run, as it does it.
class Live final : public simulate::Recorder {
 public:
  explicit Live(Follow& follow) : follow_(follow) {}

  void on_air(simulate::Micros time_us, std::size_t, Bytes frame) override {
    Packet packet{.framing = Framing::kRadio, .bytes = frame};
    take(time_us, packet, "radio", 0);
  }
  void on_serial(simulate::Micros time_us, std::size_t line, bool to_sink,
                 const simulate::SerialFrame& frame) override {
    Packet packet{.framing = Framing::kHdlc,
                  .direction = to_sink ? Direction::kInbound : Direction::kOutbound,
                  .kind = frame.kind,
                  .serial_seq = frame.seq};
    packet.bytes = frame.packet;
    take(time_us, packet, line == 0 ? "serial:1" : "serial:101", 1 + line);
  }

  std::uint64_t frames = 0;
  std::size_t most = 0;  // Held.

 private:
  void take(simulate::Micros time_us, Packet& packet, std::string_view name, std::size_t number) {
    packet.time_ns = time_us * 1000;
    packet.interface_id = static_cast<std::uint32_t>(number);
    follow_.take(0, packet, name);
    ++frames;
    most = std::max(most, follow_.held());
  }

  Follow& follow_;
};

// Half an hour, and in the long proofs a sixth of a week. RUBRIC_HOURS=168 is the week, which takes
// some 15 minutes.
TEST(Follow, TimeAndMemoryDoNotGrow) {
  constexpr int kParts = 10;
  const char* const asked = std::getenv("RUBRIC_HOURS");
  const std::int64_t length_us =
      static_cast<std::int64_t>((asked == nullptr ? 0.5 : std::strtod(asked, nullptr)) * 3600e6);
  const Options options;
  Follow follow({}, options, horizon_us(options));
  follow.open("long");
  Live live(follow);
  simulate::Simulation simulation(
      simulate::make_network(*simulate::find_scenario("free"), {3, 0.02, 0, 32, 2}), {&live});
  std::vector<double> us_a_frame;
  std::vector<std::size_t> held;
  for (int part = 1; part <= kParts; ++part) {
    const std::clock_t begin = std::clock();
    const std::uint64_t before = live.frames;
    live.most = 0;
    simulation.run_until(length_us / kParts * part);
    const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    us_a_frame.push_back(1e6 * seconds / static_cast<double>(live.frames - before));
    held.push_back(live.most);
  }
  ASSERT_TRUE(follow.judge());
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const double frames_a_second =
      static_cast<double>(live.frames) * 1e6 / static_cast<double>(length_us);
  std::printf(
      "%.1f hours, %llu frames, %.0f a second of the run; simulated and judged in %.2f us a frame "
      "in "
      "part 5 and %.2f in the last; %zu frames held then, %zu at the end; %zu findings, %zu facts; "
      "at "
      "most %.1f MB\n",
      static_cast<double>(length_us) / 3600e6, static_cast<unsigned long long>(live.frames),
      frames_a_second, us_a_frame[4], us_a_frame.back(), held[4], held.back(),
      follow.report().findings.size(), follow.report().facts.size(),
      static_cast<double>(usage.ru_maxrss) / 1024);
  EXPECT_GT(frames_a_second, 100);
  EXPECT_LT(held.back(), held[4] + held[4] / 4);
  EXPECT_LT(us_a_frame.back(), 2 * us_a_frame[4] + 1);
  EXPECT_LT(usage.ru_maxrss / 1024, 256);
  for (const Finding& finding : follow.report().findings) {
    EXPECT_NE(finding.severity, Severity::kFail) << finding.text;
  }
}

}  // namespace
}  // namespace rubric::check
