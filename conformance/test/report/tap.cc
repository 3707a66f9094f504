#include "conformance/test/report/tap.h"

#include <fmt/format.h>

#include <algorithm>

#include "codec/text/text.h"
#include "conformance/test/report/words.h"

namespace rubric::suite {
namespace {

// Makes text readable as UTF-8, whatever an implementation wrote: other bytes and controls as \x1f.
std::string clean(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t length = text::utf8_length(text);
    const auto first = static_cast<unsigned char>(text.front());
    if (length == 0 || first < 0x20 || first == 0x7F) {
      out += fmt::format("\\x{:02x}", first);
    } else {
      out += text.substr(0, length);
    }
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return out;
}

// Escapes hashes, which would begin a directive on a line of its own.
std::string plain(std::string_view text) {
  std::string out;
  for (const char c : clean(text)) {
    if (c == '#') out += '\\';
    out += c;
  }
  return out;
}

std::string block(const CaseRun& one) {
  std::string out = fmt::format("  ---\n  verdict: {}\n  file: {}\n  details: |\n",
                                runner::verdict_text(one.result.verdict), one.file);
  std::string text = in_full(one);
  if (one.expectation == Expectation::kUnexpectedPass) {
    text = "expected to fail: " + one.expected_reason + "\n" + text;
  }
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    out += "    " + clean(std::string_view(text).substr(at, end - at)) + "\n";
    at = end + 1;
  }
  return out + "  ...\n";
}

std::string directive(const CaseRun& one) {
  if (one.expectation == Expectation::kAsExpected) return " # TODO " + plain(one.expected_reason);
  if (one.undecided() && !one.owed) {
    return fmt::format(
        " # SKIP {}: {}", runner::verdict_text(one.result.verdict),
        plain(one.expected_reason.empty() ? one.result.reason : one.expected_reason));
  }
  return "";
}

}  // namespace

std::string tap_report(const SuiteRun& run) {
  std::string points;
  std::size_t number = 0;
  for (std::size_t i = 0; i < run.implementations.size(); ++i) {
    const std::string name = implementation_name(run, i);
    const std::string& dishonest = run.implementations[i].dishonest;
    if (!dishonest.empty()) {
      points +=
          fmt::format("not ok {} - {}: refused: {}\n", ++number, plain(name), plain(dishonest));
    }
    for (const CaseRun& one : run.implementations[i].cases) {
      const bool failed = one.unexpected() || one.expectation == Expectation::kAsExpected;
      points += fmt::format("{} {} - {}: {}{}\n", failed ? "not ok" : "ok", ++number, plain(name),
                            plain(case_name(one)), directive(one));
      if (failed || !one.result.failures.empty()) points += block(one);
    }
    const ImplementationRun& implementation = run.implementations[i];
    const std::string outside = plain(outside_headline(implementation));
    if (broke_outside(implementation)) {
      points +=
          fmt::format("not ok {} - {}: outside of cases: {}\n", ++number, plain(name), outside);
    } else if (!outside.empty()) {
      points += fmt::format("# {}: {}\n", plain(name), outside);
    }
    const std::string missing = incomplete_as_a_whole(run, implementation);
    if (!missing.empty()) {
      points +=
          fmt::format("not ok {} - {}: incomplete: {}\n", ++number, plain(name), plain(missing));
    }
  }
  for (const StaleExpectation& one : run.stale) {
    points += fmt::format("not ok {} - {}: {}\n", ++number, plain(one.place), plain(one.text));
  }
  return fmt::format("TAP version 13\n1..{}\n", number) + points;
}

}  // namespace rubric::suite
