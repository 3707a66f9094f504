// Logs made by hand, for tests: frames that nodes were given and sent, line by line.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "codec/reflect/requirements.h"
#include "conformance/check/input/read.h"
#include "conformance/check/judge/judge.h"

namespace rubric::check {

inline Report judge_log(const std::string& log, bool sniffer_complete = false) {
  RunReader reader;
  std::string error;
  EXPECT_TRUE(reader.add_bytes("log", log, error)) << error;
  const check::Run run = reader.finish();
  Options options;
  options.start_cold = true;
  options.sniffer_complete = sniffer_complete;
  return judge(run, options);
}

/// Returns the rules that are found, in order, with a severity of at least `least`.
inline std::string found(const std::string& log, Severity least) {
  std::string out;
  for (const Finding& finding : judge_log(log).findings) {
    if (finding.severity < least) continue;
    out += std::string(out.empty() ? "" : " ") + reflect::requirement(finding.requirement).id;
  }
  return out;
}

/// Returns one line at so many ms.
inline std::string at(int ms, const std::string& rest) {
  return "   @" + std::to_string(ms) + " " + rest + "\n";
}

}  // namespace rubric::check
