// What tests of processes need: whether others live.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <fstream>
#include <string>
#include <thread>

#include <fmt/format.h>

namespace rubric::attach {

/// Gone, or dead and not yet waited for by whoever inherited it.
inline bool is_dead(pid_t pid) {
  std::ifstream file(fmt::format("/proc/{}/stat", pid));
  std::string word;
  std::string state;
  return !(file >> word >> word >> state) || state == "Z";
}

/// Whether it comes true in a time that nothing here takes, however busy the host is.
template <class Condition>
bool comes(Condition condition) {
  using Clock = std::chrono::steady_clock;
  for (const auto end = Clock::now() + std::chrono::seconds(20); Clock::now() < end;) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return false;
}

}  // namespace rubric::attach
