// Options under which tests judge lawful traffic.
#pragma once

#include "conformance/check/observation.h"
#include "conformance/check/tests/frames_testing.h"
#include "conformance/selftest/lawful_traffic/traffic.h"

namespace rubric::check {

/// Returns the options that hold for any recording of the traffic: its statements and its testers.
inline Options options_of(const lawful::Traffic& traffic) {
  Options options{.stated = stated_by(traffic.stated)};
  for (const lawful::NodeInfo& node : traffic.nodes) {
    if (node.role == lawful::Role::kTester) options.testers.push_back(node.id);
  }
  // A host that sends malformed messages on purpose is the tester.
  if (!traffic.all_well_formed) options.testers.push_back(0);
  return options;
}

/// Returns the options of all that was recorded: also whether that is complete and from the start.
inline Options options_of_whole(const lawful::Traffic& traffic) {
  Options options = options_of(traffic);
  options.sniffer_complete = traffic.sniffer_complete;
  options.start_cold = traffic.cold_start;
  return options;
}

}  // namespace rubric::check
