// The adapter's end of rct/1, for any implementation that is a runner::Target.
#pragma once

#include <cstdio>
#include <string>
#include <string_view>

#include "conformance/test/targets/attachment.h"

namespace rubric::targets {

/// Answers commands one at a time.
class Server {
 public:
  /// Makes the target's frames wait for `linkack` commands.
  Server(runner::Target& target, const Identity& identity) : target_(target), identity_(identity) {}

  /// Returns the lines of the answer, each with its line feed; empty after `bye`.
  std::string answer(std::string_view command);
  bool ended() const { return ended_; }

 private:
  std::string hello(std::string_view words);
  std::string reset(std::string_view words);
  std::string event(std::string_view word, std::string_view words);
  std::string until(std::string_view words);
  std::string done(runner::Ticks time);

  runner::Target& target_;
  Identity identity_;
  bool started_ = false;
  bool ended_ = false;
  std::size_t outputs_sent_ = 0;
};

/// Answers until `bye` or the end of `in`. Returns the exit status: 0 after `bye`.
int serve(runner::Target& target, const Identity& identity, std::FILE* in, std::FILE* out);

}  // namespace rubric::targets
