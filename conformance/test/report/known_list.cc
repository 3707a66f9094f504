#include "conformance/test/report/known_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "codec/reflect/requirements.h"
#include "codec/text/text.h"
#include "conformance/test/report/log_lines.h"
#include "conformance/test/report/words.h"
#include "conformance/test/suite/expected.h"
#include "conformance/trace/schema.h"

namespace rubric::suite {
namespace {

constexpr std::size_t kColumns = 100;

std::string yaml_text(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return out + '"';
}

std::string comment(const std::string& text) {
  std::string out = "\n" + text::wrapped("", text, kColumns - 2, 0);
  out.pop_back();
  for (std::size_t at = 0; (at = out.find('\n', at)) != std::string::npos; at += 3) {
    out.insert(at + 1, "# ");
  }
  return out + '\n';
}

// Returns words of a failure that do not change with its time or with the numbers that a seed
// makes.
std::string message_of(const runner::Failure& failure) {
  constexpr std::string_view kEmitted = "it emitted ";
  if (failure.forbidden) {
    const std::size_t at = failure.text.find(kEmitted);
    if (at != std::string::npos) {
      return failure.text.substr(at, failure.text.find('(', at) - at);
    }
  }
  const std::optional<trace::Line> asked = asked_line(failure);
  if (failure.crash || !asked) return failure.text;
  const std::string node = asked->node + ' ' + std::string(trace::op_text(asked->op));
  if (asked->am) return asked->message.name;
  return fmt::format("{} {} {}", node, asked->link, asked->message.name);
}

// What cases fail by, all listed in one entry.
struct KnownEntry {
  std::string rule;
  std::string message;
  std::string reason;
  std::string target;
  std::string profile;
  auto operator<=>(const KnownEntry&) const = default;
};

std::string limits(const std::string& target, const std::string& profile) {
  std::string out;
  if (!target.empty()) out += "  target: " + yaml_text(target) + '\n';
  if (!profile.empty()) out += "  profile: " + profile + '\n';
  return out;
}

template <class Names>
std::string yaml_list(const Names& names) {
  if (names.size() == 1) return ' ' + *names.begin() + '\n';
  std::string out = "\n";
  for (const std::string& name : names) out += "    - " + name + '\n';
  return out;
}

std::string skip_entry(const std::vector<std::string>& cases, const std::string& reason,
                       const std::string& target) {
  return "- skip:" + yaml_list(cases) + "  reason: " + yaml_text(reason) + '\n' +
         limits(target, "");
}

class KnownList {
 public:
  KnownList(const SuiteRun& run, const report::KnownFailures& known) : run_(run), known_(known) {
    for (const ImplementationRun& implementation : run.implementations) {
      for (const CaseRun& one : implementation.cases) take(implementation, one);
    }
  }

  std::string text() const {
    std::string out =
        "# What is known to fail, and what is not decided. `rubric test --expect` reads this file, "
        "and\n# wants a reason for each entry.\n";
    for (const reflect::Requirement& rule : reflect::requirements()) {
      bool first = true;
      for (const auto& [entry, cases] : failures_) {
        if (entry.rule != rule.id) continue;
        if (std::exchange(first, false)) {
          out += comment(fmt::format("{} ({}): {}", rule.id, rule.level, rule.sentence));
        }
        out += failure_entry(entry, cases);
      }
    }
    bool first = true;
    for (const auto& [entry, cases] : failures_) {
      if (entry.rule != "none") continue;
      if (std::exchange(first, false)) out += comment("No rule");
      out += failure_entry(entry, cases);
    }
    for (const auto& [why, cases] : undecided_) {
      const auto& [said, reason, target] = why;
      out += comment("Not decided: " + said) + skip_entry(cases, reason, target);
    }
    return out;
  }

 private:
  void take(const ImplementationRun& implementation, const CaseRun& one) {
    const std::string target = run_.implementations.size() > 1 ? implementation.target : "";
    const bool lacks = one.owed && !one.result.damaged;  // Run it again.
    if (lacks || (one.undecided() && !one.expected_reason.empty())) {
      std::vector<std::string>& cases =
          undecided_[{what_was_missing(one.result.reason), one.expected_reason, target}];
      if (cases.empty() || cases.back() != one.name) cases.push_back(one.name);
    }
    if (one.result.verdict != runner::CaseVerdict::kFail) return;
    for (const runner::Failure& failure : one.result.failures) {
      const std::optional<std::string> known = reason_of(known_, implementation, one, failure);
      if (failure.weak || (!known && one.expectation == Expectation::kAsExpected)) continue;
      const std::string rule = failure.requirements.empty() ? "none" : failure.requirements.front();
      const std::string profile = one.profile == "paper" ? "" : one.profile;
      failures_[{rule, message_of(failure), known.value_or(""), target, profile}].insert(one.name);
    }
  }

  static std::string failure_entry(const KnownEntry& entry, const std::set<std::string>& cases) {
    return fmt::format("- case:{}  requirement: {}\n  message: {}\n  reason: {}\n{}",
                       yaml_list(cases), entry.rule, yaml_text(entry.message),
                       yaml_text(entry.reason), limits(entry.target, entry.profile));
  }

  const SuiteRun& run_;
  const report::KnownFailures& known_;
  std::map<KnownEntry, std::set<std::string>> failures_;  // The names of the cases.
  std::map<std::tuple<std::string, std::string, std::string>, std::vector<std::string>> undecided_;
};

bool is_given_call(const std::vector<trace::NodeHeader>& nodes, const trace::Line& line) {
  const trace::Shape* shape = trace::Schema::get().find(line.message.name);
  const bool under_test = std::any_of(
      nodes.begin(), nodes.end(),
      [&](const trace::NodeHeader& node) { return node.iut && node.name == line.node; });
  return under_test && line.op == trace::Op::kGiven && shape && shape->app &&
         shape->app->what == trace::AppWhat::kCall && line.message.name != "get_clock";
}

}  // namespace

std::string known_list(const SuiteRun& run, const report::KnownFailures& known) {
  return KnownList(run, known).text();
}

std::string list_to_begin_with(const Cases& cases, machine::Role role) {
  std::map<std::string, std::vector<std::string>> by_call;
  for (const SuiteCase& one : cases.all()) {
    const CaseRun blank = one.blank();
    if (blank.roles != std::vector{role}) continue;
    const trace::Case whole = one.whole();
    const std::vector<const trace::Line*> lines = whole.lines();
    const auto call = std::find_if(lines.begin(), lines.end(), [&](const trace::Line* line) {
      return is_given_call(blank.nodes, *line);
    });
    if (call != lines.end()) by_call[(*call)->message.name].push_back(one.one->name);
  }
  std::string out =
      "# What this adapter cannot do yet. Write it again as you go on, so that it shrinks:\n"
      "# rubric test --target ... --expect known.yaml --write-expect known.yaml\n";
  for (const auto& [call, names] : by_call) {
    const std::string why = fmt::format("The node has no {}() yet.", call);
    out += comment(why) + skip_entry(names, why, "");
  }
  return out;
}

}  // namespace rubric::suite
