#include "tools/cli/frame_filter.h"

#include <algorithm>

#include "tools/cli/command.h"

namespace rubric::cli {

format::Filter filter_of(const std::string& expression, const reflect::Protocol& protocol) {
  try {
    return format::Filter(expression, protocol);
  } catch (const format::FilterError& error) {
    const auto works = [&](const reflect::Protocol& other) {
      try {
        format::Filter{expression, other};
        return true;
      } catch (const format::FilterError&) {
        return false;
      }
    };
    const std::string what = error.what() + spec_with(protocol, works);
    const std::string lines = format::FilterError(what, error.position()).explain(expression);
    const std::size_t first = std::min(lines.find('\n'), lines.size());
    throw UsageError("--filter", lines.substr(0, first), lines.substr(first));
  }
}

FrameFilter::FrameFilter(const std::string& expression, const reflect::Protocol& protocol)
    : decoder_(protocol), others_(protocol) {
  if (!expression.empty()) filter_ = filter_of(expression, protocol);
}

bool FrameFilter::takes(const Packet& packet, std::string_view interface_name,
                        std::uint64_t number) {
  if (!filter_) return true;
  decoder_.decode(packet, frame_);
  others_.look(frame_);
  record_.index = index_++;
  record_.number = number;
  record_.frame = &frame_;
  record_.interface_name = interface_name;
  record_.time_ns = packet.time_ns;
  return filter_->matches(record_);
}

}  // namespace rubric::cli
