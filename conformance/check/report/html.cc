#include "conformance/check/report/html.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "codec/reflect/requirements.h"
#include "conformance/check/report/words.h"

namespace rubric::report {
namespace {

using check::Finding;

constexpr std::string_view kHead =
    "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
    "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
    "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src "
    "'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'\">\n"
    "<meta name=\"referrer\" content=\"no-referrer\">\n"
    "<meta name=\"color-scheme\" content=\"light dark\">\n<link rel=\"icon\" href=\"data:,\">\n"
    "<title>Rubric check</title>\n<style>\n";
// Styles that only this page needs; the others are those of `rubric test`.
constexpr std::string_view kOwnStyles =
    "details { border-top: 1px solid var(--line); padding: .4em 0; }\n"
    "summary { cursor: pointer; overflow-wrap: anywhere; }\n"
    "pre { overflow-x: auto; background: var(--panel); padding: .6em 1em; }\n"
    "main { padding: 1em 1.6em; max-width: 90em; overflow-wrap: anywhere; }\n"
    "ul.rules { columns: 14em; list-style: none; padding: 0; }\n"
    "b.fail { color: var(--fail); } b.weak { color: var(--weak); }\n"
    "b.inconclusive, b.stray, b.note { color: var(--inconclusive); }\n";

/// Returns the findings from grave to harmless, those of no expectation first.
std::vector<std::size_t> in_order(const Story& story) {
  std::vector<std::size_t> out(story.report.findings.size());
  std::iota(out.begin(), out.end(), std::size_t{0});
  const auto rank = [&](std::size_t i) {
    const bool known = story.outcome.expected_by[i] != kUnexpected;
    return 2 * static_cast<int>(story.report.findings[i].severity) + !known;
  };
  std::stable_sort(out.begin(), out.end(),
                   [&](std::size_t a, std::size_t b) { return rank(a) > rank(b); });
  return out;
}

std::string place_of(const Story& story, const Finding& finding) {
  if (finding.place.frame == 0) return {};
  return fmt::format("frame {} of {}", finding.place.frame, story.run.files[finding.place.file]);
}

// `text` is empty for a finding that gets no more than a line.
std::string finding_html(const Story& story, std::size_t index, std::string_view text) {
  const Finding& finding = story.report.findings[index];
  const bool known = story.outcome.expected_by[index] != kUnexpected;
  const bool open = finding.severity == check::Severity::kFail && !known;
  const std::string_view severity = severity_name(finding.severity);
  const std::string_view rule = reflect::requirement(finding.requirement).id;
  const std::string line = fmt::format(
      "<b class=\"{}\">{}</b>{} <code>{}</code> {} <span class=\"soft\">{}</span><br>{}", severity,
      severity, known ? " (known)" : "", rule.empty() ? "no rule" : text::xml_text(rule),
      text::xml_text(finding.node), text::xml_text(place_of(story, finding)),
      text::xml_text(finding.text));
  if (text.empty()) return fmt::format("<p>{}</p>\n", line);
  return fmt::format("<details{}><summary>{}</summary>\n<pre tabindex=\"0\">{}</pre></details>\n",
                     open ? " open" : "", line, text::xml_text(text));
}

std::string findings_html(const Story& story, const TextOptions& options) {
  const std::vector<std::size_t> all = in_order(story);
  std::map<std::pair<std::size_t, check::Severity>, std::size_t> in_full_of;
  std::vector<std::size_t> in_full;
  for (const std::size_t i : all) {
    const Finding& finding = story.report.findings[i];
    const std::size_t rule = reflect::requirement_index(finding.requirement);
    if (in_full_of[{rule, finding.severity}]++ < options.findings_max) in_full.push_back(i);
  }
  const std::vector<std::string> texts = text_findings(story, in_full, options);
  std::string out;
  std::size_t next = 0;
  for (const std::size_t i : all) {
    const bool full = next < in_full.size() && in_full[next] == i;
    out += finding_html(story, i, full ? std::string_view(texts[next++]) : std::string_view());
  }
  if (all.empty()) out += "<p>None.</p>\n";
  if (in_full.size() < all.size()) {
    out +=
        fmt::format("<p>The first {} of a rule are shown in full; --max-findings N shows N.</p>\n",
                    options.findings_max);
  }
  return out;
}

}  // namespace

std::string html_report(const Story& story, const TextOptions& options, std::string_view style) {
  const check::Report& found = story.report;
  std::string out(kHead);
  out += style;
  out += kOwnStyles;
  out +=
      "</style>\n</head>\n<body>\n<header class=\"top\"><h1>Rubric <span>check</span></h1>"
      "</header>\n<main id=\"main\">\n";
  out += fmt::format("<h2>Verdict: {}</h2>\n", text_verdict(story));
  out += "<ul>\n";
  for (const std::string& file : story.run.files) {
    out += fmt::format("<li><code>{}</code></li>\n", text::xml_text(file));
  }
  out += "</ul>\n";
  for (const std::string& fact : found.facts)
    out += fmt::format("<p>{}</p>\n", text::xml_text(fact));
  out += "<h2>Findings</h2>\n";
  out += findings_html(story, options);
  out += "<h2>Rules exercised</h2>\n<ul class=\"rules\">\n";
  for (const auto& [id, count] : found.exercised) {
    out += fmt::format("<li><code>{}</code> {}</li>\n", text::xml_text(reflect::requirement(id).id),
                       text::counted(count, "time"));
  }
  return out + "</ul>\n</main>\n</body>\n</html>\n";
}

}  // namespace rubric::report
