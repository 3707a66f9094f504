// An implementation under test as the suite sees it, wherever it runs: a child process that uses
// rct/1 (PORTING.md), a Serial Forwarder, a serial line, or this very process.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "conformance/test/runner/target.h"
#include "conformance/trace/parameters.h"

namespace rubric::targets {

struct Identity {
  std::string name;
  std::string version;
  std::vector<machine::Role> roles;  ///< The roles that it can play.
  bool real_time = false;            ///< Its clock cannot be turned.
  /// A node at its own line, not behind an adapter: cases that the line cannot decide are no
  /// omission of the node.
  bool own_line = false;
  std::optional<runner::Reach> shown = {};  ///< If it shows a part of its links only.
  trace::Statement stated = {};
};

/// A fault while no case was running.
struct Mishap {
  std::string text;  ///< "was killed by signal 9 (Killed)".
  /// True if it died or wrote something unasked: its earlier output can hardly be believed. Else
  /// only its end did not follow `bye` as it should.
  bool broke = false;
  std::string stderr_text;  ///< Its last words.
  /// The rule that this may break: it was not seen whether it does. Of the whole run, at its end.
  ReqId open = ReqId::kNone;
};

/// For one thread. Destroy its targets before it.
class Attachment {
 public:
  virtual ~Attachment() = default;

  /// Starts it if needed. Throws runner::TargetBroken.
  virtual const Identity& identity() = 0;
  /// Returns the target of one node of one case, to be destroyed when the case is over. A case with
  /// several nodes calls this several times. Restarts a process that broke in an earlier case.
  /// Throws runner::TargetBroken.
  virtual std::unique_ptr<runner::Target> target() = 0;
  /// Sends something that nobody can know and returns what is wrong with the answer; empty if it
  /// was refused, as it must be, or if there is nothing to ask.
  virtual std::string honesty() = 0;
  /// Returns the implementation's standard error since the last call, its last 64 KiB, with the
  /// adapter's notes.
  virtual std::string take_stderr() = 0;
  /// Returns faults since the last call that are no error of a case.
  virtual std::vector<Mishap> take_mishaps() { return {}; }
  /// Ends processes that wait for the next case. Their mishaps can be taken afterwards.
  virtual void finish() {}
};

/// Returns the reference machine's identity.
Identity machine_identity();

struct Options {
  /// Wall-clock limit for the answer to a command, and for opening a line.
  std::chrono::milliseconds step_timeout{5000};
  /// The same for the first command, `hello`, while an interpreter or an emulator starts, and for a
  /// node that connects to us. If that did not come, it has `step_timeout` in the next cases.
  std::chrono::milliseconds start_timeout{20000};
  trace::Statement stated = {};  ///< Counts more than what the implementation states itself.
  /// A command that uses rct/1 for what a line does not show (AppChannel); empty: none.
  std::string app = {};
};

/// Returns whether the target is a command, which runs as a process of its own.
bool is_command(const std::string& target);

/// Opens the target that the user wrote: `machine`, `machine:FLAW` (conformance/machine/flaws),
/// `sf-server:PORT`, `sf:HOST:PORT`, `serial:DEVICE[:BAUD]`, `serial:tcp:HOST:PORT`, the last three
/// perhaps with `:mote` at the end, else a shell command that uses rct/1. Starts nothing yet.
/// Throws std::invalid_argument if the text makes no sense, or has no line for `options.app`.
std::unique_ptr<Attachment> attach(const std::string& target, const Options& options);

}  // namespace rubric::targets
