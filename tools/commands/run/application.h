// What runs on a node of `rubric run`: it is told what happens, and calls.
#pragma once

#include <optional>

#include "codec/lines/time.h"
#include "conformance/machine/event.h"
#include "conformance/node/types.h"

namespace rubric::run {

/// The calls of a node, by the names of the paper's interfaces.
class Caller {
 public:
  /// Returns the call's result; nothing for joinIsland, which ends in Joined.
  virtual std::optional<machine::Notice> call(const machine::Call& call) = 0;
  /// Returns why such a message would be refused now, if the node's layer knows.
  virtual node::Refusal refusal(const machine::Send& send) const = 0;

 protected:
  ~Caller() = default;
};

/// All functions are called from the node's own thread.
class Application {
 public:
  virtual ~Application() = default;
  /// Begins; the node runs, and its lines are open or about to be.
  virtual void start(Caller&) {}
  /// Returns whether an event answers a call of this application. No other is told of it then.
  virtual bool takes(const machine::Notice&) { return false; }
  /// Takes an event, whose bytes are valid until it returns. It may call from here.
  virtual void happened(const machine::Notice&, Caller&) {}
  /// Does what is due; returns when it wants to run next.
  virtual lines::SteadyTime run(Caller&) { return lines::SteadyTime::max(); }
  /// Returns the descriptor at which calls arrive; -1: none. run() is called when it can be read.
  virtual int fd() const { return -1; }
  /// Returns whether the node is to end.
  virtual bool ended() const { return false; }
  /// Says goodbye: the node is about to end.
  virtual void stop(Caller&) {}
};

}  // namespace rubric::run
