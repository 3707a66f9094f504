#include "tools/cli/input_threads.h"

#include <signal.h>

#include <utility>

#include "codec/lines/stop.h"

namespace rubric::cli {
namespace {

/// The most waiting packets: a long file is read no faster than it is judged.
constexpr std::size_t kWaitingMost = 64 * 1024;

}  // namespace

InputThreads::InputThreads(const InputOptions& options) : running_(options.files.size()) {
  // The caller's thread handles signals, which end its waiting.
  sigset_t all;
  sigset_t before;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  try {
    for (std::size_t file = 0; file < options.files.size(); ++file) {
      InputOptions one = options;
      one.files = {options.files[file]};
      one.progress = false;
      threads_.emplace_back([this, one = std::move(one), file] { read(one, file); });
    }
  } catch (...) {  // The system gives no more threads.
    ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
    end();
    throw;
  }
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

InputThreads::~InputThreads() { end(); }

void InputThreads::end() {
  lines::request_stop();
  {
    const std::lock_guard lock(mutex_);
    waiting_.clear();
  }
  taken_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void InputThreads::read(InputOptions options, std::size_t file) {
  bool failed = false;
  std::exception_ptr thrown;
  try {
    failed = read_packets(options, [&](const Packet& packet, const Source& source) {
               keep(packet, source, file);
               return true;
             }).failed;
  } catch (...) {
    thrown = std::current_exception();
  }
  const std::lock_guard lock(mutex_);
  failed_ = failed_ || failed;
  if (thrown) thrown_ = thrown;
  --running_;
  came_.notify_one();
}

void InputThreads::keep(const Packet& packet, const Source& source, std::size_t file) {
  Kept kept{.packet = packet};
  kept.bytes.assign(packet.bytes.begin(), packet.bytes.end());
  kept.comment = packet.comment;
  kept.interface_name = source.interface_name;
  kept.file = file;
  kept.number = source.number;
  std::unique_lock lock(mutex_);
  taken_.wait(lock, [&] { return waiting_.size() < kWaitingMost || lines::stop_requested(); });
  waiting_.push_back(std::move(kept));
  came_.notify_one();
}

bool InputThreads::take(std::chrono::steady_clock::time_point until, const OnPacket& on_packet) {
  std::deque<Kept> now;
  bool running = false;
  {
    std::unique_lock lock(mutex_);
    came_.wait_until(lock, until, [&] { return !waiting_.empty() || running_ == 0; });
    now.swap(waiting_);
    running = running_ > 0;
    if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
  }
  taken_.notify_all();
  for (Kept& kept : now) {
    kept.packet.bytes = Bytes(kept.bytes.data(), kept.bytes.size());
    kept.packet.comment = kept.comment;
    on_packet(kept.packet, kept.file, kept.interface_name, kept.number);
  }
  return running || !now.empty();
}

}  // namespace rubric::cli
