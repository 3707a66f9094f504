#include "codec/reflect/requirements.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <iterator>

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

}  // namespace

std::span<const Requirement> requirements() { return kRequirements; }

std::size_t requirement_index(ReqId id) {
  std::size_t at = static_cast<std::size_t>(id) % kSlots;
  while (kTable[at].number != id && kTable[at].number != ReqId::kNone) at = (at + 1) % kSlots;
  return kTable[at].index;
}

const Requirement& requirement(ReqId id) { return kRequirements[requirement_index(id)]; }

ReqId find_requirement(std::string_view id) {
  const auto upper = [](char c) { return std::toupper(static_cast<unsigned char>(c)); };
  const auto same = [&](char a, char b) { return upper(a) == upper(b); };
  for (const Requirement& one : kRequirements) {
    const std::string_view known = one.id;
    if (std::equal(id.begin(), id.end(), known.begin(), known.end(), same)) return one.number();
  }
  return ReqId::kNone;
}

}  // namespace rubric::reflect
