#include "tools/live/stop.h"

#include <csignal>
#include <initializer_list>

namespace rubric::live {
namespace {

volatile std::sig_atomic_t stop = 0;

void remember(int) { stop = 1; }

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

bool stop_requested() { return stop != 0; }

void request_stop() { stop = 1; }

}  // namespace rubric::live
