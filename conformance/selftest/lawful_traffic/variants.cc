// The list of variants and their common plans.
#include "conformance/selftest/lawful_traffic/variants.h"

#include <utility>

#include "conformance/selftest/lawful_traffic/air.h"
#include "conformance/selftest/lawful_traffic/world.h"

namespace rubric::lawful {
namespace {

constexpr std::string_view kLater = "It is younger than these variants.";
constexpr WithoutVariant kWithout[] = {
    {124, "No message says that a node leaves; mote_leaves shows a mote that falls silent."},
    {129, "How many channels a node can have is its own affair; no capture shows one refused."},
    {130, kLater},
    {131, kLater},
    {132, kLater},
    {135, "The PCs of this traffic have no channels."},
    {136, "What a connection means to applications is not on the air."},
    {137, "All traffic has the bytes of release 1.0."},
    {138, "It makes no rule."},
    {141, "The sizes of a node are no frames."},
    {142, "What an application makes of its data is not on the air."},
    {150, kLater},
};

void usual(Plan&, Random&) {}

}  // namespace

MotePlan mote_plan(std::uint16_t id, int island, std::int64_t boot_us) {
  return {.id = id, .island = island, .boot_us = boot_us};
}

Plan common_plan(Random& random) {
  Plan plan;
  for (std::uint16_t id = 2; id <= 4; ++id) {
    plan.motes.push_back(mote_plan(id, 0, random.between(100'000, 1'800'000)));
  }
  plan.motes[1].descriptor = {2, 0x00D3, 3};
  return plan;
}

void two_islands(Plan& plan, bool apart, Random& random) {
  plan.islands = {11, 12};
  plan.islands_apart = apart;
  plan.motes.clear();
  for (std::uint16_t id = 2; id <= 5; ++id) {
    plan.motes.push_back(mote_plan(id, id % 2, random.between(100'000, 1'500'000)));
  }
  plan.chats = 16;
}

Loss lose(rubicon::AmType type, std::uint16_t src, std::int64_t until_us) {
  return [type, src, until_us](World& world, const RadioFrame& frame, const Device&) {
    return frame.type == static_cast<std::uint8_t>(type) && frame.src == src &&
           world.now_us() < until_us;
  };
}

std::span<const WithoutVariant> without_variant() { return kWithout; }

const std::vector<Variant>& variants() {
  static const std::vector<Variant> all = [] {
    std::vector<Variant> out{{"usual", "one island, nothing special", {}, usual}};
    for (auto* group : {join_variants, transport_variants, network_variants, synaptic_variants,
                        timing_variants, capture_variants}) {
      for (Variant& variant : group()) out.push_back(std::move(variant));
    }
    return out;
  }();
  return all;
}

const Variant* find_variant(std::string_view name) {
  for (const Variant& variant : variants()) {
    if (variant.name == name) return &variant;
  }
  return nullptr;
}

}  // namespace rubric::lawful
