// A node behind rct/1 on the runner's clock.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "conformance/test/targets/clock.h"
#include "conformance/test/targets/rct_client.h"

namespace rubric::targets {

/// How often an adapter without a `next` line is asked, in ticks, when several nodes go on
/// together.
constexpr Ticks kUnknownNextTicks = 5;

/// Returns the command that makes an event happen. Throws runner::Unsupported if there is none.
std::string command_of(const machine::Event& event, Ticks now);
/// Returns what a node is to be built with, besides its channels: the parameters that its profile
/// has otherwise and that it does not state itself. Throws runner::Unsupported.
trace::Statement asked_for(const machine::Config& config, const trace::Statement& own);
/// Returns the command that starts a node, with what it does not state itself. Throws
/// runner::Unsupported.
std::string reset_command(const machine::Config& config, const trace::Statement& own);

class RctTarget : public runner::Target {
 public:
  /// Gets the client when the target is destroyed.
  using GiveBack = std::function<void(std::unique_ptr<RctClient>)>;
  /// `own` is what the implementation states.
  RctTarget(std::unique_ptr<RctClient> client, trace::Statement own, GiveBack give_back)
      : client_(std::move(client)), own_(std::move(own)), give_back_(std::move(give_back)) {
    if (!client_->identity().real_time) return;
    tolerance_of_this_host();  // Measures now, not in the middle of a case.
    delays_.emplace();
  }
  ~RctTarget() override { give_back_(std::move(client_)); }

  void start(const trace::Scope& scope, const trace::NodeHeader& node) override;
  void reset(const machine::Config& config) override;
  void give(Ticks now, const machine::Event& event) override;
  void call(Ticks now, const trace::Concrete& message) override;
  std::optional<Ticks> next() const override;
  Ticks run_until(Ticks time) override;
  const std::vector<Output>& outputs() const override { return outputs_; }
  void hold_link_acks(bool hold) override { hold_link_acks_ = hold; }
  runner::Reach reach() const override {
    return client_->identity().shown.value_or(runner::Reach{});
  }
  runner::Tolerance tolerance() const override {
    return delays_ ? tolerance_of_this_host(delays_->worst()) : runner::Tolerance{};
  }
  std::optional<runner::Window> given() const override { return given_; }

 private:
  /// Sends a command and keeps its outputs. Returns the instant of `done`.
  Ticks ask(std::string command, Ticks time, bool passes_time);
  Answer answer_to(const Asked& asked, lines::Milliseconds more);
  Ticks let_pass(Ticks time);
  void ask_until(Ticks time);
  void compare_clocks(const std::string& command);
  void give_command(Ticks now, std::string command);
  void start_node(machine::Role role, const std::string& command, const trace::Statement& wanted);

  std::unique_ptr<RctClient> client_;
  trace::Statement own_;
  trace::Statement buffers_;          ///< What the case asks for and `own_` does not say.
  std::optional<DelayWatch> delays_;  // In real time.
  GiveBack give_back_;
  RealClock clock_;  // Since reset; of what runs in real time.
  std::vector<Output> outputs_;
  std::optional<runner::Window> given_;  // In real time.
  std::deque<Ticks> link_acks_;          // Ends of transmissions that ask for one.
  bool hold_link_acks_ = false;
  Ticks now_ = 0;         // Everything before it is done,
  bool settled_ = false;  // and everything at it.
  bool knows_next_ = false;
  std::optional<Ticks> next_;   // If it is known.
  std::size_t at_instant_ = 0;  // Outputs of the last instant.
};

}  // namespace rubric::targets
