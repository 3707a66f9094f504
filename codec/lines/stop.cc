#include "codec/lines/stop.h"

#include <atomic>
#include <csignal>
#include <cstdint>
#include <ctime>

namespace rubric::lines {
namespace {

// Lock-free, so good for handlers and threads.
std::atomic<bool> stop = false;
std::atomic<std::int64_t> first_ns = 0;  // Time of the first signal; 0: none yet.

constexpr std::int64_t kSameWishNs = 500'000'000;

// Remembers a signal. `timeout` signals a process and then its group, so that one wish comes as two
// signals.
void remember(int signal) {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  const std::int64_t now_ns = now.tv_sec * std::int64_t{1'000'000'000} + now.tv_nsec;
  std::int64_t before_ns = 0;
  stop = true;
  if (first_ns.compare_exchange_strong(before_ns, now_ns)) return;
  if (now_ns - before_ns < kSameWishNs) return;
  std::signal(signal, SIG_DFL);
  std::raise(signal);  // Once this has returned.
}

}  // namespace

void stop_on_signals() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before {};
    ::sigaction(signal, nullptr, &before);
    if (before.sa_handler == SIG_IGN) continue;
    struct sigaction action {};
    action.sa_handler = remember;
    ::sigemptyset(&action.sa_mask);
    ::sigaction(signal, &action, nullptr);
  }
}

bool stop_requested() { return stop; }

void request_stop() { stop = true; }

}  // namespace rubric::lines
