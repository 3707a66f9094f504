// Any implementation that `rubric test --target` drives as the layer of a mote: firmware in a
// simulator, another language, the reference machine with a flaw.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "conformance/test/targets/attachment.h"
#include "tools/commands/run/layer.h"

namespace rubric::run {

/// Turns the implementation's clock by the wall's. All but listens() and island() throw Broken when
/// it breaks.
class TargetLayer final : public Layer {
 public:
  /// `target` as attach() takes it. Starts it as a mote. Throws std::invalid_argument if it is none
  /// or has a clock of its own.
  TargetLayer(const std::string& target, std::uint16_t id, std::uint16_t first_seq,
              LayerUser& user);

  std::optional<node::Ticks> run(node::Ticks now) override;
  void received(node::Line line, Bytes packet) override;
  void sent(node::Line line, bool acked) override;
  std::optional<machine::Notice> call(const machine::Call& call) override;
  bool listens() const override { return listens_; }
  std::uint16_t island() const override { return 0; }

 private:
  /// Runs what may throw, and says whose mistake it is.
  template <class Action>
  void guarded(Action action);
  void give(const machine::Event& event);
  void advance();
  void take(std::optional<machine::Notice>* result);
  void send_next();

  std::string name_;
  LayerUser& user_;
  std::unique_ptr<targets::Attachment> attachment_;
  std::unique_ptr<runner::Target> target_;
  node::Ticks now_ = 0;
  std::size_t taken_ = 0;                 // Of the target's outputs.
  std::deque<runner::Output> news_;       // Not passed on yet.
  std::deque<machine::Transmit> frames_;  // The first is on the air if on_air_.
  bool on_air_ = false;
  bool listens_ = true;
};

}  // namespace rubric::run
