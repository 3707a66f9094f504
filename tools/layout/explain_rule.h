// What `rubric explain` prints about rules.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "codec/reflect/schema.h"
#include "conformance/generated/cases.h"
#include "conformance/generated/profiles.h"

namespace rubric::layout {

/// The rules that `name` stands for, in the catalogue's order, upper and lower case alike: the one
/// of that id, else the group of those whose ids begin with it and a dash ("J4": J4-ACK, ...).
std::vector<ReqId> rules_named(std::string_view name);

/// "J4", "WIRE": what ids begin with up to their first dash, each once.
std::vector<std::string> rule_groups();

/// How many of the cases that name a rule are printed.
enum class CaseList : std::uint8_t { kShort, kWhole };

/// A rule with its roles and source, what release 1.0 and the profiles have otherwise, the fields
/// that refer to it in `protocols`, and the golden cases that name it: of many the first ones, and
/// how to see the others.
std::string explain_rule(const std::vector<const reflect::Protocol*>& protocols, ReqId id,
                         CaseList list = CaseList::kShort,
                         std::span<const cases::CaseUse> uses = cases::kCaseUses,
                         std::span<const machine::NamedProfile> profiles = machine::kProfiles);

}  // namespace rubric::layout
