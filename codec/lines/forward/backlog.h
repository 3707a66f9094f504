// The bytes for clients, shared by all of them, as long as any may still need them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <vector>

#include "codec/runtime/bytes.h"

namespace rubric::forward {

/// The last bytes of a stream without end, each at its offset from the beginning. One for all
/// clients, so that memory does not depend on how many there are, or on how slow they are.
class Backlog {
 public:
  explicit Backlog(std::size_t size_bytes) : ring_(size_bytes) {}

  std::size_t size_bytes() const { return ring_.size(); }
  std::uint64_t end() const { return end_; }
  /// Returns whether everything from this offset on is still there.
  bool holds(std::uint64_t offset) const { return end_ - offset <= ring_.size(); }

  /// Appends at most size_bytes() at once.
  void append(Bytes bytes) {
    const std::size_t at = place(end_);
    const std::size_t first = std::min(bytes.size(), ring_.size() - at);
    std::memcpy(ring_.data() + at, bytes.data(), first);
    std::memcpy(ring_.data(), bytes.data() + first, bytes.size() - first);
    end_ += bytes.size();
  }

  /// Returns contiguous bytes from `offset` on; there may be more after them. The offset is held,
  /// and not beyond the end.
  Bytes from(std::uint64_t offset) const {
    const std::size_t at = place(offset);
    const auto left = static_cast<std::size_t>(end_ - offset);
    return {ring_.data() + at, std::min(left, ring_.size() - at)};
  }

 private:
  std::size_t place(std::uint64_t offset) const {
    return static_cast<std::size_t>(offset % ring_.size());
  }

  std::vector<std::uint8_t> ring_;
  std::uint64_t end_ = 0;
};

}  // namespace rubric::forward
