#include "conformance/suite/report/github.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "conformance/suite/report/words.h"

namespace rubric::suite {
namespace {

// What workflow commands ask for; properties also escape what separates them.
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
  std::string out;
  for (std::size_t i = 0; i < std::min(max, entries.size()); ++i) {
    const CaseRun& one = *entries[i].one;
    const auto& failures = one.result.failures;
    const std::uint32_t line = failures.empty() ? 1 : std::max(1u, failures[0].place.line);
    out += fmt::format("::error file={},line={},title={}::{}\n", escaped(one.file, true), line,
                       escaped(case_name(one) + " on " + entries[i].implementation, true),
                       escaped(headline(one), false));
  }
  return out;
}

}  // namespace rubric::suite
