// Prints rules for `rubric explain`.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "codec/reflect/schema.h"
#include "conformance/generated/cases.h"
#include "conformance/generated/profiles.h"

namespace rubric::explain {

/// Returns the rules of a name, in the catalogue's order, upper and lower case alike: the one of
/// that id, else the group of those whose ids begin with it and a dash ("J4": J4-ACK, ...).
std::vector<ReqId> rules_named(std::string_view name);

/// Returns "J4", "WIRE", and so on: the beginnings of ids up to their first dash, each once.
std::vector<std::string> rule_groups();

/// The number of printed cases of a rule.
enum class CaseList : std::uint8_t { kShort, kWhole };

/// A place in the project where a rule is written down or kept.
struct RulePlace {
  std::string_view rule;   ///< Its id.
  std::string_view place;  ///< "conformance/machine/join.cc:86": the first line with it in a file.
};

/// Returns the places of all rules: those in the catalogue, then the sources by file name.
/// Generated when the program is built.
std::span<const RulePlace> rule_places();

/// Returns what the checker reports in place of a rule that it never names, by the table of
/// conformance/check/README.md; empty of other rules. Generated when the program is built.
std::string_view reported_instead(std::string_view rule);

/// Returns a rule with its roles and source, the differences of release 1.0 and the profiles, the
/// fields that refer to it in `protocols`, the places where it is, and its golden cases: if there
/// are many, the first ones, and how to see the others.
std::string explain_rule(const std::vector<const reflect::Protocol*>& protocols, ReqId id,
                         CaseList list = CaseList::kShort,
                         std::span<const cases::CaseUse> uses = cases::kCaseUses,
                         std::span<const RulePlace> places = rule_places(),
                         std::span<const machine::NamedProfile> profiles = machine::kProfiles);

}  // namespace rubric::explain
