// Output of `rubric check`: findings as they come, and the report.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "conformance/check/judge/watch.h"
#include "tools/cli/output.h"
#include "tools/commands/check_options.h"

namespace rubric::tools {

/// Returns the report in the chosen format. `fd` is a terminal's or -1; `files` are those from
/// which the same run can be read again, none if it cannot.
std::string report_text(const CheckOptions& options, const report::Story& story, int fd,
                        const std::vector<std::string>& files);

/// Writes the folder of --report, if it is asked for: index.html, report.json and junit.xml.
/// Returns false, having printed why, if that fails.
bool write_report_folder(const CheckOptions& options, const report::Story& story);

/// Prints news of a growing run: text on stdout, jsonl where the report goes. If stdout is for a
/// report of another format, text goes to stderr.
class CheckNews {
 public:
  explicit CheckNews(const CheckOptions& options);
  CheckNews(const CheckNews&) = delete;
  CheckNews& operator=(const CheckNews&) = delete;

  /// Prints, at a terminal, that a wait begins.
  void begin() const;
  /// Throws std::system_error if a file cannot be opened, as report() does.
  void report(const check::Run& run, const check::Options& judged, const check::Change& change,
              const report::KnownFailures& expected);
  /// What was told can be read then.
  void flush() {
    if (output_) output_->flush();
  }
  /// Returns whether anybody still reads it.
  bool open() const;
  /// Prints the end. Returns false, having printed why, if something could not be written.
  bool report(const report::Story& story, const std::vector<std::string>& files);

 private:
  cli::Output& output();
  std::string text(const report::Story& story, const check::Change& change) const;

  const CheckOptions& options_;
  int fd_;
  bool in_file_;                       // As jsonl, which grows.
  std::optional<cli::Output> output_;  // A file is opened when there is something to say.
  bool told_ = false;
};

}  // namespace rubric::tools
