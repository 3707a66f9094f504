// Reads several sources at once.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "tools/cli/input.h"

namespace rubric::cli {

/// Reads every file and line of an InputOptions in a thread of its own, as read_packets() does, so
/// that lines are confirmed however long the handling of a packet takes. Threads end when their
/// sources end, or when the user asks to stop (codec/lines/stop.h).
class InputThreads {
 public:
  explicit InputThreads(const InputOptions& options);
  /// Asks the threads to stop and waits for them.
  ~InputThreads();
  InputThreads(const InputThreads&) = delete;
  InputThreads& operator=(const InputThreads&) = delete;

  /// Takes a packet and its number in its file; `file` is an index into options.files. The packet
  /// is borrowed, as is the interface's name.
  using OnPacket = std::function<void(const Packet&, std::size_t file, std::string_view interface,
                                      std::uint64_t number)>;
  /// Passes on the packets that have come, in order, after waiting for them until then at most.
  /// Returns false when all sources have ended and nothing is left. Throws what threads threw.
  bool take(std::chrono::steady_clock::time_point until, const OnPacket& on_packet);

  /// Returns whether a source could not be opened or read, or broke off. The reason is on stderr.
  bool failed() const { return failed_; }

 private:
  struct Kept {
    Packet packet;
    std::vector<std::uint8_t> bytes;
    std::string comment;
    std::string interface_name;
    std::size_t file = 0;
    std::uint64_t number = 0;
  };

  void read(InputOptions options, std::size_t file);
  void keep(const Packet& packet, const Source& source, std::size_t file);
  void end();

  std::mutex mutex_;
  std::condition_variable came_;
  std::condition_variable taken_;
  std::deque<Kept> waiting_;
  std::size_t running_ = 0;
  bool failed_ = false;
  std::exception_ptr thrown_;
  std::vector<std::thread> threads_;
};

}  // namespace rubric::cli
