// The --filter of commands that pass packets on.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "codec/reflect/frame.h"
#include "tools/cli/specs.h"
#include "tools/format/filter.h"

namespace rubric::cli {

/// Compiles a --filter. Throws UsageError, which names another spec if that one has the names.
format::Filter filter_of(const std::string& expression, const reflect::Protocol& protocol);

/// Decodes packets and says which of them --filter takes; an empty one takes all.
class FrameFilter {
 public:
  FrameFilter(const std::string& expression, const reflect::Protocol& protocol);

  /// `number` counts the packets of a file from 1.
  bool takes(const Packet& packet, std::string_view interface_name, std::uint64_t number);

 private:
  reflect::FrameDecoder decoder_;
  OtherSpecs others_;
  std::optional<format::Filter> filter_;
  reflect::Frame frame_;
  format::Record record_;
  std::uint64_t index_ = 0;
};

}  // namespace rubric::cli
