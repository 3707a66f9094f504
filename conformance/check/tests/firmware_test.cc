// Compares the findings in captures of the original firmware with the expected list:
// testdata/firmware_findings.tsv, explained in firmware_findings.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "codec/reflect/requirements.h"
#include "conformance/check/input/read.h"
#include "conformance/check/observation.h"
#include "conformance/check/report/words.h"
#include "conformance/check/tests/must_read.h"

namespace rubric::check {
namespace {

constexpr const char* kCaptures[] = {"a2_join_data_sensible_start",
                                     "a_join_data",
                                     "b_reliable",
                                     "c_two_islands",
                                     "d1_lose_request",
                                     "d2_lose_reply",
                                     "d3_lose_ack",
                                     "d5_lose_all_requests",
                                     "e1_simultaneous_join",
                                     "f_synaptic",
                                     "g2_stray_reply_while_joining",
                                     "h10_hdlc_escape_and_bad_serial",
                                     "h4_stale_bytes"};
constexpr const char* kList = "conformance/check/tests/testdata/firmware_findings.tsv";

// "capture profile inputs file:frame rule severity count node", tabs between.
std::string line_of(const std::string& run, const Finding& finding) {
  std::ostringstream out;
  const char* const id = reflect::requirement(finding.requirement).id;
  out << run << '\t' << finding.place.file << ':' << finding.place.frame << '\t'
      << (*id == '\0' ? "-" : id) << '\t' << report::severity_name(finding.severity) << '\t'
      << finding.count << '\t' << (finding.node.empty() ? "-" : finding.node);
  return out.str();
}

std::vector<std::string> found_in(const std::string& capture, bool deployed, bool events) {
  const std::string run =
      capture + '\t' + (deployed ? "deployed" : "paper") + '\t' + (events ? "events" : "capture");
  std::vector<std::string> files = {"spec/captures/firmware/" + capture + ".pcapng"};
  if (events) files.push_back("conformance/check/tests/testdata/" + capture + ".app.rtr");
  AlignOptions one_clock;  // The simulator's, which stamped captures and logs.
  one_clock.skew_us = 0;
  RunReader reader(one_clock);
  std::string error;
  for (const std::string& file : files) EXPECT_TRUE(reader.add_file(file, error)) << error;
  const check::Run run_read = reader.finish();
  Options options{.deployed = deployed};
  std::vector<std::string> lines;
  for (const Finding& finding : judge(run_read, options).findings) {
    EXPECT_FALSE(finding.text.empty());
    EXPECT_FALSE(finding.expected.empty());
    lines.push_back(line_of(run, finding));
  }
  return lines;
}

TEST(Firmware, FindingsAreExactlyThoseListed) {
  std::multiset<std::string> listed;
  std::ifstream file(kList);
  ASSERT_TRUE(file) << kList;
  for (std::string line; std::getline(file, line);) {
    if (!line.empty() && line[0] != '#') listed.insert(line);
  }
  std::multiset<std::string> found;
  for (const char* capture : kCaptures) {
    for (const bool deployed : {false, true}) {
      for (const bool events : {false, true}) {
        for (const std::string& line : found_in(capture, deployed, events)) found.insert(line);
      }
    }
  }
  for (const std::string& line : found) {
    EXPECT_TRUE(listed.count(line)) << "not listed: " << line;
  }
  for (const std::string& line : listed) {
    EXPECT_TRUE(found.count(line)) << "not found: " << line;
  }
  EXPECT_EQ(listed.size(), found.size());
}

TEST(Firmware, HypothesesExplainAFailure) {
  const check::Run run = must_read({"spec/captures/firmware/g2_stray_reply_while_joining.pcapng"});
  const Report report = judge(run, Options{});
  const auto fail = std::find_if(report.findings.begin(), report.findings.end(),
                                 [](const auto& f) { return f.severity == Severity::kFail; });
  ASSERT_NE(fail, report.findings.end());
  EXPECT_EQ(fail->requirement, "J4-SEQ"_rule);
  ASSERT_FALSE(fail->hypotheses.empty());
  EXPECT_NE(fail->hypotheses[0].text.find("50421"), std::string::npos);
  EXPECT_FALSE(fail->hypotheses[0].allowed.empty());
  EXPECT_FALSE(fail->hypotheses[0].miss.empty());
}

// The serial line alone, as raw bytes: no time, no radio; nothing may fail for that.
TEST(Firmware, RawSerialBytesPass) {
  for (const char* capture : kCaptures) {
    const std::string path = std::string("spec/captures/firmware/") + capture + ".serial.bin";
    if (!std::ifstream(path)) continue;
    const check::Run run = must_read({path});
    EXPECT_FALSE(run.has_time);
    for (const Finding& finding : judge(run, Options{}).findings) {
      EXPECT_LT(finding.severity, Severity::kFail) << path << ": " << finding.text;
    }
  }
}

}  // namespace
}  // namespace rubric::check
