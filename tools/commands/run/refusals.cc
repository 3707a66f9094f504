#include "tools/commands/run/refusals.h"

#include <chrono>

#include "codec/text/text.h"

namespace rubric::run {
namespace {

using std::chrono::steady_clock;

constexpr std::chrono::seconds kSayEvery{1};

}  // namespace

void Refusals::say(std::string_view what) {
  const auto now = steady_clock::now();
  if (now - said_ < kSayEvery) {
    ++unsaid_;
    return;
  }
  said_ = now;
  text::print(stderr, "rubric: {}: refused {}\n", who_, what);
}

void Refusals::say_rest() {
  if (steady_clock::now() - said_ >= kSayEvery) finish();
}

void Refusals::finish() {
  if (unsaid_ == 0) return;
  text::print(stderr, "rubric: {}: refused {} more\n", who_, std::exchange(unsaid_, 0));
}

}  // namespace rubric::run
