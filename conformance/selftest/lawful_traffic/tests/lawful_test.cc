// The generator: determinism, well-formed output, and the features of each variant.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <tuple>

#include "codec/containers/pcapng_reader.h"
#include "codec/reflect/frame.h"
#include "codec/reflect/registry.h"
#include "conformance/selftest/lawful_traffic/generate.h"
#include "conformance/selftest/lawful_traffic/tests/seen.h"

namespace rubric::lawful {
namespace {

using rubicon::AmType;
using rubicon::Component;

constexpr std::uint64_t kSeeds = 6;
constexpr std::uint64_t kMixedSeeds = 40;
constexpr std::int64_t kReplyUs = 300'000;
constexpr std::int64_t kAckUs = 1'000'000;
constexpr std::int64_t kSentAgainUs = 900'000;

void for_each_traffic(const std::function<void(const Traffic&)>& check) {
  for (const Variant& variant : variants()) {
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      SCOPED_TRACE(std::string(variant.name) + " seed " + std::to_string(seed));
      check(generate(variant.name, seed));
    }
  }
  for (std::uint64_t seed = 1; seed <= kMixedSeeds; ++seed) {
    const Traffic traffic = generate("mixed", seed);
    SCOPED_TRACE("mixed seed " + std::to_string(seed) + " of " +
                 ::testing::PrintToString(traffic.variants));
    check(traffic);
  }
}

TEST(Lawful, SameSeedSameTraffic) {
  for (const char* name : {"usual", "inter_island_true", "mixed", "lossy"}) {
    const Traffic once = generate(name, 7);
    EXPECT_EQ(once.packets, generate(name, 7).packets) << name;
    EXPECT_EQ(to_pcapng(once), to_pcapng(generate(name, 7))) << name;
    EXPECT_NE(once.packets, generate(name, 8).packets) << name;
  }
}

TEST(Lawful, KnownBytes) {
  // The same with every compiler and library. When the generator changes on purpose, copy the
  // number that this prints.
  std::uint64_t sum = 14695981039346656037u;
  const auto add = [&sum](const Traffic& traffic) {
    for (const char c : to_pcapng(traffic)) {
      sum = (sum ^ static_cast<std::uint8_t>(c)) * 1099511628211u;
    }
  };
  for (const Variant& variant : variants()) add(generate(variant.name, 1));
  for (std::uint64_t seed = 1; seed <= 10; ++seed) add(generate("mixed", seed));
  EXPECT_EQ(sum, 14117397480500743833u);
}

TEST(Lawful, UnknownNameIsRefused) {
  EXPECT_THROW(generate("no_such_variant", 1), std::invalid_argument);
}

TEST(Lawful, EachVariantShowsItsFeature) {
  std::set<std::string> checked;
  for (const auto* group : {&join_features(), &transport_features(), &other_features()}) {
    for (const Feature& feature : *group) {
      checked.insert(feature.variant);
      for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
        const Traffic traffic = generate(feature.variant, seed);
        EXPECT_TRUE(feature.shown(traffic, see(traffic))) << feature.variant << " seed " << seed;
      }
    }
  }
  std::set<std::string> all;
  for (const Variant& variant : variants()) all.emplace(variant.name);
  EXPECT_EQ(checked, all);
  EXPECT_GE(all.size(), 26u);
}

TEST(Lawful, FeaturesAreNotInCommonTraffic) {
  // A feature that any traffic shows would prove nothing; those of the defaults are listed.
  const std::set<std::string> common{"usual", "ack_deployed", "seq_random", "serial_whole"};
  // These are about retries or channels, which common traffic may not have at all.
  const auto elsewhere = [](std::string_view name) {
    return name.substr(0, 6) == "timers" || name.substr(0, 7) == "stated_" ||
           name.substr(0, 4) == "syn_" || name == "busy_channel";
  };
  const Traffic traffic = generate("usual", 3);
  const Frames frames = see(traffic);
  for (const auto* group : {&transport_features(), &other_features()}) {
    for (const Feature& feature : *group) {
      if (common.count(feature.variant) != 0 || elsewhere(feature.variant)) continue;
      EXPECT_FALSE(feature.shown(traffic, frames)) << feature.variant;
    }
  }
}

std::string readme() {
  std::ifstream in("conformance/selftest/lawful_traffic/README.md");
  return {std::istreambuf_iterator<char>(in), {}};
}

// Numbers of the decisions about open points of the protocol, 101 and on.
std::set<int> decisions() {
  std::set<int> numbers;
  for (const auto& entry : std::filesystem::directory_iterator("spec/decisions")) {
    const std::string name = entry.path().filename().string();
    if (name.substr(0, 2) == "01") numbers.insert(std::stoi(name.substr(0, 4)));
  }
  return numbers;
}

TEST(Lawful, EveryDecisionHasAVariantOrAReason) {
  std::set<int> covered;
  for (const Variant& variant : variants()) {
    covered.insert(variant.decisions.begin(), variant.decisions.end());
  }
  std::set<int> all = covered;
  for (const WithoutVariant& none : without_variant()) {
    EXPECT_TRUE(all.insert(none.decision).second) << none.decision;
    EXPECT_FALSE(none.reason.empty());
  }
  EXPECT_EQ(all, decisions());
  const std::string sentence = "cover " + std::to_string(covered.size()) + " of the " +
                               std::to_string(decisions().size()) + " decisions";
  EXPECT_THAT(readme(), ::testing::HasSubstr(sentence));
}

TEST(Lawful, NamesAreUnique) {
  std::set<std::string_view> names;
  for (const Variant& variant : variants()) EXPECT_TRUE(names.insert(variant.name).second);
}

TEST(Lawful, EveryFrameParses) {
  const reflect::FrameDecoder decoder(*reflect::find_protocol("rubicon"));
  for_each_traffic([&](const Traffic& traffic) {
    std::size_t packets = 0;
    std::size_t malformed = 0;
    reflect::Frame frame;
    auto reader = make_reader(InputFormat::kPcapng);
    std::int64_t last_ns = 0;
    auto on_packet = [&](const Packet& packet) {
      decoder.decode(packet, frame);
      ++packets;
      if (frame.malformed()) ++malformed;
      EXPECT_GE(packet.time_ns, last_ns);
      last_ns = packet.time_ns;
    };
    const std::string file = to_pcapng(traffic);
    reader->feed(Bytes(reinterpret_cast<const std::uint8_t*>(file.data()), file.size()), on_packet);
    reader->finish(on_packet);
    EXPECT_EQ(packets, traffic.packets.size());
    EXPECT_GT(packets, 0u);
    if (traffic.all_well_formed) {
      EXPECT_EQ(malformed, 0u);
    }
    for (const Interface& interface : reader->interfaces()) {
      EXPECT_EQ(interface.link_type, interface.name == "radio" ? 195 : 147);
    }
  });
}

TEST(Lawful, ChecksTheRulesThatAreEasyToCheck) {
  for_each_traffic([](const Traffic& traffic) {
    std::set<std::uint16_t> testers;
    for (const NodeInfo& node : traffic.nodes) {
      if (node.role == Role::kTester) testers.insert(node.id);
    }
    const bool whole = traffic.cold_start && traffic.sniffer_complete && traffic.has_radio;
    const Frames frames = see(traffic);
    std::set<std::pair<std::uint16_t, std::uint16_t>> offered;  // Mote and number.
    std::set<std::uint16_t> joined;
    std::set<std::uint16_t> asked;  // Numbers of reliable messages.
    for (const Seen& s : frames) {
      if (!s.sum_ok || testers.count(s.am_src) != 0) continue;
      if (s.radio && s.is(AmType::kJoinReply)) offered.insert({s.am_dst, s.join_seq()});
      if (s.is(AmType::kAckJoin)) {
        EXPECT_TRUE(!whole || offered.count({s.am_src, s.join_seq()}) != 0) << s.time_us;
        joined.insert(s.am_src);
      }
      if (!s.net) continue;
      EXPECT_TRUE(s.net->seq != kNoSeq || traffic.variant == "seq_ffff");
      if (s.radio && s.am_src != kSinkAm) {
        EXPECT_TRUE(!whole || joined.count(s.am_src) != 0) << s.time_us;
        EXPECT_EQ(s.net->src.devid, s.am_src);
      }
      if (s.net->reliable) asked.insert(s.net->seq);
      if (s.app(Component::kRubiconAck)) {
        EXPECT_FALSE(s.net->reliable);
        // Between base stations and over PEIS a message may not show on any interface here.
        const bool local = s.net->src.pid == s.net->dest.pid;
        EXPECT_TRUE(!whole || !traffic.has_serial || !local || asked.count(s.acked()) != 0);
      }
    }
  });
}

TEST(Lawful, AnswersComeInTime) {
  for_each_traffic([](const Traffic& traffic) {
    std::map<std::pair<std::uint16_t, std::uint16_t>, std::int64_t> asked;
    std::map<std::tuple<std::uint16_t, std::uint16_t, std::uint16_t>, std::int64_t> sent;
    if (!traffic.sniffer_complete || !traffic.stated.empty()) return;  // Or in its own time.
    for (const Seen& s : see(traffic)) {
      if (!s.sum_ok) continue;
      if (s.is(AmType::kJoin)) asked[{s.am_src, s.join_seq()}] = s.time_us;
      if (s.is(AmType::kJoinReply) && asked.count({s.am_dst, s.join_seq()}) != 0) {
        const std::int64_t after_us = s.time_us - asked[{s.am_dst, s.join_seq()}];
        EXPECT_LE(after_us, kReplyUs) << s.time_us;
      }
      if (!s.net) continue;
      const Address from = s.net->src;
      const Address to = s.net->dest;
      if (s.net->reliable) {
        const auto [first, fresh] = sent.try_emplace({from.pid, from.devid, s.net->seq}, s.time_us);
        if (!fresh && s.time_us - first->second > kSentAgainUs) first->second = s.time_us;
      }
      if (!s.app(Component::kRubiconAck) || traffic.worst == Worst::kWeak) continue;
      const auto found = sent.find({to.pid, to.devid, s.acked()});
      if (found == sent.end()) continue;
      EXPECT_LE(s.time_us - found->second, kAckUs) << s.time_us;
    }
  });
}

TEST(Lawful, TruthNamesTheNodes) {
  const std::string json = to_truth_json(generate("three_islands", 1));
  EXPECT_THAT(json, ::testing::HasSubstr("\"schema\": \"rubric.lawful/1\""));
  EXPECT_THAT(json,
              ::testing::HasSubstr("{\"node\": 101, \"role\": \"sink\", \"id\": 1, \"island\": 12, "
                                   "\"interface\": \"serial:101\"}"));
  EXPECT_THAT(to_truth_json(generate("host_loops_radiated", 1)),
              ::testing::HasSubstr("\"worst\": \"weak\""));
}

}  // namespace
}  // namespace rubric::lawful
