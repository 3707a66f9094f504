// Choices that the rules leave: steps that are not compared, and moments from which two good nodes
// may differ. Each has its line in README.md.
#include <algorithm>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "codec/generated/rubicon/config.h"
#include "codec/generated/rubicon/join_reply.h"
#include "codec/generated/rubicon/join_request.h"
#include "codec/generated/rubicon/net_msg.h"
#include "conformance/explore/history.h"
#include "conformance/generated/profiles.h"
#include "conformance/machine/lines.h"
#include "conformance/machine/messages.h"
#include "conformance/machine/transport.h"
#include "conformance/selftest/scripts/difference.h"
#include "conformance/selftest/scripts/rtr.h"
#include "conformance/test/runner/subject_target.h"

namespace rubric::script {
namespace {

using machine::Address;
using machine::Frame;
using machine::Link;
using machine::Role;
using machine::State;
using runner::Output;
namespace am = machine::am;
namespace component = machine::component;

// Returns whether every implementation knows the application: its body is in the wire spec.
// (T1-UNKNOWN)
bool is_known_to_all(std::uint8_t app_id) {
  const auto id = static_cast<rubicon::Component>(app_id);
  return id == rubicon::Component::kMockup || id == rubicon::Component::kLearning ||
         id == rubicon::Component::kControlLayer;
}

using PaperAck = rubicon::RubiconAckSeqOnlyLayout::SeqNumAt;
using DeployedAck = rubicon::RubiconAckLayout;
constexpr std::size_t kDeployedAckBytes = rubicon::RubiconAckView::kMinSizeBytes;
constexpr std::size_t kBodyAt = rubicon::AppMsgLayout::PayloadAt::kAt;

bool is_ack_body(Bytes body) {
  if (body.size() == PaperAck::kEnd) return true;
  return body.size() >= kDeployedAckBytes &&
         DeployedAck::TypeAt::load(body.data()) == rubicon::AmType::kLearningNotification;
}

std::uint8_t trans_id_of(Bytes payload) {
  return static_cast<std::uint8_t>(rubicon::AppMsgLayout::TransIdAt::load(payload.data()));
}

// Returns whether no node has this address, so that it can be nobody's source.
bool is_nobody(Address src) {
  return machine::is_reserved(src.pid) ||
         (machine::is_reserved(src.devid) && src.devid != machine::kNullDevid);
}

bool is_decided(const machine::Config& config, const Frame& frame, rubicon::NetMsgView message) {
  const Address dest = machine::address_of(message.dest());
  const Bytes payload = message.payload();
  const std::uint8_t trans_id = trans_id_of(payload);
  const auto app_id =
      static_cast<std::uint8_t>(rubicon::AppMsgLayout::AppIdAt::load(payload.data()));
  const bool base = config.role == Role::kBaseStation;
  if (is_nobody(machine::address_of(message.src()))) return false;
  if (trans_id == component::kConnless && machine::is_known_app(app_id) &&
      !is_known_to_all(app_id)) {
    return false;
  }
  if (trans_id == component::kRubiconAck && !is_ack_body(payload.from(kBodyAt))) return false;
  // Every island, and a base station among all devices: decision 114.
  const bool everywhere = dest.pid == machine::kBroadcastPid;
  if (everywhere && (base || frame.link == Link::kSerial)) return false;
  if (base && dest.devid == machine::kBroadcastDevid) return false;
  return !base || trans_id != component::kSynChannel;  // It has no channels.
}

// Returns whether a waiting frame's fate is decided: a net_msg waits for a busy application, the
// rest is each node's choice.
bool is_decided(const machine::Config& config, const Frame& frame, bool app_busy) {
  if (frame.link == Link::kPeis && (app_busy || frame.dest == machine::kAmBroadcast)) return false;
  if (frame.type != am::kNet) return !app_busy;
  const auto message = rubicon::NetMsgView::parse(frame.payload);
  return message ? is_decided(config, frame, *message) : !app_busy;
}

bool is_of_channels(const machine::Call& call) {
  return std::holds_alternative<machine::CreateChannel>(call) ||
         std::holds_alternative<machine::DisposeChannel>(call) ||
         std::holds_alternative<machine::StartChannel>(call) ||
         std::holds_alternative<machine::StopChannel>(call) ||
         std::holds_alternative<machine::StartAllChannels>(call) ||
         std::holds_alternative<machine::StopAllChannels>(call) ||
         std::holds_alternative<machine::WriteOutput>(call) ||
         std::holds_alternative<machine::ReadInput>(call) ||
         std::holds_alternative<machine::SetTimeStep>(call);
}

bool is_decided(const machine::Config& config, const machine::Call& call) {
  const auto has = [&](Link link) {
    return link != Link::kPeis && machine::has_line(config.role, link);
  };
  if (const auto* set = std::get_if<machine::SetInterface>(&call)) return has(set->link);
  if (const auto* get = std::get_if<machine::GetInterface>(&call)) return has(get->link);
  if (const auto* send = std::get_if<machine::Send>(&call)) {
    // Decision 114; and N3-LOCAL is about islands alone.
    return send->dest.pid != machine::kBroadcastPid && send->dest.devid != machine::kLocalDevid;
  }
  if (const auto* create = std::get_if<machine::CreateChannel>(&call)) {
    if (machine::is_reserved(create->peer.devid)) return false;
    if (machine::is_reserved(create->peer.pid) && create->peer.pid != machine::kLocalPid) {
      return false;
    }
  }
  return config.role != Role::kBaseStation || !is_of_channels(call);
}

// The machine, and the first moment from which others may differ.
class Probe : public runner::Machine {
 public:
  explicit Probe(flaws::StepFunction of) : Machine(of) {}
  void step(Ticks now, const machine::Event& event, machine::Actions& actions) override {
    late_sends(now);
    const State before = state_;
    Machine::step(now, event, actions);
    if (is_free(before, now, event, actions)) free_at(now);
    const bool full = before.radio.out.full() || before.serial.out.full();
    if (full && std::holds_alternative<machine::SendDone>(event)) had_room_at_ = now;
    remember_sends(event, actions, now);
    late_sends(now);
  }
  void finish(Ticks now) { late_sends(now); }
  const std::optional<Ticks>& free() const { return free_; }

 private:
  struct Sent {
    std::uint16_t seq_num;
    Ticks called;
  };

  bool is_free(const State& before, Ticks now, const machine::Event& event,
               const machine::Actions& actions) const {
    const bool tick = std::holds_alternative<machine::TimerDue>(event);
    if (tick && had_room_at_ == now) return true;  // It might as well have come a moment before.
    for (const machine::Action& action : actions.all()) {
      if (action.what != machine::Action::What::kIgnored) continue;
      const bool heard = std::holds_alternative<machine::Heard>(event) ||
                         std::holds_alternative<machine::AppBusy>(event);
      // Values for a channel that is stopped may be kept; too few values are malformed.
      if (heard && action.requirement == "S6-STOPPED"_rule) return true;
      if (heard && action.requirement == "S2-CONTENT"_rule) return true;
      if (action.requirement == "S4-LOCAL"_rule) return true;
      // Which of a tick's messages are lost when the line takes fewer than the clock makes.
      if (tick && action.requirement == "N1-FULL"_rule) return true;
      // A sink may trust its base station with the island (decision 126).
      if (heard && action.requirement == "N7-FOREIGN"_rule) return true;
    }
    if (const auto* called = std::get_if<machine::Called>(&event)) {
      return !before.off && is_free(before, called->call);
    }
    if (const auto* done = std::get_if<machine::SendDone>(&event)) {
      return !done->acked && may_repeat(before, now, *done);
    }
    return false;
  }

  // Returns whether ack_join may be repeated or not; within a period and with a free radio both are
  // right.
  static bool may_repeat(const State& before, Ticks now, const machine::SendDone& done) {
    if (done.link != Link::kRadio || !before.radio.sending_ack_join) return false;
    const bool free_radio = before.radio.on && !before.radio.taken && before.radio.out.empty();
    return !free_radio || now - before.join.accepted >= before.config.profile.join_period_ticks;
  }

  static bool is_free(const State& before, const machine::Call& call) {
    const bool member =
        before.config.role != Role::kMote || before.join.phase == machine::JoinMote::Phase::kMember;
    const machine::Synaptic& synaptic = before.synaptic;
    if (is_of_channels(call) && !member) return true;  // No rule says what outsiders may prepare.
    // The next tick may come by the old period or the new one (decision 121).
    if (std::holds_alternative<machine::SetTimeStep>(call)) return synaptic.due != 0;
    if (const auto* create = std::get_if<machine::CreateChannel>(&call)) {
      // More connections are a change of the values, or none.
      return std::any_of(synaptic.out.begin(), synaptic.out.end(), [&](const auto& channel) {
        return create->direction == machine::Direction::kOut &&
               channel.peer.devid == create->peer.devid &&
               channel.mode == machine::Mode::kPowerSave && channel.started;
      });
    }
    // Values since the last tick may be news after a stop, or not.
    const bool stops = std::holds_alternative<machine::StopChannel>(call) ||
                       std::holds_alternative<machine::StopAllChannels>(call);
    return stops && std::any_of(synaptic.in.begin(), synaptic.in.end(),
                                [](const auto& channel) { return channel.fresh; });
  }

  void remember_sends(const machine::Event& event, const machine::Actions& actions, Ticks now) {
    const auto* called = std::get_if<machine::Called>(&event);
    const auto* send = called ? std::get_if<machine::Send>(&called->call) : nullptr;
    for (const machine::Notice& notice : actions.notices()) {
      const auto* result = std::get_if<machine::SendResult>(&notice);
      const bool awaits = send && send->reliable && result && result->seq_num != machine::kNoSeq;
      if (awaits) sent_.push_back({result->seq_num, now});
      const auto* ack = std::get_if<machine::AckReceived>(&notice);
      if (ack) ended(ack->seq_num, now);
    }
  }

  void ended(std::uint16_t seq_num, Ticks now) {
    std::erase_if(sent_, [&](const Sent& one) {
      const Ticks soonest = one.called + machine::kPaper.ack_timeout_ticks;
      if (one.seq_num == seq_num && now > soonest) free_at(soonest);
      return one.seq_num == seq_num;
    });
  }

  // The timeout counts from the call, or from when the message has left (decision 110).
  void late_sends(Ticks now) {
    for (const Sent& one : sent_) {
      const Ticks soonest = one.called + machine::kPaper.ack_timeout_ticks;
      for (const machine::Awaited& awaited : state_.awaited) {
        if (awaited.seq_num != one.seq_num || now < soonest) continue;
        const bool left_late = awaited.due != 0 && awaited.due != soonest;
        if (left_late || explore::waits_for_line(state_, one.seq_num)) free_at(soonest);
      }
    }
  }
  void free_at(Ticks time) { free_ = std::min(time, free_.value_or(time)); }

  std::optional<Ticks> free_;
  std::optional<Ticks> had_room_at_;  ///< When a full outgoing buffer last got room.
  std::vector<Sent> sent_;
};

// Returns the script without everything from that tick on.
Script before(Script script, Ticks end) {
  Ticks now = 0;
  std::size_t kept = 0;
  while (kept < script.steps.size() && now + script.steps[kept].delay < end) {
    now += script.steps[kept++].delay;
  }
  script.steps.resize(kept);
  script.rest = end == 0 ? 0 : end - 1 - now;
  return script;
}

// Returns where a frame that the node hears has the number that it answers; null if nowhere.
std::uint8_t* answered_number(const Frame& frame, std::vector<std::uint8_t>& bytes) {
  using Reply = rubicon::JoinReplyLayout::SeqNumAt;
  if (frame.type == am::kJoinReply && bytes.size() >= Reply::kEnd) return bytes.data() + Reply::kAt;
  const auto message = rubicon::NetMsgView::parse(Bytes(bytes.data(), bytes.size()));
  if (frame.type != am::kNet || !message) return nullptr;
  const Bytes payload = message->payload();
  if (trans_id_of(payload) != component::kRubiconAck || !is_ack_body(payload.from(kBodyAt))) {
    return nullptr;
  }
  const bool with_code = payload.size() >= kBodyAt + kDeployedAckBytes;
  return bytes.data() + rubicon::NetMsgLayout::PayloadAt::kAt + kBodyAt +
         (with_code ? DeployedAck::SeqNumAt::kAt : PaperAck::kAt);
}

void add_numbers(const Output& output, std::set<std::uint16_t>& numbers) {
  if (const auto number = number_sent(output)) numbers.insert(*number);
  const auto request = rubicon::JoinRequestView::parse(output.frame.bytes());
  if (output.is_frame && output.frame.type == am::kJoin && request) {
    numbers.insert(request->seq_num());
  }
}

}  // namespace

Script without_guesses(Script script, flaws::StepFunction step) {
  runner::SubjectTarget target(std::make_unique<Probe>(step));
  const Played played = play(script, target);
  std::set<std::uint16_t> numbers;
  std::size_t shown = 0;
  for (std::size_t i = 0; i < script.steps.size(); ++i) {
    for (; shown < played.before[i]; ++shown) add_numbers(played.outputs[shown], numbers);
    Step& one = script.steps[i];
    const auto* heard = std::get_if<machine::Heard>(&one.event);
    std::uint8_t* const number = heard ? answered_number(heard->frame, one.bytes) : nullptr;
    if (!number || numbers.contains(PaperAck::load(number))) continue;
    constexpr std::uint16_t kFar = 0x4000;  // No script lets a node use so many.
    PaperAck::store(number, static_cast<std::uint16_t>(script.config.first_seq - kFar));
  }
  return script;
}

Script without_undecided(const Script& script) {
  Script out{.config = script.config, .rest = script.rest};
  const std::uint8_t channels = out.config.profile.channels_max;
  out.config.profile = machine::kPaper;
  out.config.profile.channels_max = channels;
  bool app_busy = false;
  Ticks owed = 0;  // For the steps that are left out.
  for (const Step& step : script.steps) {
    const machine::Event event = step.event_with_bytes();
    bool decided = true;
    if (const auto* app = std::get_if<machine::AppBusy>(&event)) app_busy = app->busy;
    const bool lost = std::holds_alternative<machine::Reboot>(event) ||
                      std::holds_alternative<machine::PowerOff>(event);
    if (lost) app_busy = false;
    if (const auto* heard = std::get_if<machine::Heard>(&event)) {
      decided = is_decided(out.config, heard->frame, app_busy);
    } else if (const auto* called = std::get_if<machine::Called>(&event)) {
      decided = is_decided(out.config, called->call);
    }
    owed += step.delay;
    if (!decided) continue;
    out.steps.push_back(step);
    out.steps.back().delay = std::exchange(owed, 0);
  }
  out.rest += owed;
  return out;
}

Script until_free(Script script, flaws::StepFunction step) {
  for (;;) {
    auto subject = std::make_unique<Probe>(step);
    Probe& probe = *subject;
    runner::SubjectTarget target(std::move(subject));
    play(script, target);
    probe.finish(script.length());
    if (!probe.free()) return script;
    script = before(std::move(script), *probe.free());
  }
}

}  // namespace rubric::script
