#include "conformance/test/runner/subject_target.h"

#include <algorithm>

#include "conformance/trace/events/lines.h"

namespace rubric::runner {
namespace {

constexpr int kStepsAtOnceMax = 1000;  // A subject whose timers never end must not hold us up.

}  // namespace

using machine::Action;
using machine::Event;
using machine::Link;

Ticks transmission_ticks(Link link, std::size_t payload_bytes) {
  const std::size_t radio_us = (payload_bytes + 19) * 32;   // Preamble, header, FCS.
  const std::size_t serial_us = (payload_bytes + 13) * 87;  // Flags, header, CRC; 10 bits a byte.
  if (link == Link::kPeis) return 1;
  const std::size_t us = link == Link::kRadio ? radio_us : serial_us;
  return machine::ticks_to_hold(static_cast<machine::Micros>(us));
}

void SubjectTarget::reset(const machine::Config& config) {
  subject_->start(config);
  outputs_.clear();
  labels_.clear();
  endings_.clear();
  instant_ = 0;
  steps_at_instant_ = 0;
}

void SubjectTarget::give(Ticks now, const Event& event) {
  while (run_until(now) < now) {
  }
  if (const auto* done = std::get_if<machine::SendDone>(&event)) {
    std::erase_if(endings_, [&](const Ending& ending) { return ending.link == done->link; });
  }
  if (std::holds_alternative<machine::Reboot>(event) ||
      std::holds_alternative<machine::PowerOff>(event)) {
    endings_.clear();
  }
  step(now, event);
}

std::optional<Ticks> SubjectTarget::next() const {
  std::optional<Ticks> soonest;
  const auto take = [&](Ticks due) { soonest = std::min(due, soonest.value_or(due)); };
  for (const Ending& ending : endings_) take(ending.due);
  for (const machine::DueTimer& timer : subject_->timers()) take(timer.due);
  return soonest;
}

Ticks SubjectTarget::run_until(Ticks time) {
  const std::size_t before = outputs_.size();
  while (const auto soonest = next()) {
    const bool emitted = outputs_.size() > before;
    if (*soonest > time || (emitted && *soonest > instant_)) return emitted ? instant_ : time;
    steps_at_instant_ = *soonest == instant_ ? steps_at_instant_ + 1 : 0;
    instant_ = *soonest;
    if (steps_at_instant_ > kStepsAtOnceMax) return time;
    run_next_event(instant_);
  }
  return outputs_.size() > before ? instant_ : time;
}

// Runs the first event that is due now.
void SubjectTarget::run_next_event(Ticks now) {
  const auto ending = std::find_if(endings_.begin(), endings_.end(),
                                   [&](const Ending& one) { return one.due == now; });
  if (ending != endings_.end()) {
    const Link link = ending->link;
    endings_.erase(ending);
    step(now, machine::SendDone{link, true});
    return;
  }
  for (const machine::DueTimer& timer : subject_->timers()) {
    if (timer.due != now) continue;
    step(now, machine::TimerDue{timer.timer});
    return;
  }
}

void SubjectTarget::step(Ticks now, const Event& event) {
  subject_->step(now, event, actions_);
  collect(now);
}

void SubjectTarget::collect(Ticks now) {
  for (const Action& action : actions_.all()) {
    labels_.push_back(action);
    Output output{.time = now, .requirement = action.requirement};
    if (action.what == Action::What::kTransmit) {
      output.is_frame = true;
      output.frame = actions_.transmit_of(action);
      const machine::Transmit& frame = output.frame;
      const bool held = hold_link_acks_ && frame.link_ack;
      if (!held && frame.link != Link::kPeis) {
        endings_.push_back({now + transmission_ticks(frame.link, frame.size_bytes), frame.link});
      }
    } else if (action.what == Action::What::kNotify) {
      output.news = events::from_notice(actions_.notice_of(action));
    } else {
      continue;
    }
    outputs_.push_back(std::move(output));
  }
}

}  // namespace rubric::runner
