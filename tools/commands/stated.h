// `--state NAME=VALUE`, which several commands have.
#pragma once

#include <string>
#include <vector>

#include "conformance/trace/events/lines.h"
#include "conformance/trace/parameters.h"
#include "tools/cli/command.h"

namespace rubric::tools {

/// Adds the option, which may be repeated.
inline void add_state_option(cli::Command& command, std::vector<std::string>& stated) {
  command
      .add_option("--state", stated,
                  "State a parameter of the implementation, NAME=VALUE as in ack_timeout=2000; "
                  "repeat for others; names: " +
                      trace::parameter_names())
      .one_at_a_time();
}

/// Throws cli::UsageError.
inline trace::Statement statement_of(const std::vector<std::string>& stated) {
  trace::Statement out;
  for (const std::string& word : stated) {
    const std::string wrong = trace::add_stated(word, out);
    if (!wrong.empty()) throw cli::UsageError("--state", wrong);
  }
  const std::string wrong = events::contradiction(out);
  if (!wrong.empty()) throw cli::UsageError("--state", wrong);
  return out;
}

}  // namespace rubric::tools
