// A ring that keeps the last things pushed.
#pragma once

#include <cstddef>
#include <vector>

namespace rubric::check {

/// Holds the last `kRoom` things that were pushed and forgets older ones. Allocates with the first
/// one.
template <typename T, std::size_t kRoom>
class Ring {
 public:
  std::size_t size() const { return count_; }
  bool full() const { return count_ == kRoom; }
  /// Returns the i-th newest; i < size().
  T& newest(std::size_t i) { return items_[(next_ + kRoom - 1 - i) % kRoom]; }
  const T& newest(std::size_t i) const { return items_[(next_ + kRoom - 1 - i) % kRoom]; }
  /// Returns the i-th oldest; i < size().
  T& oldest(std::size_t i) { return items_[(next_ + kRoom - count_ + i) % kRoom]; }
  T& push(const T& item) {
    if (items_.empty()) items_.resize(kRoom);
    T& place = items_[next_];
    place = item;
    next_ = (next_ + 1) % kRoom;
    if (count_ < kRoom) ++count_;
    return place;
  }
  void clear() { count_ = 0; }
  /// Forgets the newest that `keeps` refuses, and all older ones.
  template <typename Keeps>
  void keep_newest(Keeps keeps) {
    std::size_t kept = 0;
    while (kept < count_ && keeps(newest(kept))) ++kept;
    count_ = kept;
  }

 private:
  std::vector<T> items_;
  std::size_t next_ = 0;
  std::size_t count_ = 0;
};

}  // namespace rubric::check
