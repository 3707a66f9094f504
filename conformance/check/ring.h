// A ring that keeps the last things pushed.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace rubric::check {

/// Holds the last kRoom things that were pushed, or more by make_room(), and forgets older ones.
/// Allocates with the first one.
template <typename T, std::size_t kRoom>
class Ring {
  static_assert(std::has_single_bit(kRoom));  // So that an index wraps by a mask.

 public:
  /// The most that make_room() keeps.
  static constexpr std::size_t kMost = 4096;

  std::size_t size() const { return count_; }
  /// Returns whether the next push forgets the oldest.
  bool full() const { return count_ > 0 && count_ == items_.size(); }
  /// Returns the i-th newest; i < size().
  T& newest(std::size_t i) { return items_[wrapped(next_ - 1 - i)]; }
  const T& newest(std::size_t i) const { return items_[wrapped(next_ - 1 - i)]; }
  /// Returns the i-th oldest; i < size().
  T& oldest(std::size_t i) { return newest(count_ - 1 - i); }
  /// Returns how many of the newest have another key, if all were pushed with one.
  std::size_t newer_than(std::uint16_t key) const {
    return count_ == 0 ? 0 : std::min(count_, pushed_ - last_[key % kKeys]);
  }
  T& push(const T& item, std::uint16_t key) {
    if (last_.empty()) last_.resize(kKeys);
    last_[key % kKeys] = ++pushed_;
    return push(item);
  }
  T& push(const T& item) {
    if (items_.empty()) items_.resize(kRoom);
    T& place = items_[next_];
    place = item;
    next_ = wrapped(next_ + 1);
    if (count_ < items_.size()) ++count_;
    return place;
  }
  /// Makes room for a push: of more than kRoom things the oldest is forgotten, which `forget` is
  /// told, unless it is still `needed` and there are fewer than kMost.
  template <typename Needed, typename Forget>
  void make_room(Needed needed, Forget forget) {
    while (count_ >= kRoom && (count_ >= kMost || !needed(oldest(0)))) {
      forget(oldest(0));
      --count_;
    }
    if (full()) grow();
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
  static constexpr std::size_t kKeys = 512;
  std::size_t wrapped(std::size_t i) const { return i & (items_.size() - 1); }
  void grow() {
    std::rotate(items_.begin(), items_.begin() + static_cast<std::ptrdiff_t>(next_), items_.end());
    next_ = count_;
    items_.resize(2 * count_);
  }

  std::vector<T> items_;
  std::size_t next_ = 0;
  std::size_t count_ = 0;
  std::size_t pushed_ = 0;         // With a key.
  std::vector<std::size_t> last_;  // What pushed_ was after the last with a key like this.
};

}  // namespace rubric::check
