#include "codec/containers/unit_reader.h"

#include <algorithm>

namespace rubric {

void UnitReader::feed(Bytes chunk, PacketSink sink) {
  for (;;) {
    if (held().empty()) {
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
    if (held().size() < wanted_) {
      const std::size_t taken = std::min(wanted_ - held().size(), chunk.size());
      held_.insert(held_.end(), chunk.begin(), chunk.begin() + taken);
      chunk = chunk.from(taken);
      if (held().size() < wanted_) return;
    }
    const Step done = step(held(), sink);
    drop_held(done.used_bytes);
    offset_ += done.used_bytes;
    wanted_ = done.wanted_bytes;
  }
}

// Moves the rest to the front only if it is no larger than the dropped part: tiny steps must not
// cost a move each.
void UnitReader::drop_held(std::size_t bytes) {
  held_begin_ += bytes;
  if (held_begin_ < held_.size() - held_begin_) return;
  held_.erase(held_.begin(), held_.begin() + static_cast<std::ptrdiff_t>(held_begin_));
  held_begin_ = 0;
}

void UnitReader::finish(PacketSink sink) {
  end(held(), sink);
  held_.clear();
  held_begin_ = 0;
  offset_ = 0;
  wanted_ = 0;
}

}  // namespace rubric
