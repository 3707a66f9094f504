#include "tools/commands/explain/explain_rule.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <iterator>
#include <utility>

#include "codec/reflect/fault_text.h"
#include "tools/commands/explain/table.h"
#include "tools/commands/explain/type_text.h"

namespace rubric::explain {
namespace {

using reflect::Requirement;

template <class Visit>
void each_rule(Visit visit) {
  for (const Requirement& rule : reflect::requirements().subspan(1)) {
    visit(rule.number(), std::string_view(rule.id));
  }
}

std::string roles_text(const Requirement& rule) {
  std::vector<std::string_view> roles;
  if (rule.roles & reflect::kRoleMote) roles.emplace_back("mote");
  if (rule.roles & reflect::kRoleSink) roles.emplace_back("sink");
  if (rule.roles & reflect::kRoleBaseStation) roles.emplace_back("base station");
  return fmt::format("{}", fmt::join(roles, ", "));
}

std::string cases_text(ReqId id, std::string_view title, bool negative, CaseList list,
                       std::span<const cases::CaseUse> uses) {
  constexpr std::size_t kFew = 4;
  std::vector<std::string> names;
  for (const cases::CaseUse& use : uses) {
    if (use.requirement != id || use.negative != negative) continue;
    names.push_back(fmt::format("{}{}({})", use.name, kFirmBlank, use.file));
  }
  if (names.empty()) return "";
  if (list == CaseList::kShort && names.size() > kFew + 1) {
    const std::size_t more = names.size() - kFew;
    names.resize(kFew);
    std::string others = fmt::format("{} more: ", more);
    for (const char c : fmt::format("rubric explain {} --cases", reflect::requirement(id).id)) {
      others += c == ' ' ? kFirmBlank : c;  // To be copied from one line.
    }
    names.push_back(std::move(others));
  }
  return wrapped(fmt::format("{}: {}", title, fmt::join(names, ", ")), 4);
}

// The parts of the project by the beginnings of their paths; a place is in the last that fits.
constexpr std::pair<std::string_view, const char*> kParts[] = {
    {"spec/requirements.yaml", "sentence"},
    {"spec/wire/", "wire spec"},
    {"codec/", "codec"},
    {"conformance/machine/", "machine"},
    {"conformance/machine/flaws/", "flaws"},
    {"conformance/check/", "checker"},
};

std::string places_text(const Requirement& rule, std::span<const RulePlace> places) {
  std::vector<std::string_view> found[std::size(kParts)];
  for (const RulePlace& place : places) {
    if (place.rule != rule.id) continue;
    const auto part = std::find_if(std::rbegin(kParts), std::rend(kParts), [&](const auto& each) {
      return place.place.starts_with(each.first);
    });
    found[std::rend(kParts) - part - 1].push_back(place.place);
  }
  std::string out;
  for (std::size_t i = 0; i < std::size(kParts); ++i) {
    if (found[i].empty()) continue;
    out += wrapped(fmt::format("{}: {}", kParts[i].second, fmt::join(found[i], ", ")), 4);
  }
  if (out.empty()) return "";
  const bool of_behaviour = rule.roles != 0;
  if (of_behaviour && found[std::size(kParts) - 1].empty()) {
    const std::string_view instead = reported_instead(rule.id);
    out +=
        instead.empty()
            ? "    checker: nowhere, nor among the rules that conformance/check/README.md excuses\n"
            : wrapped(fmt::format("checker: never by this name; in its place: {}", instead), 4);
  }
  return "  In the code:\n" + out;
}

}  // namespace

std::vector<ReqId> rules_named(std::string_view name) {
  const ReqId one = reflect::find_requirement(name);
  if (one != ReqId::kNone) return {one};
  std::string prefix(name);
  prefix += '-';
  std::vector<ReqId> out;
  each_rule([&](ReqId id, std::string_view known) {
    const bool same = known.size() > prefix.size() &&
                      std::equal(prefix.begin(), prefix.end(), known.begin(), [](char a, char b) {
                        return std::toupper(static_cast<unsigned char>(a)) == b;
                      });
    if (same) out.push_back(id);
  });
  return out;
}

std::vector<std::string> rule_groups() {
  std::vector<std::string> out;
  each_rule([&](ReqId, std::string_view known) {
    std::string group(known.substr(0, known.find('-')));
    if (std::find(out.begin(), out.end(), group) == out.end()) out.push_back(std::move(group));
  });
  return out;
}

std::string explain_rule(const std::vector<const reflect::Protocol*>& protocols, ReqId id,
                         CaseList list, std::span<const cases::CaseUse> uses,
                         std::span<const RulePlace> places,
                         std::span<const machine::NamedProfile> profiles) {
  const Requirement& rule = reflect::requirement(id);
  std::string out = fmt::format("{}: {}, {}\n", rule.id, rule.level, rule.clause);
  out += wrapped(rule.sentence, 2);
  if (rule.roles != 0) {
    out += fmt::format("  For: {}{}\n", roles_text(rule),
                       rule.forbids ? "; it says what must not happen" : "");
  }
  out += wrapped(fmt::format("Source: {}", rule.source), 2);
  if (*rule.deployed != '\0') {
    out += wrapped(fmt::format("Otherwise in release 1.0: {}", rule.deployed), 2);
  }
  for (const machine::NamedProfile& profile : profiles) {
    for (const machine::AcceptedDifference& one : profile.accepted) {
      if (one.requirement != id) continue;
      out += wrapped(fmt::format("Accepted by --profile {}: {}", profile.name, one.sentence), 2);
    }
  }
  out += used_by(protocols, [id](const reflect::Field& f) { return f.requirement == id; });
  out += places_text(rule, places);
  const std::string cases =
      cases_text(id, "positive", false, list, uses) + cases_text(id, "negative", true, list, uses);
  if (!cases.empty()) return out + "  Cases:\n" + cases;
  return rule.roles == 0 ? out : out + "  Cases: none\n";  // Rules of the wire have vectors.
}

}  // namespace rubric::explain
