// The reference machine passes every golden trace, each has a name of its own, and each line that
// forbids blames one rule. That their logs hold again is held by html_test.cc.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <sstream>

#include "conformance/generated/blame.h"
#include "conformance/test/runner/blame.h"
#include "conformance/test/runner/case_files.h"
#include "conformance/test/runner/output_index.h"
#include "conformance/test/runner/run_case.h"
#include "conformance/test/runner/subject_target.h"
#include "conformance/trace/headers.h"
#include "conformance/trace/match.h"
#include "conformance/trace/print.h"

namespace rubric::runner {
namespace {

using trace::LinkKind;

constexpr LinkKind kLinks[] = {LinkKind::kRadio, LinkKind::kSerial, LinkKind::kPeis,
                               LinkKind::kApp};

// Returns what an output that the line forbids shows when it has the sign; empty where no output on
// the line's link can have it.
Evidence evidence_of(const blame::Sign& sign, const trace::Line& line, LinkKind link) {
  std::istringstream words(sign.words);
  Evidence out{std::istream_iterator<std::string>(words), {}};
  if (link == LinkKind::kAny) return out;
  for (const LinkKind other : kLinks) {
    if (other != link && out.contains(trace::link_text(other))) return {};
  }
  out.emplace(trace::link_text(link));
  if (line.message.name != "*") out.insert(line.message.name);
  return out;
}

// Returns the rules of the line that no output which it forbids is blamed for.
std::vector<std::string> never_blamed(const trace::Line& line, LinkKind link) {
  std::vector<std::string> out;
  for (const std::string& rule : line.requirements) {
    const bool blamed = std::ranges::any_of(blame::kShows, [&](const blame::Sign& sign) {
      if (sign.rule != rule) return false;
      const Evidence evidence = evidence_of(sign, line, link);
      Failure failure{.requirements = line.requirements};
      blame_one(failure, evidence);
      return !evidence.empty() && failure.requirements.front() == rule;
    });
    if (!blamed) out.push_back(rule);
  }
  return out;
}

TEST(GoldenCases, TheMachinePassesAll) {
  std::set<std::string> names;
  for (const trace::Parsed& file : load_cases("conformance/cases")) {
    for (const trace::Case& one : file.file.cases) {
      EXPECT_TRUE(names.insert(one.name).second) << one.name;
      const CaseResult result = run_case(file.file, one, [](const trace::NodeHeader&) {
        return std::make_unique<SubjectTarget>(std::make_unique<Machine>());
      });
      EXPECT_EQ(result.verdict, CaseVerdict::kPass) << explain(result, file.file_name);
    }
  }
  EXPECT_GT(names.size(), 270U);
  std::printf("%zu golden traces\n", names.size());
}

// Returns the messages of a log's lines.
std::vector<trace::Concrete> messages_of(const trace::Case& log, const trace::Scope& scope) {
  std::vector<trace::Concrete> out;
  for (const trace::Line* line : log.lines()) {
    trace::AmFrame frame;
    if (!line->bytes) {
      out.push_back(trace::concrete(line->message));
    } else if (trace::parse_packet(*line->bytes, frame)) {
      out.push_back(trace::decode(frame, scope.link(line->link).value_or(LinkKind::kRadio)));
    }
  }
  return out;
}

TEST(GoldenCases, AnIndexFindsAllThatALineMatchesAndLittleElse) {
  constexpr std::size_t kMost = 30;  // Of a case; else this takes long.
  std::size_t all = 0;
  std::size_t looked = 0;
  std::size_t matched = 0;
  for (const trace::Parsed& file : load_cases("conformance/cases")) {
    for (const trace::Case& one : file.file.cases) {
      const CaseResult result = run_case(file.file, one, [](const trace::NodeHeader&) {
        return std::make_unique<SubjectTarget>(std::make_unique<Machine>());
      });
      std::vector<trace::Concrete> messages =
          messages_of(result.log.read(), trace::scope_of(file.file, one));
      messages.resize(std::min(messages.size(), kMost));
      OutputIndex index;
      for (std::uint32_t i = 0; i < messages.size(); ++i) index.add(i, messages[i], "rA", false);
      trace::Bindings bindings;
      for (const trace::Line* line : one.lines()) {
        trace::Line at = *line;
        at.link = "rA";
        const OutputIndex::Places places = index.like(at, bindings);
        const std::set<std::uint32_t> found(places.begin(), places.end());
        all += messages.size();
        looked += found.size();
        const trace::Bindings before = bindings;
        for (std::uint32_t i = 0; i < messages.size(); ++i) {
          if (!trace::may_match(at.message, messages[i].name)) continue;
          if (!trace::compare(at, messages[i], before)) continue;
          ++matched;
          EXPECT_TRUE(found.contains(i)) << one.name << ": " << trace::print(*line);
          if (bindings.all().size() == before.all().size()) trace::match(at, messages[i], bindings);
        }
      }
      for (std::uint32_t i = 0; i < messages.size(); ++i) index.remove(i, messages[i], "rA", false);
      EXPECT_TRUE(index.like({.link = "*", .message = trace::Message::any()}, {}).empty());
    }
  }
  EXPECT_LT(looked, matched + all / 10);
  std::printf("%zu of %zu, %zu matched\n", looked, all, matched);
}

// Whoever breaks the line breaks one rule. Where it names several, what was seen tells which: each
// has signs (`shows` in spec/requirements.yaml) that the line's output can have and that blame it.
TEST(GoldenCases, ALineThatForbidsBlamesOneRule) {
  std::size_t forbidding = 0;
  for (const trace::Parsed& file : load_cases("conformance/cases")) {
    for (const trace::Case& one : file.file.cases) {
      const trace::Scope scope = trace::scope_of(file.file, one);
      for (const trace::Line* line : one.lines()) {
        if (line->op != trace::Op::kMustNot) continue;
        ++forbidding;
        if (line->requirements.size() < 2) continue;
        const LinkKind link = scope.link(line->link).value_or(LinkKind::kAny);
        EXPECT_THAT(never_blamed(*line, link), testing::IsEmpty())
            << one.name << ": " << trace::print(*line);
      }
    }
  }
  EXPECT_GT(forbidding, 1000U);
}

}  // namespace
}  // namespace rubric::runner
