// Turns a variant's name into traffic.
#include "conformance/selftest/lawful_traffic/generate.h"

#include <algorithm>
#include <stdexcept>

#include "conformance/selftest/lawful_traffic/world.h"

namespace rubric::lawful {
namespace {

constexpr std::size_t kMixedMin = 2;
constexpr std::size_t kMixedMax = 5;

std::uint64_t hash(std::string_view text) {
  std::uint64_t out = 14695981039346656037u;  // FNV-1a.
  for (const char c : text) out = (out ^ static_cast<std::uint8_t>(c)) * 1099511628211u;
  return out;
}

std::vector<const Variant*> choose_mixed(Random& random) {
  std::vector<const Variant*> possible;
  for (const Variant& variant : variants()) {
    if (variant.mixes) possible.push_back(&variant);
  }
  std::vector<const Variant*> chosen;
  const std::size_t count = kMixedMin + random.below(kMixedMax - kMixedMin + 1);
  while (chosen.size() < count) {
    const std::size_t at = random.below(possible.size());
    chosen.push_back(possible[at]);
    possible.erase(possible.begin() + static_cast<std::ptrdiff_t>(at));
  }
  return chosen;
}

}  // namespace

Traffic generate(std::string_view variant, std::uint64_t seed) {
  Random random(seed ^ hash(variant));
  std::vector<const Variant*> chosen;
  if (variant == "mixed") {
    chosen = choose_mixed(random);
  } else if (const Variant* one = find_variant(variant)) {
    chosen.push_back(one);
  } else {
    throw std::invalid_argument("no legal variant is named " + std::string(variant));
  }
  Plan plan = common_plan(random);
  for (const Variant* part : chosen) part->configure(plan, random);
  // With nbytes 102 the paper's form of an ack would be unrecognizable.
  if (plan.traits.ack_form != AckForm::kDeployed) plan.traits.serial_true_nbytes = true;
  Traffic traffic = World(std::move(plan), random.next()).run();
  traffic.variant = variant;
  traffic.seed = seed;
  for (const Variant* part : chosen) {
    traffic.variants.emplace_back(part->name);
    traffic.decisions.insert(traffic.decisions.end(), part->decisions.begin(),
                             part->decisions.end());
    traffic.worst = std::max(traffic.worst, part->worst);
    traffic.stated += part->stated;
  }
  std::sort(traffic.decisions.begin(), traffic.decisions.end());
  traffic.decisions.erase(std::unique(traffic.decisions.begin(), traffic.decisions.end()),
                          traffic.decisions.end());
  return traffic;
}

}  // namespace rubric::lawful
