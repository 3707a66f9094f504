// What others said and makes no sense, on stderr.
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "codec/lines/time.h"

namespace rubric::run {

/// Says at most one refusal a second, and then how many more there were: anybody may send any
/// number.
class Refusals {
 public:
  /// `who` names the line or the space.
  explicit Refusals(std::string who) : who_(std::move(who)) {}
  Refusals(const Refusals&) = delete;
  Refusals& operator=(const Refusals&) = delete;
  /// Says how many were not said.
  ~Refusals() { finish(); }

  /// Says "refused WHAT".
  void say(std::string_view what);
  /// Says how many were not said, if their second is over.
  void say_rest();

 private:
  void finish();

  const std::string who_;
  lines::SteadyTime said_{};
  int unsaid_ = 0;
};

}  // namespace rubric::run
