// The runner's end of one rct/1 conversation: a process, what it is asked, and how it answers.
#pragma once

#include <memory>
#include <string>

#include "conformance/attach/process.h"
#include "conformance/attach/rct_answer.h"

namespace rubric::attach {

/// Once anything throws runner::TargetBroken the process has been killed, and whatever is asked
/// afterwards throws it too. runner::Unsupported does no harm.
class RctClient {
 public:
  RctClient(std::unique_ptr<Process> process, Milliseconds step_timeout)
      : process_(std::move(process)), step_timeout_(step_timeout) {}
  /// Says `bye`, and kills what does not go.
  ~RctClient();

  /// Asks who it is, at first.
  const Identity& hello();
  /// `longer` is added to the time that an answer may take.
  Answer ask(const Asked& asked, Milliseconds longer = Milliseconds(0));
  /// What is wrong with its answer to a command that there is not; or nothing.
  std::string honesty();

  /// Kills it: it cannot be believed any more.
  void give_up();
  bool broken() const { return broken_; }
  const Identity& identity() const { return identity_; }
  /// Of standard error, and its notes.
  std::string take_stderr();

 private:
  AnswerReader converse(const Asked& asked, Milliseconds longer);
  void keep_notes(const AnswerReader& reader);

  std::unique_ptr<Process> process_;
  Milliseconds step_timeout_;
  Identity identity_;
  bool greeted_ = false;
  bool broken_ = false;
  std::string notes_;
};

}  // namespace rubric::attach
