// The golden traces of a suite: the kit's own, which the program contains, or the user's files.
#pragma once

#include <cstddef>
#include <list>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "conformance/test/suite/result.h"
#include "conformance/trace/parse.h"

namespace rubric::suite {

/// A golden trace and its properties before it is run.
struct SuiteCase {
  const trace::Parsed* file = nullptr;
  const trace::Case* one = nullptr;

  /// Returns what is known before it is run.
  CaseRun blank() const;
  /// Returns the roles of its nodes under test, each once.
  std::vector<machine::Role> roles() const;
  /// Returns the rules that its lines name, families too, each once.
  std::vector<std::string> rules() const;
};

/// Owns the files. Names of cases are unique, and each has a node under test.
class Cases {
 public:
  Cases() = default;
  Cases(Cases&&) = default;
  Cases& operator=(Cases&&) = default;
  /// Returns the cases of conformance/cases as they were when the program was built.
  static Cases own();
  /// Reads .rtr files, and folders of them. Throws std::runtime_error with what is wrong, by file,
  /// line and column.
  static Cases of(const std::vector<std::string>& paths);
  /// Reads the text of one file.
  static Cases of_text(std::string_view text, const std::string& file_name);

  /// Returns the cases in the order of files and lines.
  const std::vector<SuiteCase>& all() const { return cases_; }
  /// Returns the case of this name, or null.
  const SuiteCase* find(std::string_view name) const;

 private:
  void add(trace::Parsed file);

  std::list<trace::Parsed> files_;  // Cases point into them.
  std::vector<SuiteCase> cases_;
  std::unordered_map<std::string_view, std::size_t> places_;  // By name.
};

/// A golden trace as text, under its path in the project. Generated when the program is built.
struct EmbeddedFile {
  const char* name;
  const char* text;
};
const std::vector<EmbeddedFile>& embedded_files();

}  // namespace rubric::suite
