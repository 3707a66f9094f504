// Storage for what a Run's observations point to: payloads, names, calls and notices, at stable
// addresses.
#pragma once

#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "codec/runtime/bytes.h"
#include "conformance/machine/event.h"

namespace rubric::check {

struct RunStorage {
  /// Returns a copy that lives as long as this.
  Bytes keep(Bytes bytes);
  std::string_view keep(std::string_view text);

  std::deque<machine::Call> calls;
  std::deque<machine::Notice> notices;
  std::vector<std::shared_ptr<const void>> owned;  ///< Calls and notices borrow from these.

 private:
  static constexpr std::size_t kBlockBytes = 256 * 1024;
  std::vector<std::unique_ptr<std::uint8_t[]>> blocks_;
  std::size_t used_ = kBlockBytes;
  std::deque<std::string> texts_;
};

}  // namespace rubric::check
