// Property: whatever golden traces say, and whatever words an implementation has, each report of
// the suite is whole: JSON that reads back as the same verdicts, XML that a plain scanner takes,
// a TAP line and an annotation a result, and data of the page that no text in it can leave.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "conformance/test/report/chart.h"
#include "conformance/test/report/compare.h"
#include "conformance/test/report/github.h"
#include "conformance/test/report/html.h"
#include "conformance/test/report/json.h"
#include "conformance/test/report/junit.h"
#include "conformance/test/report/tap.h"
#include "conformance/test/report/words.h"
#include "conformance/test/suite/cases.h"
#include "fuzz/support/require.h"

namespace {

using namespace rubric;
using fuzz::require;
using Json = nlohmann::json;

constexpr std::size_t kCasesMax = 4;
constexpr std::size_t kWordMax = 60;

std::size_t count(std::string_view text, std::string_view what) {
  std::size_t out = 0;
  for (std::size_t at = 0; (at = text.find(what, at)) != text.npos; at += what.size()) ++out;
  return out;
}

// Runs the cases on the reference machine, which then speaks words of the input.
suite::SuiteRun run_of(const suite::Cases& cases, std::string_view input) {
  std::size_t at = 0;
  const auto word = [&] {
    if (at >= input.size()) at = 0;
    const std::string_view out = input.substr(at, kWordMax);
    at += out.size();
    return std::string(out);
  };
  suite::SuiteRun out;
  suite::ImplementationRun& one = out.implementations.emplace_back();
  one.target = word();
  one.identity.name = word();
  one.identity.version = word();
  one.identity.roles = {machine::Role::kMote};
  for (const suite::SuiteCase& known : cases.all()) {
    if (one.cases.size() == kCasesMax) break;
    suite::CaseRun run = suite::run_on_machine(known).run;
    run.comment = known.blank().comment;
    run.stderr_text = word();
    run.expected_reason = word();
    run.expectation = static_cast<suite::Expectation>(input.size() / 2 % 4);
    if (input.size() % 2 == 0) {  // As one that broke.
      run.result.verdict = runner::CaseVerdict::kError;
      run.result.reason = word();
    }
    one.cases.push_back(std::move(run));
  }
  if (input.size() % 5 == 0) one.outside.push_back({word(), word(), true, word()});
  if (input.size() % 7 == 0) one.dishonest = word();
  if (input.size() % 3 == 0) out.stale.push_back({"known.yaml:3", word()});
  return out;
}

// Takes XML as junit_report() may write it: elements that close, attributes in quotes.
void is_xml(std::string_view text) {
  std::vector<std::string> open;
  for (std::size_t at = 0; at < text.size();) {
    if (text[at] != '<') {
      const auto byte = static_cast<unsigned char>(text[at]);
      require(byte >= 0x20 || byte == '\n' || byte == '\t' || byte == '\r',
              "no control characters");
      if (text[at] == '&') require(text.substr(at, 12).find(';') != text.npos, "entities end");
      ++at;
      continue;
    }
    std::size_t end = at + 1;
    for (bool quoted = false; end < text.size() && (quoted || text[end] != '>'); ++end) {
      quoted = quoted != (text[end] == '"');
      require(text[end] != '<', "no tag within a tag");
    }
    require(end < text.size(), "tags end");
    const std::string_view tag = text.substr(at + 1, end - at - 1);
    const std::string name(
        tag.substr(tag[0] == '/', tag.find_first_of(" \n/>", 1) - (tag[0] == '/')));
    at = end + 1;
    if (tag[0] == '?' || tag.ends_with('/')) continue;
    if (tag[0] != '/') {
      open.push_back(name);
    } else {
      require(!open.empty() && open.back() == name, "elements close in order");
      open.pop_back();
    }
  }
  require(open.empty(), "all elements close");
}

void verdicts_read_back(const suite::SuiteRun& run) {
  const suite::EarlierRun again = suite::read_json_report(suite::json_report(run));
  const suite::ImplementationRun& one = run.implementations[0];
  std::size_t found = 0;
  for (const auto& [key, verdict] : again.verdicts) {
    for (const suite::CaseRun& known : one.cases) {
      found += known.name == key.case_name && runner::verdict_text(known.result.verdict) == verdict;
    }
  }
  require(found == one.cases.size(), "JSON reads back as the same verdicts");
  const suite::Comparison none = suite::compare(run, again);
  require(none.changed.empty() && none.added.empty() && none.gone.empty(),
          "a run compared with itself has not changed");
}

void page_has_its_data(const suite::SuiteRun& run) {
  const std::vector<std::vector<suite::CaseLinks>> links(
      1, std::vector<suite::CaseLinks>(run.implementations[0].cases.size()));
  const std::string data = suite::html_data(run, nullptr, links);
  require(data.find('<') == data.npos, "no text ends the page's script");
  const Json page = Json::parse(data);
  for (const Json& frame : page.at("frames")) {
    std::size_t next = 0;
    for (const Json& field : frame.at("fields")) {
      require(field[0] == next, "fields come one after the other");
      next += field[1].get<std::size_t>();
    }
    require(2 * next == frame.at("hex").get<std::string>().size(), "each byte has its field");
  }
  const auto is_there = [&](const Json& index, const char* list) {
    require(index.is_null() || index.get<std::size_t>() < page.at(list).size(), "it is there");
  };
  for (const Json& one : page.at("cases")) {
    for (const Json& each : one.at("runs")) {
      is_there(each.at("chart"), "charts");
      is_there(each.at("implementation"), "implementations");
      for (const Json& line : each.at("log")) is_there(line.value("frame", Json()), "frames");
    }
  }
}

void lines_are_whole(const suite::SuiteRun& run) {
  const std::string tap = "\n" + suite::tap_report(run);
  const std::size_t points = count(tap, "\nok ") + count(tap, "\nnot ok ");
  require(tap.find("\n1.." + std::to_string(points) + "\n") != tap.npos, "TAP has its plan");
  require(points >= run.implementations[0].cases.size(), "and a line a case");
  const std::string github = "\n" + suite::github_annotations(run);
  require(count(github, "\n::error ") + 1 == count(github, "\n"), "an annotation is a line");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  suite::Cases cases;
  try {
    cases = suite::Cases::of_text(text, "input.rtr");
  } catch (const std::runtime_error& error) {
    require(*error.what() != '\0', "a refusal has a reason");
    try {
      suite::read_json_report(text);
    } catch (const std::runtime_error& wrong) {
      require(*wrong.what() != '\0', "a refusal has a reason");
    }
    return 0;
  }
  const suite::SuiteRun run = run_of(cases, text);
  verdicts_read_back(run);
  is_xml(suite::junit_report(run));
  lines_are_whole(run);
  page_has_its_data(run);
  return 0;
}
