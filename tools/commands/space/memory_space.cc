#include "tools/commands/space/memory_space.h"

#include <algorithm>
#include <utility>

#include "tools/commands/run/wall_clock.h"

namespace rubric::space {

bool matches(std::string_view filter, std::string_view key) {
  while (true) {
    if (filter == "#") return true;
    const std::size_t f = std::min(filter.find('/'), filter.size());
    const std::size_t k = std::min(key.find('/'), key.size());
    const std::string_view word = filter.substr(0, f);
    if (word != "+" && word != key.substr(0, k)) return false;
    const bool filter_ends = f == filter.size();
    const bool key_ends = k == key.size();
    // "a/#" is also "a".
    if (key_ends) return filter_ends || filter.substr(f + 1) == "#";
    if (filter_ends) return false;
    filter.remove_prefix(f + 1);
    key.remove_prefix(k + 1);
  }
}

std::shared_ptr<MemoryBoard::Inbox> MemoryBoard::join() {
  const std::lock_guard lock(mutex_);
  auto inbox = std::make_shared<Inbox>();
  inboxes_.push_back(inbox);
  return inbox;
}

void MemoryBoard::put(Tuple tuple, Space::Stay stay) {
  const std::lock_guard lock(mutex_);
  for (const std::weak_ptr<Inbox>& each : inboxes_) {
    const std::shared_ptr<Inbox> inbox = each.lock();
    if (!inbox) continue;
    const bool wanted =
        std::any_of(inbox->filters.begin(), inbox->filters.end(),
                    [&](const std::string& filter) { return matches(filter, tuple.key); });
    if (wanted) inbox->tuples.push_back(tuple);
  }
  if (stay == Space::Stay::kTuple) tuples_[tuple.key] = std::move(tuple);
}

void MemoryBoard::remove(const std::string& key) {
  const std::lock_guard lock(mutex_);
  tuples_.erase(key);
}

void MemoryBoard::subscribe(Inbox& inbox, const std::string& filter) {
  const std::lock_guard lock(mutex_);
  inbox.filters.push_back(filter);
  for (const auto& [key, tuple] : tuples_) {
    if (!matches(filter, key)) continue;
    inbox.tuples.push_back(tuple);
    inbox.tuples.back().stays = true;
  }
}

std::vector<Tuple> MemoryBoard::take(Inbox& inbox) {
  const std::lock_guard lock(mutex_);
  return std::exchange(inbox.tuples, {});
}

std::int64_t MemorySpace::put(const std::string& key, const std::string& data, Stay stay) {
  const std::int64_t now_ms = run::wall_ms();
  board_->put({key, data, creator_, now_ms, false}, stay);
  return now_ms;
}

}  // namespace rubric::space
