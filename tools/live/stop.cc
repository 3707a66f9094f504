#include "tools/live/stop.h"

#include <atomic>
#include <csignal>
#include <initializer_list>

namespace rubric::live {
namespace {

std::atomic<bool> stop = false;  // Lock-free, so good for handlers and threads.

void remember(int) { stop = true; }

}  // namespace

void stop_on_signals() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before {};
    ::sigaction(signal, nullptr, &before);
    if (before.sa_handler == SIG_IGN) continue;
    struct sigaction action {};
    action.sa_handler = remember;
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    ::sigemptyset(&action.sa_mask);
    ::sigaction(signal, &action, nullptr);
  }
}

bool stop_requested() { return stop; }

void request_stop() { stop = true; }

}  // namespace rubric::live
