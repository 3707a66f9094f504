// An application that follows a list: joins, sends, runs synaptic channels, fails.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "conformance/machine/event.h"
#include "conformance/simulate/event_queue.h"

namespace rubric::simulate {

/// A node as its application sees it.
class Host {
 public:
  virtual ~Host() = default;
  virtual Micros now() const = 0;
  /// Makes the call as soon as the node has finished its present step; copies bytes.
  virtual void call(const machine::Call& call) = 0;
  /// Calls woken(token) after a delay, unless the node's power fails before.
  virtual void wake_after(Micros delay_us, std::uint32_t token) = 0;
  /// Switches the power off, and on again, after which booted() is called. A negative delay means
  /// never.
  virtual void power_off(Micros on_after_us) = 0;
  virtual Random& random() = 0;
};

class Application {
 public:
  virtual ~Application() = default;
  /// Called when the node has power: at the start of the run, and after each power_off().
  virtual void booted(Host&) {}
  virtual void woken(Host&, std::uint32_t /*token*/) {}
  /// Called with a notice; its bytes live until this returns.
  virtual void notified(Host&, const machine::Notice&) {}
};

/// A message, once or repeatedly. Times count from when the node is ready: for a mote when it has
/// joined, for others when they have started.
struct ScriptedSend {
  machine::Address dest;
  std::uint8_t app_id = 0;
  bool reliable = false;
  std::vector<std::uint8_t> data;
  /// If not 0, the data are `updates` instead: a random reading of each of these transducers.
  std::uint16_t readings_of = 0;
  Micros first_us = 0;
  Micros period_us = 0;  ///< 0: once.
};

struct ScriptedChannel {
  machine::Direction direction = machine::Direction::kOut;
  machine::Address peer;
  std::uint8_t size = 0;
  machine::Mode mode = machine::Mode::kReliable;
};

/// Times of a script's mishaps count from the start of the run.
struct ScriptedCut {
  Micros at_us = 0;
  Micros for_us = 0;        ///< Negative: for good.
  bool radio_only = false;  ///< The radio is switched off and on; memory stays.
};

struct Script {
  std::optional<Micros> join_us;  ///< Since the start of the run, and of each boot after that.
  machine::Descriptor descriptor;
  Micros rejoin_us = 1'000'000;  ///< From joined(FAIL) to the next joinIsland.
  std::vector<ScriptedSend> sends;
  std::vector<ScriptedChannel> channels;
  std::uint16_t time_step_ticks = 0;  ///< 0: no synaptic computation.
  std::vector<ScriptedCut> cuts;
};

class ScriptedApplication final : public Application {
 public:
  explicit ScriptedApplication(Script script) : script_(std::move(script)) {}

  void booted(Host& host) override;
  void woken(Host& host, std::uint32_t token) override;
  void notified(Host& host, const machine::Notice& notice) override;

 private:
  void ready(Host& host);
  void send(Host& host, std::size_t index);
  void compute(Host& host);
  void cut(Host& host, const ScriptedCut& cut);

  Script script_;
  bool booted_before_ = false;
  std::vector<machine::ChannelId> outputs_;  ///< By channel, 0 if it is no output or was refused.
  std::size_t created_ = 0;
};

}  // namespace rubric::simulate
