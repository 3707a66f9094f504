#include "conformance/selftest/mutants/wrapped.h"

#include <algorithm>
#include <utility>

namespace rubric::mutants {
namespace {

constexpr std::uint8_t kWakeUp = 0xD1;  // Timer of what is held back; the machine has none such.

bool is_wake_up(const Event& event) {
  const auto* due = std::get_if<machine::TimerDue>(&event);
  return due != nullptr && due->timer.index == kWakeUp;
}

// Room enough that a doubled output does no harm to the machine's own bounds.
bool has_room(const Actions& actions, const Action& action) {
  if (actions.all().size() >= Actions::kActionsMax) return false;
  if (action.what == Action::What::kTransmit) {
    return actions.transmits().size() < Actions::kTransmitsMax;
  }
  return action.what != Action::What::kNotify || actions.notices().size() < Actions::kNoticesMax;
}

// Lets frames of a kind that is sent end so.
StepMaker sent_to(Fate fate, Which<Transmit> which) {
  return on_sent([=](Moment& moment, const Action&, Transmit& frame) {
    return which(moment, frame) ? fate : Fate::kKeep;
  });
}
template <class Kind>
bool any(const Moment&, const Kind&) {
  return true;
}

}  // namespace

bool ignores(const Actions& actions, ReqId requirement) {
  return std::any_of(actions.all().begin(), actions.all().end(), [=](const Action& action) {
    return action.what == Action::What::kIgnored && action.requirement == requirement;
  });
}

const Frame* Moment::heard() const {
  const auto* heard = std::get_if<machine::Heard>(&event);
  return heard == nullptr ? nullptr : &heard->frame;
}

const Frame* Moment::heard(std::uint8_t am_type) const {
  const Frame* const frame = heard();
  return frame != nullptr && frame->type == am_type ? frame : nullptr;
}

Forged& Moment::forge(const Frame& frame) {
  Forged& forged = body_.forged;
  const std::size_t size = std::min<std::size_t>(frame.payload.size(), machine::kAmPayloadMax);
  std::copy_n(frame.payload.begin(), size, forged.bytes.begin());
  forged.frame = frame;
  forged.resize(size);
  return forged;
}

void Moment::keep(const Action& action) {
  if (!has_room(actions, action)) return;
  switch (action.what) {
    case Action::What::kTransmit: actions.transmit(action.requirement) = sent(action); break;
    case Action::What::kNotify: actions.notify(notice_of(action), action.requirement); break;
    case Action::What::kFollowed: actions.followed(action.requirement); break;
    case Action::What::kIgnored: actions.ignored(action.requirement); break;
  }
}

void Moment::keep(const Action& action, const Transmit& changed) {
  if (has_room(actions, action)) actions.transmit(action.requirement) = changed;
}

void Moment::keep(const Action& action, const Notice& changed) {
  if (has_room(actions, action)) actions.notify(changed, action.requirement);
}

void Moment::hold(const Action& action, Ticks ticks) {
  Held& held = body_.held.emplace_back();
  held.due = now + ticks;
  held.action = action;
  if (action.what == Action::What::kTransmit) held.transmit = sent(action);
  if (action.what != Action::What::kNotify) return;
  held.notice = notice_of(action);
  if (const auto* received = std::get_if<machine::Received>(&held.notice)) {
    held.data.assign(received->data.begin(), received->data.end());
  }
}

Transmit& Moment::send(Link link, std::uint8_t am_type, std::uint16_t dest, ReqId requirement) {
  Transmit& transmit = actions.transmit(requirement);
  transmit = Transmit{};
  transmit.link = link;
  transmit.type = am_type;
  transmit.dest = dest;
  transmit.src = link == Link::kRadio ? state.config.id : std::uint16_t{0};
  transmit.payload.fill(0);
  return transmit;
}

void Wrapped::start(const machine::Config& config) {
  body_ = Body{};
  body_.state = machine::start(config);
  step_ = make_();
}

void Wrapped::step(Ticks now, const Event& event, Actions& actions) {
  body_.data.clear();
  if (is_wake_up(event)) {
    actions.clear();
    return release(now, actions);
  }
  if (std::holds_alternative<machine::Reboot>(event)) body_.held.clear();
  Moment moment(body_, now, event, actions);
  step_(moment);
}

runner::DueTimers Wrapped::timers() const {
  runner::DueTimers timers = machine::timers(body_.state);
  const auto soonest = std::min_element(body_.held.begin(), body_.held.end(),
                                        [](const Held& a, const Held& b) { return a.due < b.due; });
  // The machine never has all its timers set: a joining mote awaits no acks.
  if (soonest != body_.held.end() && !timers.full()) {
    timers.push({soonest->due, {machine::TimerKind::kSynaptic, kWakeUp}});
  }
  return timers;
}

void Wrapped::release(Ticks now, Actions& actions) {
  for (std::size_t i = 0; i < body_.held.size();) {
    Held& held = body_.held[i];
    if (held.due > now || !has_room(actions, held.action)) {
      ++i;
      continue;
    }
    if (held.action.what == Action::What::kTransmit) {
      actions.transmit(held.action.requirement) = held.transmit;
    } else {
      if (auto* received = std::get_if<machine::Received>(&held.notice)) {
        const auto& data = body_.data.emplace_back(std::move(held.data));
        received->data = Bytes(data.data(), data.size());
      }
      actions.notify(held.notice, held.action.requirement);
    }
    body_.held.erase(body_.held.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

runner::SubjectFactory wrapped(StepMaker make) {
  return [make = std::move(make)] { return std::make_unique<Wrapped>(make); };
}

StepMaker always(void (*step)(Moment&)) {
  return [step] { return Step(step); };
}

StepMaker before_step(void (*change)(Moment&)) {
  return [change]() -> Step {
    return [change](Moment& moment) {
      change(moment);
      moment.honest();
    };
  };
}

StepMaker after_step(void (*change)(Moment&)) {
  return [change]() -> Step {
    return [change](Moment& moment) {
      moment.honest();
      change(moment);
    };
  };
}

StepMaker on_sent(SentEdit edit) {
  return [edit = std::move(edit)]() -> Step {
    return [edit](Moment& moment) {
      moment.honest();
      moment.rewrite([&](const Action& action) {
        if (action.what != Action::What::kTransmit) return moment.keep(action);
        Transmit changed = moment.sent(action);
        const Fate fate = edit(moment, action, changed);
        if (fate == Fate::kDrop) return;
        moment.keep(action, changed);
        if (fate == Fate::kTwice) moment.keep(action, changed);
      });
    };
  };
}

StepMaker on_told(ToldEdit edit) {
  return [edit = std::move(edit)]() -> Step {
    return [edit](Moment& moment) {
      moment.honest();
      moment.rewrite([&](const Action& action) {
        if (action.what != Action::What::kNotify) return moment.keep(action);
        Notice changed = moment.notice_of(action);
        const Fate fate = edit(moment, action, changed);
        if (fate == Fate::kDrop) return;
        moment.keep(action, changed);
        if (fate == Fate::kTwice) moment.keep(action, changed);
      });
    };
  };
}

StepMaker on_heard(HeardEdit edit) {
  return [edit = std::move(edit)]() -> Step {
    return [edit](Moment& moment) {
      const Frame* const frame = moment.heard();
      if (frame == nullptr) return moment.honest();
      Forged& forged = moment.forge(*frame);
      if (!edit(moment, forged)) return moment.nothing();
      moment.honest(machine::Heard{forged.frame});
    };
  };
}

StepMaker drop_sent(Which<Transmit> which) { return sent_to(Fate::kDrop, which); }

StepMaker double_sent(Which<Transmit> which) { return sent_to(Fate::kTwice, which); }

StepMaker edit_sent(Which<Transmit> which, void (*edit)(Moment&, Transmit&)) {
  return on_sent([=](Moment& moment, const Action&, Transmit& frame) {
    if (which(moment, frame)) edit(moment, frame);
    return Fate::kKeep;
  });
}

StepMaker edit_sent(void (*edit)(Moment&, Transmit&)) { return edit_sent(any<Transmit>, edit); }

StepMaker edit_heard(Which<Frame> which, void (*edit)(Moment&, Forged&)) {
  return on_heard([=](Moment& moment, Forged& forged) {
    if (which(moment, forged.frame)) edit(moment, forged);
    return true;
  });
}

StepMaker edit_heard(void (*edit)(Moment&, Forged&)) { return edit_heard(any<Frame>, edit); }

StepMaker hear_only(Which<Frame> which) {
  return on_heard([=](Moment& moment, Forged& forged) { return which(moment, forged.frame); });
}

StepMaker with_profile(std::function<void(machine::Profile&)> edit) {
  return [edit = std::move(edit)]() -> Step {
    return [edit](Moment& moment) {
      const machine::Profile honest = moment.state.config.profile;
      edit(moment.state.config.profile);
      moment.honest();
      moment.state.config.profile = honest;
    };
  };
}

}  // namespace rubric::mutants
