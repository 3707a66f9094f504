// A report for people.
#pragma once

#include <string>

#include "codec/text/text.h"
#include "conformance/check/report/expect.h"
#include "conformance/check/report/window.h"

namespace rubric::report {

/// The parts of a report. Borrowed.
struct Story {
  const check::Run& run;
  const check::Options& options;
  const check::Report& report;
  const KnownFailures& expected;
  const Outcome& outcome;
};

struct TextOptions : text::TextStyle {
  bool verbose = false;  ///< Every finding in full, not only the first of a rule and node.
  std::size_t findings_max =
      20;  ///< So many of a rule and severity are in full; others are counted.
  /// The command that made this run, ready for a shell: program and options, and its files. Empty
  /// if the run cannot be repeated.
  std::string command = "rubric check";
  std::string files;
  std::string head;  ///< text_finding(): printed before the severity, in capitals.
  std::string text;  ///< text_finding(): said in a line in place of the finding's.
  Judge judge;       ///< Finds parts of the run that show a finding; empty: none.
};

/// Returns the report: facts about the run, each failure in full (others of the same rule and node
/// on one line, and those after findings_max), the rest on a line each, the results of
/// expectations, and the sum.
std::string text_report(const Story& story, const TextOptions& options);

/// Returns the verdict, and what was counted, in a sentence.
std::string text_verdict(const Story& story);

/// Returns one finding of a story: a line, wrapped to the width; in full with `verbose`.
std::string text_finding(const Story& story, std::size_t index, const TextOptions& options);
/// Returns the same of several, looking through the run once.
std::vector<std::string> text_findings(const Story& story, const std::vector<std::size_t>& indices,
                                       const TextOptions& options);

}  // namespace rubric::report
