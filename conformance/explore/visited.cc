#include "conformance/explore/visited.h"

#include <sys/mman.h>
#include <unistd.h>

#include <fstream>
#include <new>
#include <utility>

namespace rubric::explore {
namespace {

constexpr std::size_t kFullPercent = 60;

}  // namespace

void Visited::Release::operator()(std::atomic<std::uint64_t>* slots) const {
  if (slots != nullptr) munmap(slots, bytes);
}

// Allocates zeroed memory from the system, in large pages if there are any.
void Visited::allocate(std::size_t slots) {
  const std::size_t bytes = slots * sizeof(std::uint64_t);
  void* const memory =
      mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  madvise(memory, bytes, MADV_HUGEPAGE);
  slots_ = {static_cast<std::atomic<std::uint64_t>*>(memory), Release{bytes}};
  mask_ = slots - 1;
}

std::size_t Visited::room() const {
  const std::size_t most = (mask_ + 1) / 100 * kFullPercent;
  return most > size_ ? most - size_ : 0;
}

void Visited::reserve(std::size_t more) {
  while (room() < more) {
    const auto old = std::move(slots_);
    const std::size_t old_slots = mask_ + 1;
    allocate(2 * old_slots);
    for (std::size_t i = 0; i < old_slots; ++i) {
      const std::uint64_t key = old[i].load(std::memory_order_relaxed);
      if (key != 0) insert(key);
    }
  }
}

std::size_t process_bytes() {
  std::ifstream statm("/proc/self/statm");
  std::size_t size = 0;
  std::size_t resident = 0;
  if (!(statm >> size >> resident)) return 0;
  return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace rubric::explore
