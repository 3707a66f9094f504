// Property: whatever bytes `rubric check` gets as a capture or a log, it ends with the verdict of
// its findings, about existing frames, in whole reports, the same each time.
#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "conformance/check/input/duplicates.h"
#include "conformance/check/input/read.h"
#include "conformance/check/judge/findings.h"
#include "conformance/check/observation.h"
#include "conformance/check/report/html.h"
#include "conformance/check/report/json.h"
#include "conformance/check/report/junit.h"
#include "conformance/check/report/text.h"
#include "fuzz/support/require.h"
#include "tools/encode/members.h"

namespace {

using namespace rubric;
using fuzz::require;

// The text report judges parts of a run to find the least that shows a failure.
constexpr std::size_t kSearchedMax = 12;

// Chooses options by the input's size, so that a capture is a valid input.
check::Options options_for(std::size_t size) {
  check::Options out;
  out.deployed = (size & 1) != 0;
  out.sniffer_complete = (size & 2) != 0;
  out.start_cold = (size & 4) != 0;
  if ((size & 8) != 0) out.nodes = {{1, machine::Role::kSink, 11}, {2, machine::Role::kMote, 0}};
  if ((size & 16) != 0) out.testers = {3};
  return out;
}

void refers_to_what_is_there(const check::Run& run, const check::Report& report) {
  std::set<std::pair<std::uint32_t, std::uint64_t>> frames;
  for (const check::Observation& one : run.seen) frames.insert({one.place.file, one.place.frame});
  const auto is_there = [&](const check::Place& place) {
    return place.file < run.files.size() &&
           (place.frame == 0 || frames.contains({place.file, place.frame}));
  };
  for (const check::Finding& one : report.findings) {
    require(is_there(one.place) && is_there(one.last), "a finding is about a frame that is there");
    require(one.count >= 1 && !one.text.empty(), "a finding says what happened");
  }
  require(report.frames <= run.seen.size(), "no more frames are judged than were seen");
  require(report.verdict == check::verdict_of(report.findings), "the verdict is the gravest");
}

std::string reports(const report::Story& story) {
  const std::string json = report::json_report(story).text();
  encode::parse_json(json);
  report::TextOptions options;
  if (story.run.seen.size() <= kSearchedMax) options.judge = check::judge;
  const std::string text = report::text_report(story, options);
  const std::string junit = report::junit_report(story);
  require(!text.empty() && junit.find("</testsuite") != std::string::npos, "reports are whole");
  const std::string page = report::html_report(story, options, "");
  require(page.ends_with("</html>\n"), "the page is whole");
  require(page.find("<script") == page.npos, "no text becomes a part of the page");
  return json + text + junit + page;
}

std::string checked(std::string_view bytes, const check::Options& given) {
  check::Options options = given;
  check::RunReader reader;
  std::string error;
  if (!reader.add_bytes("input", bytes, error)) {
    require(!error.empty(), "a refusal has a reason");
    return error;
  }
  check::Run run = reader.finish();
  if (!check::drop_duplicates(run, options, error)) return error;
  const check::Report found = check::judge(run, options);
  refers_to_what_is_there(run, found);
  const report::KnownFailures expected;
  const report::Outcome outcome = report::compare(run, options, found, expected);
  return reports({run, options, found, expected, outcome});
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const check::Options options = options_for(size);
  const std::string first = checked(bytes, options);
  require(first == checked(bytes, options), "the same input gives the same reports");
  return 0;
}
