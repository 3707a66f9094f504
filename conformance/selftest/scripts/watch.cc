#include "conformance/selftest/scripts/watch.h"

#include <algorithm>
#include <bit>
#include <memory>

#include "codec/generated/rubicon/net_msg.h"
#include "codec/generated/tinyos/am_header.h"
#include "conformance/machine/join.h"
#include "conformance/machine/lines.h"
#include "conformance/machine/messages.h"
#include "conformance/test/runner/subject_target.h"
#include "conformance/trace/concrete.h"
#include "conformance/trace/events/lines.h"
#include "conformance/trace/print.h"
#include "conformance/trace/trace.h"

namespace rubric::script {
namespace {

using explore::Property;
using machine::Action;
using machine::Actions;
using machine::Link;
using machine::Role;
using machine::State;
using machine::Transmit;
namespace am = machine::am;

constexpr std::size_t kAmHeaderBytes = tinyos::AmHeaderView::kMaxSizeBytes;
constexpr std::size_t kNoticesEvery = 8;       // They are compared as text, which takes its time.
constexpr std::size_t kMessageBytesMax = 122;  // (paper: Memory Occupation)

bool same(const Transmit& a, const Transmit& b) {
  return a.link == b.link && a.link_ack == b.link_ack && a.type == b.type && a.dest == b.dest &&
         a.src == b.src && equal(a.bytes(), b.bytes());
}

bool same(const Action& a, const Action& b) {
  return a.what == b.what && a.requirement == b.requirement && a.index == b.index;
}

template <class Range>
bool same_range(const Range& a, const Range& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const auto& x, const auto& y) { return same(x, y); });
}

bool same_notices(const Actions& a, const Actions& b) {
  const auto text = [](const machine::Notice& notice) {
    return trace::print(events::from_notice(notice));
  };
  return std::equal(a.notices().begin(), a.notices().end(), b.notices().begin(), b.notices().end(),
                    [&](const auto& x, const auto& y) { return text(x) == text(y); });
}

bool parses(const Transmit& t) {
  const trace::AmFrame frame{t.dest, t.src, 0, t.type, {t.bytes().begin(), t.bytes().end()}};
  return trace::decode(frame, events::kind_of(t.link)).name != trace::kFrameName;
}

// Returns whether the role listens to frames of this type on that line.
bool listens(Role role, const machine::Frame& frame) {
  if (frame.type == am::kNet) return true;
  if (frame.link == Link::kSerial) return role == Role::kSink && frame.type == am::kConfig;
  return frame.link == Link::kRadio &&
         (frame.type == am::kJoin || frame.type == am::kJoinReply || frame.type == am::kAckJoin);
}

// Returns whether the frame is for nobody: no sink gives its base station a message for a mote of
// their island, and no base station gives another one a message for every island, so no rule covers
// it.
bool is_for_nobody(const machine::Frame& frame, std::uint16_t island) {
  const auto message = rubicon::NetMsgView::parse(frame.payload);
  if (!message) return false;
  const machine::Address dest = machine::address_of(message->dest());
  const bool back = frame.link == Link::kSerial && dest.pid == island;
  return (back || dest.pid == machine::kBroadcastPid) && dest.devid != machine::kNullDevid;
}

template <class Line>
bool moves(const Line& line) {
  return line.out.empty() || !line.on || line.sending || line.taken;
}

}  // namespace

void Watched::breaks(Property property, Ticks now) {
  if (broken_) return;
  const explore::PropertyInfo& info = explore::info(property);
  broken_ = Broken{info.name, info.sentence, {}, now};
  for (const ReqId rule : info.requirements) {
    if (rule != ReqId::kNone) broken_->requirements.push_back(rule);
  }
}

void Watched::start(const machine::Config& config) {
  config_ = config;
  state_ = machine::start(config);
  history_ = {};
  broken_.reset();
  last_ = 0;
  steps_ = 0;
}

runner::DueTimers Watched::timers() const {
  return steps_ < kTimedStepsMax ? machine::timers(state_) : runner::DueTimers{};
}

void Watched::must(bool holds, const char* sentence, Ticks now, ReqId rule) {
  if (holds || broken_) return;
  broken_ = Broken{"structure", sentence, {}, now};
  if (rule != ReqId::kNone) broken_->requirements.push_back(rule);
}

void Watched::step(Ticks now, const machine::Event& event, machine::Actions& actions) {
  ++steps_;
  const State before = state_;
  step_(state_, now, event, actions);
  const Seen seen{{config_, before, event, actions, state_, now},
                  explore::handled_frames(before, event)};
  same_again(seen);
  check_labels(seen);
  check_frames(seen);
  check_bounds(seen);
  explore::Noted noted;
  explore::observe(history_, seen, seen.handled, noted);
  if (noted.violated != 0) breaks(static_cast<Property>(std::countr_zero(noted.violated)), now);
  const bool joining = state_.join.phase == machine::JoinMote::Phase::kJoining;
  const bool waits = history_.open_calls == (joining ? 1 : 0);
  if (config_.role == Role::kMote && !waits) breaks(Property::kOneTerminal, now);
  overdue(now);
  last_ = now;
}

void Watched::overdue(Ticks now) {
  if (steps_ >= kTimedStepsMax) return;
  const machine::Profile& profile = config_.profile;
  const Ticks timeout = profile.ack_timeout_ticks;
  for (const explore::OpenSend& one : history_.sends) {
    const bool late = one.left && now > *one.left + timeout;
    if (late && timeout != 0) breaks(Property::kReliableEnds, now);
  }
  // Each of its requests may have had to wait for the radio for nearly a period.
  const Ticks longest = 2 * profile.join_period_ticks * (profile.join_requests_max + 1U);
  const bool calling = history_.open_calls > 0 && profile.join_fail_signalled;
  if (calling && now > history_.opened + longest) breaks(Property::kOneTerminal, now);
}

void Watched::finish(Ticks now) { overdue(now); }

void Watched::same_again(const Seen& seen) {
  State copy = seen.before;
  Actions actions;
  step_(copy, seen.now, seen.event, actions);
  must(copy == seen.after && machine::hash_value(copy) == machine::hash_value(seen.after),
       "The same event makes the same state of the same state.", seen.now);
  const bool alike = same_range(actions.all(), seen.actions.all()) &&
                     same_range(actions.transmits(), seen.actions.transmits()) &&
                     (steps_ % kNoticesEvery != 0 || same_notices(actions, seen.actions));
  must(alike, "The same event in the same state has the same consequences.", seen.now);
}

void Watched::check_labels(const Seen& seen) {
  const auto* heard = std::get_if<machine::Heard>(&seen.event);
  const auto* called = std::get_if<machine::Called>(&seen.event);
  // The protocol does not cover these: frames that TinyOS keeps away, ends of nothing, power.
  const bool kept_away = heard && (seen.handled.empty() || !listens(config_.role, heard->frame));
  const bool astray =
      config_.role == Role::kBaseStation &&
      std::any_of(seen.handled.begin(), seen.handled.end(), [&](const machine::Frame& frame) {
        return is_for_nobody(frame, seen.before.island);
      });
  const bool beyond = kept_away || astray ||
                      std::holds_alternative<machine::SendDone>(seen.event) ||
                      std::holds_alternative<machine::LinkBusy>(seen.event) ||
                      std::holds_alternative<machine::Reboot>(seen.event);
  for (const Action& action : seen.actions.all()) {
    if (action.requirement != ReqId::kNone) continue;
    const bool told = action.what == Action::What::kNotify;
    const bool sends = action.what == Action::What::kTransmit;
    const bool channel_of_base = told && called && config_.role == Role::kBaseStation;
    // Nor has a mote that left, where that is stated. (decision 124)
    const bool left = told && config_.profile.gone_after_ticks != 0 &&
                      std::holds_alternative<machine::MoteLeft>(seen.actions.notice_of(action));
    must(!sends && (!told || channel_of_base || left), "Whatever a node does names its rule.",
         seen.now);
    must(told || beyond, "Whatever a node ignores names its rule.", seen.now);
  }
  if (heard) must(!seen.actions.all().empty(), "No frame is taken without a word.", seen.now);
  if (!called || seen.before.off) return;
  const bool joins = std::holds_alternative<machine::JoinIsland>(called->call);
  const auto results = std::count_if(seen.actions.notices().begin(), seen.actions.notices().end(),
                                     machine::is_result);
  must(results == (joins ? 0 : 1), "Each call but joinIsland returns once.", seen.now);
  if (joins) must(!seen.actions.all().empty(), "No call is taken without a word.", seen.now);
}

void Watched::check_frames(const Seen& seen) {
  int on_radio = 0;
  int on_serial = 0;
  for (const Transmit& one : seen.actions.transmits()) {
    must(parses(one), "Whatever a node sends is a message of the wire spec.", seen.now);
    must(one.size_bytes + kAmHeaderBytes <= kMessageBytesMax, "No message is over 122 bytes.",
         seen.now, "WIRE-AM-LENGTH"_rule);
    must(machine::has_line(config_.role, one.link), "A node sends on its own lines.", seen.now);
    on_radio += one.link == Link::kRadio;
    on_serial += one.link == Link::kSerial;
    if (one.link == Link::kPeis) continue;
    const bool sending =
        one.link == Link::kRadio ? seen.after.radio.sending : seen.after.serial.sending;
    must(sending, "What is sent takes its line.", seen.now, "N2-BUSY"_rule);
  }
  must(on_radio <= 1 && on_serial <= 1, "One line carries one frame at a time.", seen.now,
       "N2-BUSY"_rule);
  must(!seen.after.off || seen.actions.notices().empty(), "Without power nothing happens.",
       seen.now, "N10-OFF"_rule);
}

void Watched::check_bounds(const Seen& seen) {
  const State& s = seen.after;
  must(seen.now >= last_, "Time does not go back.", seen.now);
  const runner::DueTimers set = machine::timers(s);
  must(set.size() <= 3 + machine::kAwaitedMax, "Timers are bounded.", seen.now);
  const bool joining = s.join.phase == machine::JoinMote::Phase::kJoining;
  bool join_timer = false;
  for (const machine::DueTimer& timer : set) {
    const bool past = timer.due < seen.now && steps_ < kTimedStepsMax;
    must(!past, "No timer is set for the past.", seen.now);
    join_timer |= timer.timer.kind == machine::TimerKind::kJoin;
  }
  for (std::size_t i = 0; i < s.awaited.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      must(s.awaited[i].seq_num != s.awaited[k].seq_num, "No number is awaited twice.", seen.now,
           "N12-REUSE"_rule);
    }
  }
  const bool waits_for_something = moves(s.radio) && moves(s.serial);
  if (!waits_for_something || joining != join_timer) breaks(Property::kNoDeadlock, seen.now);
}

std::string Broken::text() const {
  std::string rules;
  for (const ReqId rule : requirements) {
    rules += (rules.empty() ? " (" : " ") + std::string(trace::requirement_text(rule));
  }
  if (!rules.empty()) rules += ')';
  return name + " at " + std::to_string(time) + rules + ": " + sentence;
}

std::optional<Broken> watch(const Script& script, flaws::StepFunction step) {
  auto subject = std::make_unique<Watched>(step);
  Watched& watched = *subject;
  runner::SubjectTarget target(std::move(subject));
  play(script, target);
  watched.finish(script.length());
  return watched.broken();
}

}  // namespace rubric::script
