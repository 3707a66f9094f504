#include "tools/commands/check_news.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <chrono>

#include "codec/text/shell.h"
#include "codec/text/text.h"
#include "conformance/check/observation.h"
#include "conformance/check/report/html.h"
#include "conformance/check/report/json.h"
#include "conformance/check/report/junit.h"
#include "conformance/check/report/words.h"
#include "conformance/test/report/folder.h"
#include "conformance/test/report/html_assets.h"

namespace rubric::tools {
namespace {

using check::Change;
using text::Json;

// "at" is when it was said, in seconds since 1970; null of a run that is over.
std::string event(std::string_view name, bool live, const Json::Members& more) {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  const double seconds = std::chrono::duration<double>(now).count();
  Json::Members all = {{"schema", "rubric.check.event/1"},
                       {"event", name},
                       {"at", Json::raw(live ? fmt::format("{:.3f}", seconds) : "")}};
  all.insert(all.end(), more.begin(), more.end());
  std::string out = Json::object(all).text();
  std::erase(out, '\n');  // Line ends are between items only: those of texts are escaped.
  return out + '\n';
}

std::string report_event(const report::Story& story, bool live) {
  return event("report", live, {{"report", report::json_report(story)}});
}

std::string change_event(const report::Story& story, const Change& change) {
  const Json finding = report::json_finding(story, 0);
  switch (change.what) {
    case Change::What::kFound: return event("found", true, {{"finding", finding}});
    case Change::What::kChanged:
      return event("changed", true,
                   {{"was", report::severity_name(change.before)}, {"finding", finding}});
    case Change::What::kWithdrawn: break;
  }
  return event("withdrawn", true, {{"why", change.why}, {"finding", finding}});
}

std::string all_events(const report::Story& story) {
  std::string out;
  for (std::size_t i = 0; i < story.report.findings.size(); ++i) {
    out += event("found", false, {{"finding", report::json_finding(story, i)}});
  }
  return out + report_event(story, false);
}

int fd_of_news(const CheckOptions& options) {
  const bool document = options.format == "json" || options.format == "junit";
  return document && options.out == "-" ? STDERR_FILENO : STDOUT_FILENO;
}

}  // namespace

std::string report_text(const CheckOptions& options, const report::Story& story, int fd,
                        const std::vector<std::string>& files) {
  if (options.format == "json") return report::json_report(story).text() + '\n';
  if (options.format == "jsonl") return all_events(story);
  if (options.format == "junit") return report::junit_report(story);
  report::TextOptions text = text_options(options, fd);
  if (files.empty()) {
    text.command.clear();
  } else {
    text.command = command_of(options);
    text.judge = check::judge;
  }
  for (const std::string& file : files) text.files += " " + text::shell_word(file);
  return report::text_report(story, text);
}

bool write_report_folder(const CheckOptions& options, const report::Story& story) {
  if (options.report.empty()) return true;
  report::TextOptions text = text_options(options, -1);
  text.color = false;
  text.verbose = true;
  text.command.clear();
  try {
    suite::ReportFolder folder(options.report);
    folder.write(suite::ReportFolder::kPage, report::html_report(story, text, suite::kStyle));
    folder.write(suite::ReportFolder::kJson, report::json_report(story).text() + '\n');
    folder.write(suite::ReportFolder::kJunit, report::junit_report(story));
    folder.finish();
    return true;
  } catch (const std::system_error& error) {
    cli::cannot_write(error);
    return false;
  }
}

CheckNews::CheckNews(const CheckOptions& options)
    : options_(options),
      fd_(fd_of_news(options)),
      in_file_(options.format == "jsonl" && options.out != "-") {
  if (!in_file_) output_.emplace(fd_);
}

cli::Output& CheckNews::output() {
  if (!output_) output_.emplace(options_.out, options_.write.growing());
  return *output_;
}

void CheckNews::begin() const {
  if (::isatty(STDERR_FILENO) == 0) return;
  text::print(stderr, "rubric check: findings as they come; Ctrl-C ends with the report\n");
}

void CheckNews::report(const check::Run& run, const check::Options& judged, const Change& change,
                       const report::KnownFailures& expected) {
  if (change.finding.severity == check::Severity::kNote && !options_.verbose &&
      options_.format != "jsonl") {
    return;
  }
  check::Report one;
  one.findings.push_back(change.finding);
  const report::Outcome outcome = report::compare(run, judged, one, expected);
  const report::Story story{run, judged, one, expected, outcome};
  output().buffer().append(options_.format == "jsonl" ? change_event(story, change)
                                                      : text(story, change));
  output().drain();
  told_ = true;
}

std::string CheckNews::text(const report::Story& story, const Change& change) const {
  const report::TextOptions text = text_options(options_, fd_);
  if (change.what == Change::What::kWithdrawn) {
    report::TextOptions line = text;
    line.verbose = false;
    line.head = "WITHDRAWN";
    line.text = change.why + ".";
    return report::text_finding(story, 0, line);
  }
  report::TextOptions shown = text;
  shown.command.clear();
  if (change.what == Change::What::kChanged) {
    shown.head = "NOW";
    shown.text =
        fmt::format("{} (was {})", change.finding.text, report::severity_name(change.before));
  }
  return report::text_finding(story, 0, shown);
}

bool CheckNews::open() const {
  if (!output_) return true;
  pollfd self{output_->fd(), 0, 0};
  return output_->open() && !(::poll(&self, 1, 0) == 1 && (self.revents & POLLERR) != 0);
}

bool CheckNews::report(const report::Story& story, const std::vector<std::string>& files) {
  if (options_.format == "jsonl") {
    if (!write_report_folder(options_, story)) return false;
    output().buffer().append(report_event(story, true));
    return output().finish();
  }
  const bool here = options_.out == "-" && fd_ == STDOUT_FILENO;
  if (here && told_) output().buffer().append("\n");
  if (!output().finish()) return false;
  const int terminal = options_.out == "-" ? STDOUT_FILENO : -1;
  if (!write_report_folder(options_, story)) return false;
  return cli::write_file(options_.out, report_text(options_, story, terminal, files));
}

}  // namespace rubric::tools
