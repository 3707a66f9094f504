#include "conformance/test/runner/blame.h"

#include <algorithm>
#include <span>
#include <string_view>

#include "conformance/generated/blame.h"

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

void mark_implied(std::vector<Failure>& failures) {
  std::set<std::string, std::less<>> failed;  // Nodes.
  for (Failure& failure : failures) {
    failure.implied = failed.contains(failure.node);
    if (!failure.weak) failed.insert(failure.node);
  }
}

}  // namespace rubric::runner
