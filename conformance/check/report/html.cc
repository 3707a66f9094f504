#include "conformance/check/report/html.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
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

std::string finding_html(const Story& story, std::size_t index, const TextOptions& options) {
  const Finding& finding = story.report.findings[index];
  const bool known = story.outcome.expected_by[index] != kUnexpected;
  const bool open = finding.severity == check::Severity::kFail && !known;
  const std::string_view severity = severity_name(finding.severity);
  const std::string_view rule = reflect::requirement(finding.requirement).id;
  return fmt::format(
      "<details{}><summary><b class=\"{}\">{}</b>{} <code>{}</code> {} <span class=\"soft\">{}"
      "</span><br>{}</summary>\n<pre tabindex=\"0\">{}</pre></details>\n",
      open ? " open" : "", severity, severity, known ? " (known)" : "",
      rule.empty() ? "no rule" : text::xml_text(rule), text::xml_text(finding.node),
      text::xml_text(place_of(story, finding)), text::xml_text(finding.text),
      text::xml_text(text_finding(story, index, options)));
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
  if (found.findings.empty()) out += "<p>None.</p>\n";
  for (const std::size_t i : in_order(story)) out += finding_html(story, i, options);
  out += "<h2>Rules that were kept</h2>\n<p>";
  for (const auto& [id, count] : found.exercised) {
    out += fmt::format("<code>{}</code> {}\n", text::xml_text(reflect::requirement(id).id),
                       text::counted(count, "time"));
  }
  return out + "</p>\n</main>\n</body>\n</html>\n";
}

}  // namespace rubric::report
