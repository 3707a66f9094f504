// An implementation under test as the suite sees it, wherever it runs: a child process that speaks
// rct/1 (PORTING.md), a Serial Forwarder, a serial line, or this very process.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "conformance/runner/target.h"

namespace rubric::attach {

struct Identity {
  std::string name;
  std::string version;
  std::vector<machine::Role> roles;  ///< That it can play.
  bool real_time = false;            ///< Its clock cannot be turned.
};

/// What went wrong while no case was at work.
struct Mishap {
  std::string text;         ///< "was killed by signal 9 (Killed)".
  /// It died or spoke when nobody had asked: what it said before can hardly be believed. Else only
  /// its end was none as `bye` asks for.
  bool broke = false;
  std::string stderr_text;  ///< Its last words.
};

/// For one thread. Targets must be gone before it.
class Attachment {
 public:
  virtual ~Attachment() = default;

  /// Starts it if need be. Throws runner::TargetBroken.
  virtual const Identity& identity() = 0;
  /// The target of one node of one case, to be destroyed when the case is over. A case with several
  /// nodes asks for several at once. What broke in an earlier case is started anew. Throws
  /// runner::TargetBroken.
  virtual std::unique_ptr<runner::Target> target() = 0;
  /// Sends something that nobody can know and returns what is wrong with the answer; empty: it was
  /// refused, as it must be. Nothing to ask, nothing wrong.
  virtual std::string honesty() = 0;
  /// What the implementation wrote to its standard error since the last call, its last 64 KiB; the
  /// notes of an adapter are among it.
  virtual std::string take_stderr() = 0;
  /// What has gone wrong since the last call without being an error of a case.
  virtual std::vector<Mishap> take_mishaps() { return {}; }
  /// Ends what waits for the next case. Its mishaps can be taken afterwards.
  virtual void finish() {}
};

/// Who the reference machine says that it is.
Identity machine_identity();

struct Options {
  /// Wall-clock time for the answer to a command, and until a line is open.
  std::chrono::milliseconds step_timeout{5000};
  /// The same for the first one, `hello`, while an interpreter or an emulator starts, and for a
  /// node that comes to us.
  std::chrono::milliseconds start_timeout{20000};
};

/// By what the user wrote: `machine`, `machine:FLAW` (conformance/flaws), `sf-server:PORT`,
/// `sf:HOST:PORT`, `serial:DEVICE[:BAUD]`, `serial:tcp:HOST:PORT`, the last three also with `:mote`
/// at their end, else a shell command that speaks rct/1. Starts nothing yet. Throws
/// std::invalid_argument where the text makes no sense.
std::unique_ptr<Attachment> attach(const std::string& target, const Options& options);

}  // namespace rubric::attach
