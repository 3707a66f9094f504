// Containers of fixed room, without a heap; two are equal if their contents are.
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>

namespace rubric::machine {

/// A circular buffer, oldest first.
template <typename T, std::size_t kRoom>
class BoundedQueue {
 public:
  bool empty() const { return count_ == 0; }
  bool full() const { return count_ == kRoom; }
  std::size_t size() const { return count_; }
  static constexpr std::size_t room() { return kRoom; }
  /// Returns the i-th oldest; i < size().
  T& operator[](std::size_t i) { return items_[(head_ + i) % kRoom]; }
  const T& operator[](std::size_t i) const { return items_[(head_ + i) % kRoom]; }
  T& front() { return items_[head_]; }
  const T& front() const { return items_[head_]; }
  /// Appends a place to be filled; not when full().
  T& push() {
    assert(!full());
    return items_[(head_ + count_++) % kRoom];
  }
  void pop() {
    assert(!empty());
    head_ = static_cast<std::uint8_t>((head_ + 1) % kRoom);
    --count_;
  }
  /// Removes the i-th oldest; the others keep their order.
  void erase(std::size_t i) {
    assert(i < count_);
    for (std::size_t k = i + 1; k < count_; ++k) (*this)[k - 1] = (*this)[k];
    --count_;
  }
  void clear() { head_ = count_ = 0; }
  friend bool operator==(const BoundedQueue& a, const BoundedQueue& b) {
    if (a.count_ != b.count_) return false;
    for (std::size_t i = 0; i < a.count_; ++i) {
      if (!(a[i] == b[i])) return false;
    }
    return true;
  }

 private:
  std::array<T, kRoom> items_;
  std::uint8_t head_ = 0;
  std::uint8_t count_ = 0;
};

/// A list in order of arrival.
template <typename T, std::size_t kRoom>
class BoundedList {
 public:
  bool empty() const { return count_ == 0; }
  bool full() const { return count_ == kRoom; }
  std::size_t size() const { return count_; }
  T* begin() { return items_.data(); }
  T* end() { return items_.data() + count_; }
  const T* begin() const { return items_.data(); }
  const T* end() const { return items_.data() + count_; }
  T& operator[](std::size_t i) { return items_[i]; }
  const T& operator[](std::size_t i) const { return items_[i]; }
  T& push(const T& value) {
    assert(!full());
    return items_[count_++] = value;
  }
  void erase(std::size_t i) {
    assert(i < count_);
    for (std::size_t k = i + 1; k < count_; ++k) items_[k - 1] = items_[k];
    --count_;
  }
  void clear() { count_ = 0; }
  friend bool operator==(const BoundedList& a, const BoundedList& b) {
    if (a.count_ != b.count_) return false;
    for (std::size_t i = 0; i < a.count_; ++i) {
      if (!(a.items_[i] == b.items_[i])) return false;
    }
    return true;
  }

 private:
  std::array<T, kRoom> items_;
  std::uint8_t count_ = 0;
};

}  // namespace rubric::machine
