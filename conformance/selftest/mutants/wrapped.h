// A node made by wrapping the machine's step: the wrapper may change inputs, outputs and memory
// between the machine and the world, but never the machine itself.
#pragma once

#include <concepts>
#include <deque>
#include <functional>
#include <type_traits>
#include <vector>

#include "conformance/test/runner/subject.h"

namespace rubric::mutants {

using machine::Action;
using machine::Actions;
using machine::Event;
using machine::Frame;
using machine::Link;
using machine::Notice;
using machine::Role;
using machine::State;
using machine::Ticks;
using machine::Transmit;

/// An output that is held back.
struct Held {
  Ticks due = 0;
  Action action;
  Transmit transmit;
  Notice notice;
  std::vector<std::uint8_t> data;  ///< For Received.
};

/// A frame whose bytes and addresses may be changed. It lasts until the next step.
struct Forged {
  Frame frame;
  std::array<std::uint8_t, machine::kAmPayloadMax> bytes{};

  void resize(std::size_t size_bytes) { frame.payload = Bytes(bytes.data(), size_bytes); }
  std::size_t size() const { return frame.payload.size(); }
};

/// A wrapped node's state between steps.
struct Body {
  State state;
  Forged forged;
  std::deque<Held> held;
  std::vector<std::vector<std::uint8_t>> data;  ///< This step's notices point at these.
};

/// Returns whether an action ignores something by that rule.
bool ignores(const Actions& actions, ReqId requirement);

/// One step, for a wrapper to change.
class Moment {
 public:
  Moment(Body& body, Ticks at, const Event& what, Actions& out)
      : state(body.state), now(at), event(what), actions(out), body_(body) {}

  State& state;
  const Ticks now;
  const Event& event;
  Actions& actions;

  /// Runs the machine's step.
  void honest() { machine::step(state, now, event, actions); }
  /// Runs the machine's step for another event.
  void honest(const Event& other) { machine::step(state, now, other, actions); }
  void nothing() { actions.clear(); }
  /// Does nothing but tell this.
  void answer(const Notice& notice, ReqId requirement) {
    actions.clear();
    actions.notify(notice, requirement);
  }

  bool is(Role role) const { return state.config.role == role; }
  /// Returns the frame that is heard, of that type if one is given; or null.
  const Frame* heard() const;
  const Frame* heard(std::uint8_t am_type) const;
  template <class T>
  const T* called() const {
    const auto* call = std::get_if<machine::Called>(&event);
    return call == nullptr ? nullptr : std::get_if<T>(&call->call);
  }
  bool timer(machine::TimerKind kind) const {
    const auto* due = std::get_if<machine::TimerDue>(&event);
    return due != nullptr && due->timer.kind == kind;
  }
  /// Returns a copy of a frame, to be changed and heard in its place.
  Forged& forge(const Frame& frame);

  /// Calls `edit(action)` for each action of this step; drops those for which it does not call
  /// keep(). sent(action) and notice_of(action) may be used inside.
  template <class Edit>
  void rewrite(Edit edit) {
    honest_ = actions;
    actions.clear();
    for (const Action& action : honest_.all()) edit(action);
  }
  const Transmit& sent(const Action& action) const { return honest_.transmit_of(action); }
  const Notice& notice_of(const Action& action) const { return honest_.notice_of(action); }
  void keep(const Action& action);
  void keep(const Action& action, const Transmit& changed);
  void keep(const Action& action, const Notice& changed);
  /// Keeps it for later.
  void hold(const Action& action, Ticks ticks);

  /// Adds a frame that the machine does not send, as if the line were free.
  Transmit& send(Link link, std::uint8_t am_type, std::uint16_t dest, ReqId requirement);

 private:
  Body& body_;
  Actions honest_;
};

/// One step of a wrapper; its memory is its own.
using Step = std::function<void(Moment&)>;
/// Makes a wrapper with an empty memory.
using StepMaker = std::function<Step()>;

/// The machine with a wrapper around its step.
class Wrapped : public runner::Subject {
 public:
  explicit Wrapped(StepMaker make) : make_(std::move(make)) {}
  void start(const machine::Config& config) override;
  void step(Ticks now, const Event& event, Actions& actions) override;
  runner::DueTimers timers() const override;

 private:
  void release(Ticks now, Actions& actions);

  StepMaker make_;
  Step step_;
  Body body_;
};

runner::SubjectFactory wrapped(StepMaker make);

// Wrappers by what they meddle with.

enum class Fate : std::uint8_t { kKeep, kDrop, kTwice };

/// Makes a wrapper without a memory.
StepMaker always(void (*step)(Moment&));
/// Make wrappers that change something, and run the machine's step after it or before it.
StepMaker before_step(void (*change)(Moment&));
StepMaker after_step(void (*change)(Moment&));
/// Changes, drops or doubles frames that are sent.
using SentEdit = std::function<Fate(Moment&, const Action&, Transmit&)>;
StepMaker on_sent(SentEdit edit);
/// Changes, drops or doubles notices to the application.
using ToldEdit = std::function<Fate(Moment&, const Action&, Notice&)>;
StepMaker on_told(ToldEdit edit);
/// Changes frames that are heard; returns false to drop one.
using HeardEdit = std::function<bool(Moment&, Forged&)>;
StepMaker on_heard(HeardEdit edit);
/// Makes a wrapper that uses another profile.
StepMaker with_profile(std::function<void(machine::Profile&)> edit);
template <class Number>
StepMaker with_profile(Number machine::Profile::*field, std::type_identity_t<Number> value) {
  return with_profile([=](machine::Profile& profile) { profile.*field = value; });
}

template <class T>
StepMaker on_told_of(std::function<Fate(Moment&, T&)> edit) {
  return on_told([edit](Moment& moment, const Action&, Notice& notice) {
    T* const told = std::get_if<T>(&notice);
    return told == nullptr ? Fate::kKeep : edit(moment, *told);
  });
}
/// Changes notices of a kind, and keeps each.
template <class T>
StepMaker edit_told(void (*edit)(Moment&, T&)) {
  return on_told_of<T>([edit](Moment& moment, T& told) {
    edit(moment, told);
    return Fate::kKeep;
  });
}

/// The frames that a wrapper meddles with: those of an AM type, or those that pass a test.
template <class Kind>  // Transmit or Frame.
class Which {
 public:
  Which(std::uint8_t am_type)
      : test_([=](const Moment&, const Kind& frame) { return frame.type == am_type; }) {}
  Which(bool (*test)(const Kind&))
      : test_([=](const Moment&, const Kind& frame) { return test(frame); }) {}
  template <std::predicate<const Moment&, const Kind&> Test>
  Which(Test test) : test_(test) {}
  bool operator()(const Moment& moment, const Kind& frame) const { return test_(moment, frame); }

 private:
  std::function<bool(const Moment&, const Kind&)> test_;
};

StepMaker drop_sent(Which<Transmit> which);
StepMaker double_sent(Which<Transmit> which);
StepMaker edit_sent(Which<Transmit> which, void (*edit)(Moment&, Transmit&));
StepMaker edit_sent(void (*edit)(Moment&, Transmit&));
StepMaker edit_heard(Which<Frame> which, void (*edit)(Moment&, Forged&));
StepMaker edit_heard(void (*edit)(Moment&, Forged&));
/// Makes a wrapper that does not hear any other frames.
StepMaker hear_only(Which<Frame> which);

}  // namespace rubric::mutants
