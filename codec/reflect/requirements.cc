#include "codec/reflect/requirements.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <iterator>
#include <utility>

#include "codec/generated/requirements_table.h"

namespace rubric::reflect {
namespace {

constexpr std::size_t kCount = std::size(kRequirements);
constexpr std::size_t kSlots = std::bit_ceil(2 * kCount);

struct Slot {
  ReqId number = ReqId::kNone;
  std::size_t index = 0;
};

/// A hash table: a rule is in the slot of its number or in one of the next ones.
constexpr std::array<Slot, kSlots> kTable = [] {
  std::array<Slot, kSlots> out{};
  for (std::size_t i = 1; i < kCount; ++i) {
    const ReqId number = kRequirements[i].number();
    std::size_t at = static_cast<std::size_t>(number) % kSlots;
    while (out[at].number != ReqId::kNone) at = (at + 1) % kSlots;
    out[at] = {number, i};
  }
  return out;
}();

std::vector<Requirement>& others() {
  static std::vector<Requirement> rules;
  return rules;
}

}  // namespace

std::span<const Requirement> requirements() {
  if (!others().empty()) return others();
  return kRequirements;
}

void use_requirements(std::vector<Requirement> rules) { others() = std::move(rules); }

std::size_t requirement_index(ReqId id) {
  if (!others().empty()) {
    const auto found = std::find_if(others().begin(), others().end(),
                                    [&](const Requirement& one) { return one.number() == id; });
    return found == others().end() ? 0 : static_cast<std::size_t>(found - others().begin());
  }
  std::size_t at = static_cast<std::size_t>(id) % kSlots;
  while (kTable[at].number != id && kTable[at].number != ReqId::kNone) at = (at + 1) % kSlots;
  return kTable[at].index;
}

const Requirement& requirement(ReqId id) { return requirements()[requirement_index(id)]; }

ReqId find_requirement(std::string_view id) {
  const auto upper = [](char c) { return std::toupper(static_cast<unsigned char>(c)); };
  const auto same = [&](char a, char b) { return upper(a) == upper(b); };
  for (const Requirement& one : requirements()) {
    const std::string_view known = one.id;
    if (std::equal(id.begin(), id.end(), known.begin(), known.end(), same)) return one.number();
  }
  return ReqId::kNone;
}

}  // namespace rubric::reflect
