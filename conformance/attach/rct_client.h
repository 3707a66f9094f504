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
  RctClient(std::unique_ptr<Process> process, const Options& options)
      : process_(std::move(process)), options_(options) {}
  /// Ends it, if that was not done.
  ~RctClient();

  /// Asks who it is, at first.
  const Identity& hello();
  /// `longer` is added to the time that an answer may take.
  Answer ask(const Asked& asked, Milliseconds longer = Milliseconds(0));
  /// What is wrong with its answer to a command that there is not; or nothing.
  std::string honesty();

  /// Kills it: it cannot be believed any more.
  void give_up();
  /// It was given up, by whoever threw runner::TargetBroken for it.
  bool broken() const { return broken_; }
  /// What it has done since its last answer, when it was to wait: that it died, or what it wrote.
  /// It is given up then. Empty: it waits, as far as one can see.
  std::string unasked();
  /// Says `bye`. Several may be told before they are waited for.
  void say_bye();
  /// Waits for its end, and kills what does not go. Returns what was wrong with its end, or
  /// nothing. It is given up.
  std::string end(Milliseconds grace);
  const Identity& identity() const { return identity_; }
  /// Of standard error, and its notes.
  std::string take_stderr();

 private:
  AnswerReader converse(const Asked& asked, Milliseconds timeout);
  void keep_notes(const AnswerReader& reader);

  std::unique_ptr<Process> process_;
  Options options_;
  Identity identity_;
  bool greeted_ = false;
  bool broken_ = false;
  bool said_bye_ = false;
  std::string notes_;
};

}  // namespace rubric::attach
