// TCP within this machine, on whatever port is free.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>

namespace rubric::firmware {

/// A port of 127.0.0.1 at which connections are awaited.
class LoopbackPort {
 public:
  /// Throws BoardBroken if there is none.
  LoopbackPort();
  ~LoopbackPort();
  LoopbackPort(const LoopbackPort&) = delete;
  LoopbackPort& operator=(const LoopbackPort&) = delete;

  std::uint16_t port() const { return port_; }
  /// Returns the next connection, which the caller closes; -1 if none came within `wait`.
  int accept(std::chrono::milliseconds wait) const;
  /// Does the same, but calls `is_hopeless` often and ends at once when it returns true.
  int accept(std::chrono::milliseconds wait, const std::function<bool()>& is_hopeless) const;

 private:
  int listener_ = -1;
  std::uint16_t port_ = 0;
};

}  // namespace rubric::firmware
