// Implementations in this process, for tests of the suite.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "conformance/test/runner/subject_target.h"
#include "conformance/test/suite/run.h"
#include "conformance/test/targets/attachment.h"

namespace rubric::suite::testing {

/// Makes the machine as a target that a test may change.
using Wrap = std::function<std::unique_ptr<runner::Target>()>;

inline std::unique_ptr<runner::Target> machine_target() {
  return std::make_unique<runner::SubjectTarget>(std::make_unique<runner::Machine>());
}

class FakeAttachment : public targets::Attachment {
 public:
  targets::Identity who = targets::machine_identity();
  Wrap make = machine_target;
  std::string honest;  ///< Returned by honesty().
  std::string says;    ///< To its standard error, at each target.
  bool starts = true;
  int* targets = nullptr;  ///< Counts.

  const targets::Identity& identity() override {
    if (!starts) throw runner::TargetBroken("no such program");
    return who;
  }
  std::unique_ptr<runner::Target> target() override {
    if (targets) ++*targets;
    stderr_ += says;
    return make();
  }
  std::string honesty() override { return honest; }
  std::string take_stderr() override { return std::exchange(stderr_, {}); }
  std::vector<targets::Mishap> take_mishaps() override { return std::exchange(mishaps, {}); }
  void finish() override { mishaps.insert(mishaps.end(), last.begin(), last.end()); }

  std::vector<targets::Mishap> mishaps;  ///< Until now.
  std::vector<targets::Mishap> last;     ///< At its end.

 private:
  std::string stderr_;
};

/// Emits a fixed output, whatever it is given.
class Parrot : public runner::SubjectTarget {
 public:
  explicit Parrot(std::vector<runner::Output> says)
      : SubjectTarget(std::make_unique<runner::Machine>()), says_(std::move(says)) {}
  const std::vector<runner::Output>& outputs() const override { return says_; }

 private:
  std::vector<runner::Output> says_;
};

/// Breaks when it is given something.
class Breaking : public runner::SubjectTarget {
 public:
  Breaking() : SubjectTarget(std::make_unique<runner::Machine>()) {}
  void give(runner::Ticks, const machine::Event&) override {
    throw runner::TargetBroken("killed by signal 11");
  }
};

}  // namespace rubric::suite::testing
