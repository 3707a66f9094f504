// The catalogue of rules: names and texts. Code names a rule by "J4-SEQ"_rule without any of this,
// so that only requirements.cc is compiled again when the catalogue changes.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "codec/reflect/schema.h"

namespace rubric::reflect {

/// All rules, in the order of spec/requirements.yaml; the first entry stands for none.
std::span<const Requirement> requirements();
/// Sets the rules of another protocol in their place, the first for none; before there are threads.
void use_requirements(std::vector<Requirement> rules);
/// The texts of a rule. All are empty for kNone and for a number that no rule has.
const Requirement& requirement(ReqId id);
/// The rule's place in requirements(); 0 for kNone and for a number that no rule has.
std::size_t requirement_index(ReqId id);
/// Looks up a rule by its name ("WIRE-NET-NBYTES") in any case; kNone if there is none.
ReqId find_requirement(std::string_view id);

/// Orders rules as the catalogue lists them, kNone first.
struct CatalogueOrder {
  bool operator()(ReqId a, ReqId b) const { return requirement_index(a) < requirement_index(b); }
};

}  // namespace rubric::reflect
