// Logs made by hand, for tests: frames that nodes were given and sent, line by line.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "conformance/check/observation.h"
#include "conformance/check/tests/failures.h"
#include "conformance/check/tests/must_read.h"
#include "conformance/check/tests/testing.h"

namespace rubric::check {

/// Judges by the profile that the log's header names.
inline Report judge_log(const std::string& log, bool sniffer_complete = false) {
  const check::Run run = must_read("log", log);
  Options options{.sniffer_complete = sniffer_complete, .start_cold = true};
  options.deployed = log.find("%profile deployed") != log.npos;
  return judge(run, options);
}

/// Returns the rules that are found, in order, with a severity of at least `least`.
inline std::string found(const std::string& log, Severity least) {
  return rules_of(judge_log(log).findings, least);
}

/// Returns one line at so many ms.
inline std::string at(int ms, const std::string& rest) {
  return "   @" + std::to_string(ms) + " " + rest + "\n";
}
inline std::string m2(int ms, const std::string& rest) { return at(ms, "m2 " + rest); }

/// Returns the same as found_in() of what the script captures beside lines of a node's application.
inline std::string found_beside(Script script, const std::string& lines, bool complete = false,
                                const std::string& node = "m2 mote id=2") {
  const Run log = must_read(
      "log", "%rtr 1  %profile paper  %tick ms\n%node " + node + "\n\ncase log\n" + lines);
  Run& run = script.run;
  for (Observation seen : log.seen) {
    seen.place.file = 1;
    seen.place.time_us += log.begin_us;
    run.seen.push_back(seen);
  }
  std::ranges::stable_sort(run.seen, {},
                           [](const Observation& seen) { return seen.place.time_us; });
  run.files.push_back("log");
  run.nodes = log.nodes;
  run.nodes[0].file = 1;
  return found_in(script, complete);
}

/// A log in which mote 2 has joined the sink of island 11; what follows comes from 12 ms on.
inline constexpr const char* kJoined = R"(%rtr 1  %profile paper  %tick ms
%node m2 mote id=2
%node m3 mote id=3
%node sA sink id=1 island=11

case log
   @0 m2 < app join(type=1 transducers=1 actuators=1)
   @1 m2 > rA am=2->1 join_request(seq_num=5 mote_type=1 transducers=1 actuators=1)
   @2 sA < rA am=2->1 join_request(seq_num=5 mote_type=1 transducers=1 actuators=1)
   @5 sA > rA am=1->2 join_reply(island_addr=11 mote_addr=2 cur_time=5 seq_num=5)
   @7 m2 < rA am=1->2 join_reply(island_addr=11 mote_addr=2 cur_time=5 seq_num=5)
   @9 m2 > rA am=2->1 ack_join(dest=11:1 src=11:2 seq_num=5 mote_type=1 transducers=1 actuators=1)
   @9 m2 > app joined(11:2 success)
   @11 sA < rA am=2->1 ack_join(dest=11:1 src=11:2 seq_num=5 mote_type=1 transducers=1 actuators=1)
   @11 sA > app mote_joined(11:2 type=1 transducers=1 actuators=1)
)";

}  // namespace rubric::check
