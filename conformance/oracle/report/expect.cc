#include "conformance/oracle/report/expect.h"

#include <fmt/format.h>
#include <fnmatch.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <set>

#include "codec/reflect/fault_text.h"

namespace rubric::report {
namespace {

using oracle::Finding;
using oracle::Severity;

struct Mistake {
  std::uint32_t line;
  std::string text;
};

std::uint32_t line_of(const YAML::Mark& mark) { return static_cast<std::uint32_t>(mark.line + 1); }

std::string scalar(const YAML::Node& node, const std::string& key) {
  if (!node.IsScalar() || node.Scalar().empty()) {
    throw Mistake{line_of(node.Mark()), key + ": expected a text"};
  }
  return node.Scalar();
}

Expectation read_one(const YAML::Node& node) {
  Expectation one;
  one.line = line_of(node.Mark());
  if (!node.IsMap()) throw Mistake{one.line, "expected requirement, message and reason"};
  std::set<std::string> seen;
  for (const auto& entry : node) {
    const std::string key = scalar(entry.first, "key");
    const std::uint32_t line = line_of(entry.first.Mark());
    if (!seen.insert(key).second) throw Mistake{line, key + " stands here twice"};
    const std::string value = scalar(entry.second, key);
    if (key == "requirement") {
      one.requirement = reflect::find_requirement(value);
      if (one.requirement == ReqId::kNone) {
        throw Mistake{line, "no requirement is called '" + value + "'"};
      }
    } else if (key == "node") {
      one.node = value;
    } else if (key == "file") {
      one.file = value;
    } else if (key == "profile") {
      if (value != "paper" && value != "deployed") {
        throw Mistake{line, "profile is paper or deployed, not '" + value + "'"};
      }
      one.profile = value;
    } else if (key == "message") {
      one.message = value;
    } else if (key == "reason") {
      one.reason = value;
    } else {
      throw Mistake{line, "unknown key '" + key +
                              "'; known are requirement, node, file, profile, message, reason"};
    }
  }
  for (const char* key : {"requirement", "message", "reason"}) {
    if (!seen.contains(key)) throw Mistake{one.line, fmt::format("{} is missing", key)};
  }
  return one;
}

bool glob_matches(const std::string& glob, const std::string& path) {
  const std::string name = path.substr(path.rfind('/') + 1);
  return ::fnmatch(glob.c_str(), path.c_str(), 0) == 0 ||
         ::fnmatch(glob.c_str(), name.c_str(), 0) == 0;
}

bool applies(const Expectation& one, const oracle::Run& run, bool deployed) {
  if (!one.profile.empty() && (one.profile == "deployed") != deployed) return false;
  return one.file.empty() ||
         std::any_of(run.files.begin(), run.files.end(),
                     [&](const std::string& file) { return glob_matches(one.file, file); });
}

// All but the message agrees.
bool is_about(const Expectation& one, const oracle::Run& run, const Finding& finding) {
  if (finding.severity != Severity::kFail || finding.requirement != one.requirement) return false;
  if (!one.node.empty() && finding.node != one.node) return false;
  return one.file.empty() || (finding.place.file < run.files.size() &&
                              glob_matches(one.file, run.files[finding.place.file]));
}

}  // namespace

std::string_view came_name(Came came) {
  switch (came) {
    case Came::kTrue: return "matched";
    case Came::kStale: return "stale";
    case Came::kOtherMessage: return "other_message";
    case Came::kNotAsked: return "not_applicable";
  }
  return "not_applicable";
}

bool parse_expectations(std::string_view text, const std::string& name, ExpectationFile& out,
                        std::string& error) {
  out = {name, {}};
  try {
    const YAML::Node root = YAML::Load(std::string(text));
    if (!root.IsSequence()) throw Mistake{1, "expected a list of expectations"};
    for (const YAML::Node& node : root) out.expectations.push_back(read_one(node));
  } catch (const Mistake& mistake) {
    error = fmt::format("{}:{}: {}", name, mistake.line, mistake.text);
    return false;
  } catch (const YAML::Exception& broken) {
    error = fmt::format("{}:{}: {}", name, line_of(broken.mark), broken.msg);
    return false;
  }
  return true;
}

Outcome compare(const oracle::Run& run, const oracle::Options& options,
                const oracle::Report& report, const ExpectationFile& file) {
  Outcome out;
  out.expected_by.assign(report.findings.size(), kUnexpected);
  for (std::size_t e = 0; e < file.expectations.size(); ++e) {
    const Expectation& one = file.expectations[e];
    ExpectationResult result;
    if (applies(one, run, options.deployed)) {
      std::vector<std::size_t> others;
      for (std::size_t i = 0; i < report.findings.size(); ++i) {
        const Finding& finding = report.findings[i];
        if (!is_about(one, run, finding)) continue;
        const bool same = finding.text.find(one.message) != std::string::npos;
        (same ? result.findings : others).push_back(i);
        if (same && out.expected_by[i] == kUnexpected) out.expected_by[i] = e;
      }
      result.came = !result.findings.empty() ? Came::kTrue
                    : others.empty()         ? Came::kStale
                                             : Came::kOtherMessage;
      if (result.findings.empty()) result.findings = std::move(others);
      if (result.came != Came::kTrue) ++out.broken_expectations;
    }
    out.results.push_back(std::move(result));
  }
  bool decided = !report.exercised.empty();
  for (std::size_t i = 0; i < report.findings.size(); ++i) {
    const Severity severity = report.findings[i].severity;
    const bool failed = severity == Severity::kFail;
    if (failed && out.expected_by[i] == kUnexpected) ++out.unexpected_failures;
    decided = decided || failed || severity == Severity::kWeak;
  }
  out.nothing_judged = !decided;
  out.verdict = decided ? report.verdict : oracle::Verdict::kInconclusive;
  return out;
}

}  // namespace rubric::report
