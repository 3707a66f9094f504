// A growing buffer of characters with unchecked writes into capacity that was ensured before.
#pragma once

#include <cassert>
#include <cstddef>
#include <cstring>
#include <memory>
#include <string_view>

namespace rubric::format {

/// Writers take a place with room for their longest output, write without further checks, and
/// commit the end of it.
class Buffer {
 public:
  explicit Buffer(std::size_t capacity = 256 * 1024)
      : data_(std::make_unique_for_overwrite<char[]>(capacity)), capacity_(capacity) {}

  /// Returns where the next `room` characters may be written.
  char* reserve(std::size_t room) {
    if (capacity_ - size_ < room) grow(room);
    reserved_ = size_ + room;
    return data_.get() + size_;
  }
  /// Commits; `end` is one past the last character that was written into the reserved room.
  void commit(const char* end) {
    size_ = static_cast<std::size_t>(end - data_.get());
    assert(size_ <= reserved_);
  }

  void append(std::string_view text) {
    char* at = reserve(text.size());
    if (!text.empty()) std::memcpy(at, text.data(), text.size());
    size_ += text.size();
  }
  void append(char c) {
    *reserve(1) = c;
    ++size_;
  }
  void append(std::size_t count, char c) {
    std::memset(reserve(count), c, count);
    size_ += count;
  }

  std::string_view view() const { return {data_.get(), size_}; }
  std::size_t size() const { return size_; }
  void clear() { size_ = 0; }
  /// Drops everything after the first `size` characters.
  void shrink(std::size_t size) { size_ = size; }

 private:
  void grow(std::size_t room) {
    std::size_t larger = 2 * capacity_;
    while (larger - size_ < room) larger *= 2;
    auto data = std::make_unique_for_overwrite<char[]>(larger);
    std::memcpy(data.get(), data_.get(), size_);
    data_ = std::move(data);
    capacity_ = larger;
  }

  std::unique_ptr<char[]> data_;
  std::size_t capacity_;
  std::size_t size_ = 0;
  std::size_t reserved_ = 0;  // End of the room that was reserved last.
};

}  // namespace rubric::format
