// The framer breaks every rule of the wire that it can. generate_cli_test compares its frames with
// what `rubric decode` says of them.
#include "codec/frame_generator/framer.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <map>
#include <set>
#include <string_view>

#include "codec/frame_generator/known_protocols.h"
#include "codec/frame_generator/routes.h"
#include "codec/reflect/registry.h"
#include "codec/reflect/requirements.h"

namespace rubric::generate {
namespace {

using RuleSet = std::set<ReqId, reflect::CatalogueOrder>;

constexpr int kFramesOfRoute = 200;

constexpr InputFormat kContainers[] = {InputFormat::kHdlc, InputFormat::kSf, InputFormat::kPcapng,
                                       InputFormat::kHex};

std::vector<Framed> frames_of(const Known& known, InputFormat container, std::uint64_t seed) {
  FrameGenerator generator(known.protocol, known.routes, seed);
  Framer framer(container, generator.random());
  std::vector<Framed> all;
  for (int i = 0; i < known.routes.count; ++i) {
    const reflect::Route& route = known.routes.routes[i];
    if (!framer.holds(route)) continue;
    for (int k = 0; k < kFramesOfRoute; ++k) {
      Framed framed;
      if (k % 4 == 3 && framer.broken(generator.valid(route), false, framed)) {
        all.push_back(std::move(framed));
      } else {
        all.push_back(framer.sound(k % 2 ? generator.near_valid(route) : generator.valid(route)));
      }
    }
  }
  const reflect::Route& first = known.routes.routes[0];
  Framed last;
  if (framer.holds(first) && framer.broken(generator.valid(first), true, last)) {
    all.push_back(std::move(last));
  }
  return all;
}

using RuleSet = std::set<ReqId, reflect::CatalogueOrder>;

// The rules of the wire that no generated frame breaks, and why.
constexpr const char* kOfTheStream = "is about the stream or file around the frames";
constexpr const char* kNotCarried = "no carrier holds this message, so no frame leads to it";
const std::map<ReqId, const char*, reflect::CatalogueOrder> kNotBroken = {
    {"WIRE-SF-HANDSHAKE"_rule, kOfTheStream},
    {"WIRE-RADIO-TAP"_rule, "no writer writes TAP headers"},
    {"WIRE-ZEP"_rule, "it is a live source, not a format that is written"},
    {"WIRE-PCAP"_rule, kOfTheStream},
    {"WIRE-PCAPNG"_rule, kOfTheStream},
    {"WIRE-HEX"_rule, kOfTheStream},
    {"WIRE-HDLC-TWO-FLAGS"_rule, "is for writers; readers take one flag"},
    {"WIRE-SERIAL-KIND"_rule, "every byte is a kind, unknown ones are shown"},
    {"WIRE-SERIAL-SEQ"_rule, "a frame that is long enough has the sequence number"},
    {"WIRE-APP-HEADER"_rule, "the least nbytes that is allowed covers TRANSID and APPID"},
    {"WIRE-DATA"_rule, kNotCarried},
    {"WIRE-COMPLETE"_rule, kNotCarried},
    {"WIRE-NET-COMMAND"_rule, kNotCarried},
    {"WIRE-NET-DATA"_rule, kNotCarried},
    {"WIRE-CONNLESS"_rule, kNotCarried},
};

TEST(Routes, EveryProtocolHasThem) {
  for (const reflect::Protocol* protocol : reflect::protocols()) {
    const reflect::RouteTable* routes = routes_of(*protocol);
    ASSERT_NE(routes, nullptr) << protocol->id;
    EXPECT_GT(routes->count, 0) << protocol->id;
  }
}

TEST(Framer, BreaksEveryRuleOfTheWireThatAFrameCanBreak) {
  RuleSet broken;
  for (const Known& known : all_known()) {
    for (const InputFormat container : kContainers) {
      for (std::uint64_t seed = 11; seed <= 16; ++seed) {
        for (const Framed& framed : frames_of(known, container, seed)) {
          if (!framed.valid()) broken.insert(framed.error.requirement);
          if (framed.unfit_message) broken.insert(framed.unfit.requirement);
        }
      }
    }
  }
  long count = 0;
  for (const reflect::Requirement& rule : reflect::requirements()) {
    if (!std::string_view(rule.id).starts_with("WIRE-")) continue;
    const ReqId id = rule.number();
    const auto reason = kNotBroken.find(id);
    ++count;
    if (reason != kNotBroken.end()) {
      std::printf("not broken: %s: %s\n", rule.id, reason->second);
      EXPECT_FALSE(broken.contains(id)) << rule.id << " is broken after all";
    } else {
      EXPECT_TRUE(broken.contains(id)) << rule.id << " is never broken";
    }
  }
  std::printf("%zu of %ld rules of the wire broken\n", broken.size(), count);
}

}  // namespace
}  // namespace rubric::generate
