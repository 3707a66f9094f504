// Helpers for tests of processes: whether others are alive.
#pragma once

#include <fmt/format.h>
#include <sys/types.h>

#include <chrono>
#include <fstream>
#include <string>
#include <thread>

namespace rubric::targets {

/// Returns whether it is gone, or dead and not yet reaped by its new parent.
inline bool is_dead(pid_t pid) {
  std::ifstream file(fmt::format("/proc/{}/stat", pid));
  std::string word;
  std::string state;
  return !(file >> word >> word >> state) || state == "Z";
}

/// Returns whether the condition comes true in a time that is ample on any busy host.
template <class Condition>
bool comes(Condition condition) {
  using Clock = std::chrono::steady_clock;
  for (const auto end = Clock::now() + std::chrono::seconds(20); Clock::now() < end;) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return false;
}

}  // namespace rubric::targets
