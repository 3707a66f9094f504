// The golden traces of a suite: the kit's own, which the program contains, or the user's files.
#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <string>
#include <string_view>
#include <vector>

#include "conformance/test/suite/result.h"
#include "conformance/trace/parse.h"

namespace rubric::suite {

/// A golden trace and its properties before it is run.
struct SuiteCase {
  const trace::Parsed* file = nullptr;
  const trace::Case* one = nullptr;  ///< Its headers alone where there is `text`.
  std::string_view text = {};        ///< Of the case, as it is in the file; empty: `one` is whole.

  /// Returns it with its lines.
  trace::Case whole() const;
  /// Gives `take` its lines, without keeping them.
  void each_line(const std::function<void(const trace::Line&)>& take) const;
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
  /// Returns the cases of conformance/cases, or of one of its files, as they were when the program
  /// was built.
  static Cases own(std::string_view file_name = {});
  /// Reads .rtr files, and folders of them, and keeps their text. Throws std::runtime_error with
  /// what is wrong, by file, line and column.
  static Cases of(const std::vector<std::string>& paths);
  /// Reads the text of one file.
  static Cases of_text(std::string_view text, const std::string& file_name);

  /// Returns the cases in the order of files and lines.
  const std::vector<SuiteCase>& all() const { return cases_; }
  /// Returns the case of this name, or null.
  const SuiteCase* find(std::string_view name) const;

 private:
  std::string add_text(std::string text, std::string_view file_name);
  void add(trace::Parsed file, std::string_view text);
  void sort_names();

  std::list<std::string> texts_;    // Cases point into them,
  std::list<trace::Parsed> files_;  // and into these.
  std::vector<SuiteCase> cases_;
  std::vector<std::uint32_t> by_name_;  // Their places in cases_.
};

/// A golden trace as text, under its path in the project. Generated when the program is built.
struct EmbeddedFile {
  const char* name;
  const char* text;
};
const std::vector<EmbeddedFile>& embedded_files();

}  // namespace rubric::suite
