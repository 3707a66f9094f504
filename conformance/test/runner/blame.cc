#include "conformance/test/runner/blame.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <span>
#include <string_view>
#include <utility>

#include "codec/reflect/requirements.h"
#include "conformance/generated/blame.h"
#include "conformance/test/runner/node_log.h"

namespace rubric::runner {
namespace {

// Returns whether each of the words, between blanks, is part of the evidence.
bool shows_all(const Evidence& evidence, std::string_view words) {
  while (!words.empty()) {
    const std::size_t end = std::min(words.find(' '), words.size());
    if (!evidence.contains(words.substr(0, end))) return false;
    words.remove_prefix(std::min(end + 1, words.size()));
  }
  return true;
}

enum Fit { kNo, kPerhaps, kWell };

Fit fit(std::string_view rule, const Evidence& evidence) {
  if (evidence.contains("missing")) {
    const bool of_content = std::find(std::begin(blame::kOfContent), std::end(blame::kOfContent),
                                      rule) != std::end(blame::kOfContent);
    const bool well = std::ranges::any_of(blame::kShows, [&](const blame::Sign& sign) {
      return sign.rule == rule && std::string_view(sign.words).starts_with("missing") &&
             shows_all(evidence, sign.words);
    });
    if (well) return kWell;
    return of_content ? kNo : kPerhaps;
  }
  const bool differs = evidence.contains("differs");
  bool known = false;
  for (const blame::Sign& sign : differs ? std::span<const blame::Sign>(blame::kDiffers)
                                         : std::span<const blame::Sign>(blame::kShows)) {
    if (sign.rule != rule) continue;
    known = true;
    if (shows_all(evidence, sign.words)) return kWell;
  }
  return known ? kNo : kPerhaps;
}

// Returns whether the rule is about messages of others, whose acks are theirs.
bool passes_on(const std::string& rule) {
  return rule == "T2-CONTENT" || rule.starts_with("N6-") || rule.starts_with("N7-") ||
         rule.starts_with("N8-");
}

}  // namespace

void blame_one(Failure& failure, const Evidence& evidence) {
  std::vector<std::string>& rules = failure.requirements;
  const bool other_ack =
      evidence.contains("differs") && evidence.contains("ack") && !evidence.contains("order");
  if (other_ack && !rules.empty() && std::ranges::none_of(rules, passes_on)) {
    rules.emplace_back("T2-CONTENT");
  }
  if (rules.size() < 2) return;
  const auto blamed = std::max_element(
      rules.begin(), rules.end(),
      [&](const auto& a, const auto& b) { return fit(a, evidence) < fit(b, evidence); });
  std::rotate(rules.begin(), blamed, blamed + 1);
  failure.suspected.assign(rules.begin() + 1, rules.end());
  rules.resize(1);
}

bool shows(std::string_view rule, const Evidence& evidence) { return fit(rule, evidence) == kWell; }

void mark_implied(std::vector<Failure>& failures) {
  std::set<std::string, std::less<>> failed;  // Nodes.
  for (Failure& failure : failures) {
    failure.implied = failed.contains(failure.node);
    if (!failure.weak) failed.insert(failure.node);
  }
}

void conclude(CaseResult& result, const std::vector<NodeLog>& nodes, trace::Place place) {
  mark_implied(result.failures);
  if (result.verdict > CaseVerdict::kFail) return;
  for (const NodeLog& node : nodes) {
    for (const Overlong& one : node.overlong()) {
      const reflect::Requirement& rule = reflect::requirement(one.rule);
      Failure failure;
      failure.place = one.line ? one.line->place : place;
      failure.requirements = {rule.id};
      failure.weak = std::string_view(rule.level) == "SHOULD";
      failure.time = failure.from = failure.to = failure.broken_at = one.output->time;
      failure.text =
          fmt::format("at {} it emitted {}, with {} byte{} after the content", failure.time,
                      node.text_of(*one.output), one.excess, one.excess == 1 ? "" : "s");
      failure.forbidden = true;
      failure.node = node.name();
      result.verdict =
          std::max(result.verdict, failure.weak ? CaseVerdict::kWeak : CaseVerdict::kFail);
      result.failures.push_back(std::move(failure));
    }
  }
}

std::vector<std::string> Failure::rules() const {
  std::vector<std::string> all = requirements;
  all.insert(all.end(), suspected.begin(), suspected.end());
  return all;
}

std::string explain(const CaseResult& result, const std::string& file_name) {
  std::string out;
  for (const Failure& failure : result.failures) {
    out += fmt::format("{}:{}: {}: ", file_name, failure.place.line, result.name);
    out += failure.requirements.empty() ? "no rule"
                                        : fmt::format("{}", fmt::join(failure.requirements, " "));
    if (!failure.suspected.empty()) {
      out += fmt::format(", suspected {}", fmt::join(failure.suspected, " "));
    }
    out += failure.weak ? " (weak)\n" : "\n";
    if (!failure.expected.empty()) out += fmt::format("  expected  {}\n", failure.expected);
    out += fmt::format("  but       {}\n", failure.text);
  }
  return out;
}

}  // namespace rubric::runner
