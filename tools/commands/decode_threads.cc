#include "tools/commands/decode_threads.h"

#include <algorithm>

namespace rubric::tools {
namespace {

// What decodes in some hundred microseconds and stays in a core's cache.
constexpr std::size_t kBatchBytes = 64 * 1024;
constexpr std::size_t kBatchPackets = 1024;
constexpr std::size_t kBatchesMost = 16;  // At once: memory does not grow with the capture.

}  // namespace

void DecodeThreads::Batch::clear() {
  kept.clear();
  bytes.clear();
  names.clear();
  out.clear();
  part = {};
  thrown = nullptr;
}

DecodeThreads::DecodeThreads(std::size_t threads, const std::function<Decode()>& make, Take take)
    : take_(std::move(take)) {
  try {
    for (std::size_t i = 0; i < threads; ++i) {
      threads_.emplace_back([this, decode = make()] { run(decode); });
    }
  } catch (...) {  // The system gives no more threads.
    end();
    throw;
  }
}

DecodeThreads::~DecodeThreads() { end(); }

void DecodeThreads::end() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  came_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

bool DecodeThreads::add(const Packet& packet, const format::Record& record) {
  const std::size_t need = packet.bytes.size() + packet.comment.size();
  const auto full = [&] {
    return filling_->kept.size() == kBatchPackets ||
           filling_->bytes.capacity() - filling_->bytes.size() < need;
  };
  bool wanted = true;
  if (filling_ && full()) wanted = pass_on();
  if (!filling_) begin_batch(need);
  Batch& batch = *filling_;
  Kept& kept = batch.kept.emplace_back(Kept{packet, record});
  kept.packet.bytes = keep(packet.bytes);
  const Bytes comment(reinterpret_cast<const std::uint8_t*>(packet.comment.data()),
                      packet.comment.size());
  kept.packet.comment = {reinterpret_cast<const char*>(keep(comment).data()), comment.size()};
  if (batch.names.empty() || batch.names.back() != record.interface_name) {
    batch.names.emplace_back(record.interface_name);
  }
  kept.record.interface_name = batch.names.back();
  return wanted;
}

Bytes DecodeThreads::keep(Bytes bytes) {
  std::vector<std::uint8_t>& all = filling_->bytes;
  const std::size_t at = all.size();
  all.insert(all.end(), bytes.begin(), bytes.end());
  return Bytes(all.data() + at, bytes.size());
}

void DecodeThreads::begin_batch(std::size_t bytes) {
  {
    const std::lock_guard lock(mutex_);
    if (!free_.empty()) {
      filling_ = std::move(free_.back());
      free_.pop_back();
    }
  }
  if (!filling_) filling_ = std::make_unique<Batch>();
  filling_->bytes.reserve(std::max(kBatchBytes, bytes));
  filling_->kept.reserve(kBatchPackets);
  filling_->place = batches_++;
}

// Hands the batch to the threads. Returns false if no more is wanted.
bool DecodeThreads::pass_on() {
  std::unique_lock lock(mutex_);
  taken_.wait(lock, [this] { return filling_->place < turn_ + kBatchesMost; });
  waiting_.push_back(std::move(filling_));
  came_.notify_one();
  return wanted_;
}

void DecodeThreads::finish() {
  if (filling_) pass_on();
  std::unique_lock lock(mutex_);
  taken_.wait(lock, [this] { return turn_ == batches_; });
  if (thrown_) std::rethrow_exception(thrown_);
}

void DecodeThreads::run(const Decode& decode) {
  std::unique_lock lock(mutex_);
  while (true) {
    came_.wait(lock, [this] { return !waiting_.empty() || ended_; });
    if (waiting_.empty()) return;
    std::unique_ptr<Batch> batch = std::move(waiting_.front());
    waiting_.pop_front();
    const bool wanted = wanted_;
    lock.unlock();
    try {
      for (std::size_t i = 0; wanted && i < batch->kept.size(); ++i) {
        decode(batch->kept[i].packet, batch->kept[i].record, batch->out, batch->part);
      }
    } catch (...) {
      batch->thrown = std::current_exception();
    }
    lock.lock();
    const std::uint64_t place = batch->place;
    decoded_.emplace(place, std::move(batch));
    take_decoded(lock);
  }
}

// Passes on the batches whose turn it is, unless another thread does so: none waits for a turn.
void DecodeThreads::take_decoded(std::unique_lock<std::mutex>& lock) {
  if (taking_) return;
  taking_ = true;
  while (const auto next = decoded_.extract(turn_)) {
    std::unique_ptr<Batch> batch = std::move(next.mapped());
    bool wanted = wanted_ && !batch->thrown;
    if (wanted) {
      lock.unlock();
      try {
        wanted = take_(batch->out, batch->part);
      } catch (...) {
        batch->thrown = std::current_exception();
      }
      lock.lock();
    }
    if (batch->thrown && !thrown_) thrown_ = batch->thrown;
    wanted_ = wanted && !batch->thrown;
    ++turn_;
    taken_.notify_one();
    batch->clear();
    free_.push_back(std::move(batch));
  }
  taking_ = false;
}

}  // namespace rubric::tools
