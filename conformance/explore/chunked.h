// A list that grows without moving its elements, so that others may read while one appends.
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <memory>

namespace rubric::explore {

/// Appending needs a lock. Reading an element learned of through that lock, or through a barrier
/// after it, needs none.
template <typename T, std::size_t kChunk = 1024, std::size_t kChunks = 16384>
class ChunkedList {
 public:
  std::size_t size() const { return size_; }
  bool full() const { return size_ == kChunk * kChunks; }
  T& operator[](std::size_t i) { return chunks_[i / kChunk][i % kChunk]; }
  const T& operator[](std::size_t i) const { return chunks_[i / kChunk][i % kChunk]; }
  T& push(T value) {
    assert(!full());
    auto& chunk = chunks_[size_ / kChunk];
    if (!chunk) chunk = std::make_unique<T[]>(kChunk);
    return chunk[size_++ % kChunk] = std::move(value);
  }

 private:
  std::array<std::unique_ptr<T[]>, kChunks> chunks_;
  std::size_t size_ = 0;
};

}  // namespace rubric::explore
