// Checks the promises of one node in any run: the explorer's properties without its small world,
// and properties of the machine as a function. README.md lists them.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "conformance/explorer/property.h"
#include "conformance/flaws/flaws.h"
#include "conformance/runner/subject.h"
#include "conformance/script/script.h"

namespace rubric::script {

using machine::Ticks;

/// The first promise that was broken.
struct Broken {
  std::string name;      ///< The explorer's property, or `structure`.
  std::string sentence;  ///< The property that should have held.
  std::vector<ReqId> requirements;
  Ticks time = 0;
  /// Returns "one_terminal at 3000 (J5-ONCE J8-FAIL): Each joinIsland call ends ..."
  std::string text() const;
};

/// A node's inputs and outputs, as far as later promises need them.
struct History {
  struct Sent {  // A reliable message that has not ended.
    std::uint16_t seq_num = 0;
    std::uint8_t app_id = 0;
    machine::Address dest;
    std::optional<Ticks> left;  // When a line took it.
  };
  // A mote.
  int open_calls = 0;
  Ticks opened = 0;
  bool asked = false;
  int requests = 0;
  std::uint16_t present_seq = 0;
  std::set<std::uint16_t> offers;  // Islands of replies to the present request.
  std::optional<std::uint16_t> chosen;
  std::optional<machine::Address> view;
  // A sink.
  std::map<std::uint16_t, int> heard_requests;
  std::map<std::uint16_t, std::uint16_t> stored;  // Numbers, by mote, of requests to be answered.
  bool stored_too_many = false;                   // Since then the oldest may be forgotten.
  std::set<std::uint16_t> acked;
  int reports_owed = 0;
  // Both.
  std::vector<Sent> sends;
};

/// The machine, or a flaw around it, checked at every step.
class Watched : public runner::Subject {
 public:
  explicit Watched(flaws::StepFunction of = machine::step) : step_(of) {}

  void start(const machine::Config& config) override;
  void step(Ticks now, const machine::Event& event, machine::Actions& actions) override;
  runner::DueTimers timers() const override;

  /// Checks, after the script, that everything that should have ended has.
  void finish(Ticks now);
  const std::optional<Broken>& broken() const { return broken_; }
  /// The node gets its timers in this many steps; a clock of one tick could run for ever.
  static constexpr std::size_t kTimedStepsMax = 2000;

 private:
  struct Seen {  // One step.
    const machine::State& before;
    const machine::Event& event;
    const machine::Actions& actions;
    const machine::State& after;
    std::vector<machine::Frame> handled;  // Frames handled in this step, in order.
    Ticks now;
  };

  void breaks(explorer::Property property, Ticks now);
  void must(bool holds, const char* sentence, Ticks now, ReqId rule = ReqId::kNone);

  // watch.cc: the explorer's properties.
  std::vector<machine::Frame> handled(const machine::State& before,
                                      const machine::Event& event) const;
  void begins(const Seen& seen);
  void frame_handled(const Seen& seen, const machine::Frame& frame);
  void request_handled(const Seen& seen, const machine::Frame& frame);
  void mote_sends(const Seen& seen, const machine::Transmit& transmit);
  void sink_sends(const Seen& seen, const machine::Transmit& transmit, ReqId rule);
  void told(const Seen& seen, const machine::Notice& notice);
  void told_joined(const Seen& seen, const machine::Joined& joined);
  void told_received(const Seen& seen, const machine::Received& received);
  void ack_handled(const Seen& seen, const machine::Frame& frame);
  void ack_join_handled(const Seen& seen, const machine::Frame& frame);
  void ends(const Seen& seen);
  void mote_ends(const Seen& seen);
  void sink_ends(const Seen& seen);
  void overdue(Ticks now);

  // watch_structure.cc: the machine as a function.
  void same_again(const machine::State& before, const Seen& seen);
  void check_labels(const Seen& seen);
  void check_frames(const Seen& seen);
  void check_bounds(const Seen& seen);

  flaws::StepFunction step_;
  machine::Config config_;  // The start value: a flaw may change the state's.
  machine::State state_;
  History history_;
  std::optional<Broken> broken_;
  Ticks last_ = 0;
  std::size_t steps_ = 0;
};

/// Returns whether the message with this number, whose ack is awaited, is yet to leave.
bool waits_for_line(const machine::State& state, std::uint16_t seq_num);

/// Runs a script on the machine, or on a flaw around it. Returns the broken promise; nothing if all
/// were kept.
std::optional<Broken> watch(const Script& script, flaws::StepFunction step = machine::step);

}  // namespace rubric::script
