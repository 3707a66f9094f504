// A node under test in a case: its target, the outputs so far, and which of them a line has taken.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "conformance/test/runner/blame.h"
#include "conformance/test/runner/expectation.h"
#include "conformance/test/runner/output_index.h"
#include "conformance/test/runner/target.h"
#include "conformance/trace/concrete.h"

namespace rubric::runner {

struct LoggedLine {
  Ticks time = 0;
  std::string text;
};

/// How long a missing output is awaited beyond its time.
constexpr Ticks kLateTicks = 1500;

/// How the closest output missed a line: one of the same message in its window, or the very output
/// too early or too late.
struct NearestMiss {
  std::string text;
  Evidence evidence;
  std::optional<Ticks> time = {};       ///< When it came, if it came in the window and differs.
  std::optional<Ticks> elsewhere = {};  ///< When it came, if that was not in the window.
};

/// An output with bytes after the content of a message that has one size only.
struct Overlong {
  const Output* output = nullptr;
  const trace::Line* line = nullptr;  // That took it, or null.
  ReqId rule = ReqId::kNone;
  std::size_t excess = 0;
};

class NodeLog {
 public:
  NodeLog(const trace::Scope& scope, const trace::Case& one, const trace::NodeHeader& header,
          std::unique_ptr<Target> target);

  const std::string& name() const { return name_; }
  Target& target() { return *target_; }
  const Target& target() const { return *target_; }
  const std::vector<LoggedLine>& log() const { return log_; }

  Ticks run_until(Ticks time);
  /// Runs a `<` line. Returns when it was given. Throws trace::TraceError.
  Window give(const trace::Line& line, Ticks now, const trace::Scope& scope,
              const trace::Bindings& bindings);
  /// Takes the output that fits a `>` line, and binds its variables. Returns null if there is none
  /// so far. Outputs of a link are taken in their order, but for what timers of their own cause.
  const Output* take(const trace::Line& line, const Window& window, trace::Bindings& bindings);
  /// Lets a `?>` line take the first output in its window that no line has taken, in whatever
  /// order.
  void allow(const trace::Line& line, const Window& window, const trace::Bindings& bindings);
  /// Returns the first output that breaks a `!>` line, or null.
  const Output* forbidden(const trace::Line& line, const Window& window,
                          const trace::Bindings& bindings);
  /// Explains why no output was taken. Where many come in the window that have the name of its
  /// message, the first ones tell how they differ. The very output counts outside of the window
  /// from the message on that the node was given last before it, and for kLateTicks after it.
  NearestMiss nearest_miss(const trace::Line& line, const Window& window,
                           const trace::Bindings& bindings);
  /// Returns the outputs that are longer than their message, the first of each rule that gives
  /// its size.
  std::vector<Overlong> overlong() const;
  std::string text_of(const Output& output) const;
  Evidence evidence_of(const Output& output);
  /// Returns the kind of message that the output answers: its name, whether it is reliable, its
  /// TRANSID, and whether it is for all or another node. An ack names its message; anything else
  /// answers what was given last, at most `response` ticks before. Empty if there is none.
  std::string prompt_of(const Output& output, std::int64_t response) const;

  int link_acks_to_come = 0;

 private:
  // An output without its message: that is decoded anew where it is needed.
  struct Seen {
    std::string name;
    std::string_view link;
    ReqId size_rule = ReqId::kNone;  // As in trace::Concrete.
    std::size_t excess = 0;
    std::size_t order = 0;               // What is in one order has the same number here.
    std::size_t prompts = 0;             // So many were given before.
    bool foreign = false;                // `*` does not mean it.
    const trace::Line* taken = nullptr;  // By this line, if by any.
  };
  // A message that the node was given, and may answer.
  struct Prompt {
    Ticks time = 0;
    std::string kind;     // As prompt_of() returns it.
    trace::Value src;     // For an ack of it.
    trace::Value number;  // So is this.
  };
  // The outputs from one to before another.
  struct Span {
    std::size_t begin = 0;
    std::size_t end = 0;
    bool has_many() const { return begin + 32 < end; }
  };
  /// Returns whether the line can be about this output: by its link, and as a message of the
  /// protocol where it says `*`.
  static bool is_about(const trace::Line& line, const Seen& seen);
  /// Notes when the last line of the log was given.
  Window given(Ticks now, trace::Line line);
  /// Notes a frame or a call that the node was given.
  void note_prompt(Ticks time, const trace::Message& message);
  /// Returns the message that the output acks, or null.
  const Prompt* acked(std::size_t place) const;
  /// Returns the message of an output, until that of another is asked for.
  const trace::Concrete& message_at(std::size_t place) const;
  /// Returns the outputs that may be in the window.
  Span in_window(const Window& window) const;
  /// Returns the first output of the span that no line has taken, that `line` can be about in this
  /// window, and that passes `test`; null if there is none. Of many outputs it looks at those that
  /// `find` returns.
  template <class Find, class Test>
  const Output* first(const trace::Line& line, const Window& window, Span span, Find find,
                      Test test);
  /// Returns the first output in the window that no line has taken and that the line matches, or
  /// null; `in_turn`: of those whose turn it is.
  const Output* matching(const trace::Line& line, const Window& window,
                         const trace::Bindings& bindings, bool in_turn);
  /// Returns the very output that the line asks for, too early or too late, or null.
  const Output* too_early_or_late(const trace::Line& line, const Window& window,
                                  const trace::Bindings& bindings);
  void take(const Output& output, const trace::Line& line);
  std::size_t place_of(const Output& output) const {
    return static_cast<std::size_t>(&output - target_->outputs().data());
  }
  void read_outputs();
  std::string_view link_name(const Output& output) const;

  std::string name_;
  std::int64_t id_ = 0;
  std::unique_ptr<Target> target_;
  std::map<machine::Link, std::string> link_names_;
  std::vector<Prompt> prompts_;
  std::vector<Seen> seen_;                               // One for each output of the target.
  std::unordered_map<std::string, std::size_t> orders_;  // Their numbers.
  std::vector<std::size_t> next_;  // By order: the output after the last taken one.
  bool in_order_ = true;           // Outputs are, in time.
  OutputIndex index_;              // Of the first outputs, but those taken.
  std::size_t indexed_ = 0;        // So many.
  // Where nothing matches what a line asks, by its text: first of all outputs, then in turn.
  std::unordered_map<std::string, Span> none_[2];
  std::set<std::string> links_;          // At which there are outputs of the protocol,
  std::set<std::string> foreign_links_;  // and others.
  std::vector<bool> again_;              // One for each output: another one said the same before.
  std::vector<LoggedLine> log_;
  mutable trace::Concrete message_;  // Of the output that was asked for last, its place after it.
  mutable std::optional<std::size_t> place_;
};

}  // namespace rubric::runner
