#include "codec/containers/unit_reader.h"

#include <algorithm>

namespace rubric {

void UnitReader::feed(Bytes chunk, PacketSink sink) {
  for (;;) {
    if (held_.empty()) {
      if (chunk.empty()) return;
      const Step done = step(chunk, sink);
      if (done.used_bytes == 0) {
        held_.assign(chunk.begin(), chunk.end());
        wanted_ = done.wanted_bytes;
        return;
      }
      offset_ += done.used_bytes;
      chunk = chunk.from(done.used_bytes);
      continue;
    }
    if (held_.size() < wanted_) {
      const std::size_t taken = std::min(wanted_ - held_.size(), chunk.size());
      held_.insert(held_.end(), chunk.begin(), chunk.begin() + taken);
      chunk = chunk.from(taken);
      if (held_.size() < wanted_) return;
    }
    const Step done = step(Bytes(held_.data(), held_.size()), sink);
    held_.erase(held_.begin(), held_.begin() + static_cast<std::ptrdiff_t>(done.used_bytes));
    offset_ += done.used_bytes;
    wanted_ = done.wanted_bytes;
  }
}

void UnitReader::finish(PacketSink sink) {
  end(Bytes(held_.data(), held_.size()), sink);
  held_.clear();
  offset_ = 0;
  wanted_ = 0;
}

}  // namespace rubric
