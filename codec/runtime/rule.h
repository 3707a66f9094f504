// Names a rule in two bytes: the number of a rule is a hash of its name, so that a new rule changes
// no other rule's number and nothing that names rules is compiled again. Freestanding C++14.
#pragma once

#include <stddef.h>
#include <stdint.h>

namespace rubric {

/// A rule of spec/requirements.yaml; rubricc checks that no two rules have the same number.
/// Its texts are in codec/reflect/requirements.h.
enum class ReqId : uint16_t { kNone = 0 };

/// Numbers have no order that means anything: sort by reflect::requirement_index().
bool operator<(ReqId, ReqId) = delete;

/// The number of the rule with this name: FNV-1a, its upper half folded into the lower one.
constexpr ReqId rule_number(const char* name) {
  uint32_t hash = 2166136261u;
  for (; *name != '\0'; ++name) hash = (hash ^ static_cast<uint8_t>(*name)) * 16777619u;
  return static_cast<ReqId>(static_cast<uint16_t>(hash ^ (hash >> 16)));
}

inline namespace literals {

/// "J4-SEQ"_rule is the number of that rule. tidy_test.py refuses names that no rule has.
#ifdef __cpp_consteval
consteval ReqId operator""_rule(const char* name, size_t) { return rule_number(name); }
#else
// The compilers of motes would hash while the mote runs, were the letters not part of a type.
#pragma GCC diagnostic push
#ifdef __clang__
#pragma GCC diagnostic ignored "-Wgnu-string-literal-operator-template"
#endif
#pragma GCC diagnostic ignored "-Wpedantic"
template <class Char, Char... kName>
constexpr ReqId operator""_rule() {
  constexpr Char kText[] = {kName..., '\0'};
  constexpr ReqId kNumber = rule_number(kText);
  return kNumber;
}
#pragma GCC diagnostic pop
#endif

}  // namespace literals

}  // namespace rubric
