// Files without time stamps beside files that have them.
#include <gtest/gtest.h>

#include <set>

#include "conformance/check/observation.h"
#include "conformance/check/tests/failures.h"
#include "conformance/check/tests/must_read.h"
#include "conformance/check/tests/testing.h"

namespace rubric::check::times_test {
namespace {

constexpr const char* kCaptures[] = {
    "a_join_data",          "b_reliable", "c_two_islands",  "d3_lose_ack",
    "e1_simultaneous_join", "f_synaptic", "h4_stale_bytes", "h10_hdlc_escape_and_bad_serial"};

// Moves the frames of serial lines to a second file, which has no stamps.
void lose_serial_times(Run& run) {
  run.files.push_back("serial.bin");
  for (Observation& seen : run.seen) {
    if (run.taps[seen.tap].link != machine::Link::kSerial) continue;
    seen.place.file = 1;
    seen.place.time_us = -1;
  }
  merge(run);
}

check::Run capture(const std::string& name) {
  return must_read({"spec/captures/firmware/" + name + ".pcapng"});
}

TEST(Times, OfOneFileAreJudgedBesideAFileWithoutAny) {
  auto run = capture("a_join_data");
  const std::int64_t end_us = run.end_us;
  lose_serial_times(run);
  EXPECT_FALSE(run.has_time);
  EXPECT_GE(run.end_us, end_us - 1'000'000);
  bool clock = false;
  for (const Finding& finding : judge(run, Options{}).findings) {
    clock = clock || (finding.requirement == "J3-TIME"_rule && finding.severity == Severity::kFail);
  }
  EXPECT_TRUE(clock);
}

TEST(Times, NothingFailsByAnUnknownOrder) {
  for (const char* name : kCaptures) {
    for (const bool strict : {false, true}) {
      auto run = capture(name);
      Options options{.sniffer_complete = strict, .start_cold = strict};
      const auto before = failures_of(judge(run, options));
      lose_serial_times(run);
      for (const std::string& failure : failures_of(judge(run, options))) {
        EXPECT_TRUE(before.contains(failure)) << name << ": " << failure;
      }
    }
  }
}

// A mote joins and sends a message, which goes up the line.
Script one_mote() {
  Script script;
  NetFields up{.dest = {11, machine::kNullDevid}, .src = {11, 2}, .seq_num = 1};
  script.join(0, 11, 2, 100).net(200, 2, 1, up).up(215, up.forwarded());
  return script;
}

TEST(Times, AFormatIsBrokenAtAnyTime) {
  Script script = one_mote();
  NetFields own{.dest = {11, machine::kNullDevid}, .src = {11, 1}, .nbytes = 1};
  script.up(300, own);
  lose_serial_times(script.run);
  EXPECT_EQ(failures_of(judge(script.run, Options{})).size(), 1U);
}

TEST(Times, AFileAloneWithoutThemKeepsItsOrder) {
  Script script = Script().joined(40, 11, 2).joined(50, 11, 2);
  lose_serial_times(script.run);
  Options options{.start_cold = true};
  // Nothing is heard on the air, so an ack_join may always have escaped.
  EXPECT_TRUE(failures_of(judge(script.run, options)).empty());
  NetFields fields{.dest = {11, machine::kNullDevid}, .src = {11, 1}, .seq_num = 7, .nbytes = 200};
  script.up(60, fields);
  lose_serial_times(script.run);
  EXPECT_EQ(failures_of(judge(script.run, options)).size(), 1U);
}

// A mote that asks again after 100 ms, on the air; the line has no stamps.
TEST(Times, OfMotesAreJudgedBesideALineWithoutThem) {
  Script script = one_mote();
  script.request(400, 3, 300).request(500, 3, 300);
  lose_serial_times(script.run);
  EXPECT_EQ(failures_of(judge(script.run, Options{})),
            (std::multiset<std::string>{"J8-PERIOD mote 3 9"}));
}

}  // namespace
}  // namespace rubric::check::times_test
