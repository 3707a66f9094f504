// The set of visited states, by their keys (sites.h): eight bytes a place.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>

namespace rubric::explore {

/// Returns the memory that the process has in use, 0 if the system does not say.
std::size_t process_bytes();

/// Open addressing; several threads insert at once without locks. It grows between batches, not
/// during one.
class Visited {
 public:
  Visited() { allocate(std::size_t{1} << 18); }

  /// Makes room for so many more. No thread may insert meanwhile.
  void reserve(std::size_t more);
  /// Returns how many more fit without growing.
  std::size_t room() const;
  /// Prefetches the place of a key, for an insert soon.
  void prefetch(std::uint64_t key) const { __builtin_prefetch(&slots_[key & mask_], 1, 1); }
  /// Inserts `key`, which is not 0. Returns true if it is new.
  bool insert(std::uint64_t key) {
    for (std::size_t i = key & mask_;; i = (i + 1) & mask_) {
      std::uint64_t there = slots_[i].load(std::memory_order_relaxed);
      if (there == key) return false;
      if (there != 0) continue;
      if (slots_[i].compare_exchange_strong(there, key, std::memory_order_relaxed)) return true;
      if (there == key) return false;
    }
  }
  /// Counts inserted states after a batch, since counting each would cost more than inserting.
  void add_to_size(std::size_t inserted) { size_ += inserted; }
  std::size_t size() const { return size_; }
  std::size_t memory_bytes() const { return (mask_ + 1) * sizeof(std::uint64_t); }

 private:
  struct Release {
    std::size_t bytes;
    void operator()(std::atomic<std::uint64_t>* slots) const;
  };
  void allocate(std::size_t slots);

  std::unique_ptr<std::atomic<std::uint64_t>[], Release> slots_ {
    nullptr, Release { 0 }
  };
  std::size_t mask_ = 0;
  std::size_t size_ = 0;
};

}  // namespace rubric::explore
