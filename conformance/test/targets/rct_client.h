// The runner's end of one rct/1 conversation: a process, commands, and their answers.
#pragma once

#include <memory>
#include <string>

#include "conformance/test/targets/process.h"
#include "conformance/test/targets/rct_answer.h"

namespace rubric::targets {

/// Once anything throws runner::TargetBroken the process has been killed, and all later calls throw
/// it too. runner::Unsupported does no harm.
class RctClient {
 public:
  RctClient(std::unique_ptr<Process> process, const Options& options)
      : process_(std::move(process)), options_(options) {}
  /// Ends it, if that was not done.
  ~RctClient();

  /// Returns its identity, asking at first.
  const Identity& hello();
  /// Sends a command and returns the answer; `longer` is added to its time limit.
  Answer ask(const Asked& asked, lines::Milliseconds longer = lines::Milliseconds(0));
  /// Returns what is wrong with its answer to a command that does not exist; or nothing.
  std::string honesty();

  /// Kills it: it cannot be believed any more.
  void give_up();
  /// Returns whether it was given up because of a runner::TargetBroken.
  bool broken() const { return broken_; }
  /// Returns what it has done since its last answer, when it should have waited: that it died, or
  /// what it wrote. It is given up then. Empty if it waits, as far as one can see.
  std::string unasked();
  /// Sends `bye`. Several may get it before the first is waited for.
  void say_bye();
  /// Waits for its end, and kills it if it does not go. Returns what was wrong with its end, or
  /// nothing. Gives it up.
  std::string end(lines::Milliseconds grace);
  const Identity& identity() const { return identity_; }
  /// Returns standard error with notes.
  std::string take_stderr();

 private:
  AnswerReader converse(const Asked& asked, lines::Milliseconds timeout);
  void keep_notes(const AnswerReader& reader);

  std::unique_ptr<Process> process_;
  Options options_;
  Identity identity_;
  bool greeted_ = false;
  bool broken_ = false;
  bool said_bye_ = false;
  std::string notes_;  // The first kNotesBytesMax bytes of a case.
  std::uint64_t notes_left_out_ = 0;
};

}  // namespace rubric::targets
