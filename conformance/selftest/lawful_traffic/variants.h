// The lawful variants: each is one honest way to follow the rules, or a lawful event.
#pragma once

#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "conformance/selftest/lawful_traffic/plan.h"
#include "conformance/selftest/lawful_traffic/random.h"
#include "conformance/selftest/lawful_traffic/traffic.h"

namespace rubric::lawful {

struct Variant {
  std::string_view name;
  std::string_view summary;
  std::vector<int> decisions;  ///< Decisions, 101 to 133, that it shows readings of.
  void (*configure)(Plan& plan, Random& random);
  bool mixes = false;  ///< May be part of `mixed`.
  Worst worst = Worst::kPass;
  /// The parameters that the nodes state, as `rubric check --state` takes it; lawful only so.
  std::string_view stated = {};
};

/// Returns all variants, in the order in which they are listed.
const std::vector<Variant>& variants();
const Variant* find_variant(std::string_view name);

/// A decision without a variant, and why.
struct WithoutVariant {
  int decision;
  std::string_view reason;
};
std::span<const WithoutVariant> without_variant();

/// Returns one island, a sink, three motes with readings, some messages in every direction.
Plan common_plan(Random& random);

// Rows of the groups' tables.
using Configure = void (*)(Plan& plan, Random& random);
/// Returns a variant that is never part of `mixed`.
inline Variant alone(std::string_view name, std::string_view summary, std::vector<int> decisions,
                     Configure configure) {
  return {name, summary, std::move(decisions), configure};
}
/// Returns one that may be part of `mixed`.
inline Variant mixing(std::string_view name, std::string_view summary, std::vector<int> decisions,
                      Configure configure) {
  return {name, summary, std::move(decisions), configure, true};
}
/// Returns one that breaks a SHOULD.
inline Variant weak(std::string_view name, std::string_view summary, std::vector<int> decisions,
                    Configure configure) {
  return {name, summary, std::move(decisions), configure, false, Worst::kWeak};
}

std::vector<Variant> join_variants();
std::vector<Variant> transport_variants();
std::vector<Variant> network_variants();
std::vector<Variant> synaptic_variants();
std::vector<Variant> timing_variants();
std::vector<Variant> capture_variants();

// Helpers of several groups.
MotePlan mote_plan(std::uint16_t id, int island, std::int64_t boot_us);
/// Makes islands 11 and 12 with two motes each.
void two_islands(Plan& plan, bool apart, Random& random);
/// Makes every node miss frames of that type from AM address `src` before `until_us`.
Loss lose(rubicon::AmType type, std::uint16_t src, std::int64_t until_us);

}  // namespace rubric::lawful
