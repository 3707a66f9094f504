// Golden traces as their authors wrote them, for readers of a report.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "conformance/test/suite/result.h"

namespace rubric::suite {

struct SourceLine {
  std::uint32_t number;  ///< In its file, from 1.
  std::string text;
};

/// Finds the text of cases: the kit's own in the program, the user's in their files.
class CaseSources {
 public:
  /// Returns the headers of its file, then the case from its first line to its last. Empty if the
  /// file is gone or no longer has the case.
  std::vector<SourceLine> of(const SuiteRun& run, const CaseRun& one);

 private:
  struct Source {
    std::vector<std::string> lines;
    std::vector<std::uint32_t> head;             // Numbers of the headers of the file.
    std::map<std::string, std::uint32_t> cases;  // And where they begin.
  };
  const Source& read(const std::string& name, bool own);

  std::map<std::string, Source> files_;
};

}  // namespace rubric::suite
