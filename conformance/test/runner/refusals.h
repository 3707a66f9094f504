// Messages that the call `send` refused although the trace goes on with their numbers.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "conformance/test/runner/expectation.h"
#include "conformance/test/runner/run_case.h"
#include "conformance/trace/match.h"
#include "conformance/trace/protocol.h"

namespace rubric::runner {

class Refusals {
 public:
  /// Keeps the variables that a line has bound to the error value of send.
  void note(const trace::Line& line, Ticks time, const trace::Bindings& bindings) {
    constexpr std::int64_t kRefused = 0xFFFF;
    if (!trace::protocol().has_machine || line.message.name != "send_result") return;
    for (const std::string& name : variables_of(line)) {
      if (*bindings.find(name) == trace::Value::of(kRefused)) {
        by_name_[name] = {line.requirements, time};
      }
    }
  }

  /// Blames a line that was not kept since its message was refused: for that rule, not for its own.
  void blame(const trace::Line& line, Failure& failure) const {
    for (const std::string& name : variables_of(line)) {
      const auto refused = by_name_.find(name);
      if (refused == by_name_.end() || failure.weak) continue;
      const Refusal& refusal = refused->second;
      failure.requirements =
          refusal.rules.empty() ? std::vector<std::string>{"N1-ROOM"} : refusal.rules;
      failure.suspected.clear();
      failure.text = fmt::format("send refused it: send_result(65535) at {}", refusal.time);
      failure.broken_at = refusal.time;
    }
  }

 private:
  struct Refusal {
    std::vector<std::string> rules;
    Ticks time = 0;
  };
  std::map<std::string, Refusal, std::less<>> by_name_;
};

}  // namespace rubric::runner
