#include "conformance/test/report/github.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "conformance/test/report/words.h"

namespace rubric::suite {
namespace {

// Escapes text for workflow commands; properties also escape their separators.
std::string escaped(std::string_view text, bool property) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '%': out += "%25"; break;
      case '\r': out += "%0D"; break;
      case '\n': out += "%0A"; break;
      case ':': out += property ? "%3A" : ":"; break;
      case ',': out += property ? "%2C" : ","; break;
      default: out += c;
    }
  }
  return out;
}

struct Entry {
  const CaseRun* one;
  std::string implementation;
};

}  // namespace

std::string github_annotations(const SuiteRun& run, std::size_t max) {
  std::vector<Entry> entries;
  for (std::size_t i = 0; i < run.implementations.size(); ++i) {
    for (const CaseRun& one : run.implementations[i].cases) {
      if (one.unexpected()) entries.push_back({&one, implementation_name(run, i)});
    }
  }
  std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return a.one->result.verdict > b.one->result.verdict;
  });
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < run.implementations.size(); ++i) {
    const std::string& dishonest = run.implementations[i].dishonest;
    if (dishonest.empty()) continue;
    lines.push_back(fmt::format("::error title={} is refused::{}\n",
                                escaped(implementation_name(run, i), true),
                                escaped(dishonest, false)));
  }
  for (std::size_t i = 0; i < run.implementations.size(); ++i) {
    if (!broke_outside(run.implementations[i])) continue;
    lines.push_back(fmt::format("::error title={} broke between cases::{}\n",
                                escaped(implementation_name(run, i), true),
                                escaped(outside_headline(run.implementations[i]), false)));
  }
  for (std::size_t i = 0; i < run.implementations.size(); ++i) {
    const std::string missing = incomplete_as_a_whole(run, run.implementations[i]);
    if (missing.empty()) continue;
    lines.push_back(fmt::format("::error title={} is incomplete::{}\n",
                                escaped(implementation_name(run, i), true),
                                escaped(missing, false)));
  }
  for (const StaleExpectation& one : run.stale) {
    const std::size_t colon = one.place.rfind(':');  // "file:line".
    lines.push_back(fmt::format("::error file={},line={},title=expectation that is not true::{}\n",
                                escaped(one.place.substr(0, colon), true),
                                one.place.substr(colon + 1), escaped(one.text, false)));
  }
  for (const Entry& entry : entries) {
    const CaseRun& one = *entry.one;
    const auto& failures = one.result.failures;
    const std::uint32_t line = failures.empty() ? 1 : std::max(1u, failures[0].place.line);
    lines.push_back(fmt::format("::error file={},line={},title={}::{}\n", escaped(one.file, true),
                                line, escaped(case_name(one) + " on " + entry.implementation, true),
                                escaped(headline(one), false)));
  }
  std::string out;
  for (std::size_t i = 0; i < std::min(max, lines.size()); ++i) out += lines[i];
  return out;
}

}  // namespace rubric::suite
