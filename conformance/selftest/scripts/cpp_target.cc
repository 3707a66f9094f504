#include "conformance/selftest/scripts/cpp_target.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "conformance/adapters/cpp/base_station.h"
#include "conformance/adapters/cpp/mote.h"
#include "conformance/adapters/cpp/sink.h"
#include "conformance/test/runner/subject_target.h"

namespace rubric::script {
namespace {

using machine::Address;
using machine::Link;
using machine::Notice;
using machine::Role;
using runner::Output;
using runner::Ticks;
namespace node = cpp_node;

constexpr int kRunsAtOnceMax = 1000;

node::Line node_line(Link link) { return static_cast<node::Line>(link); }
Link link_of(node::Line line) { return static_cast<Link>(line); }
node::Address address_of(Address one) { return {one.pid, one.devid}; }
Address address_of(node::Address one) { return {one.island, one.device}; }

class CppTarget : public runner::Target, public node::World {
 public:
  void reset(const machine::Config& config) override {
    role_ = config.role;
    settings_ = {};
    settings_.device = config.id;
    settings_.island = config.island;
    settings_.channels = config.profile.channels_max;
    settings_.next_number = config.first_seq;
    lines_ = {};
    outputs_.clear();
    now_ = 0;
    start();
  }

  void give(Ticks now, const machine::Event& event) override {
    while (run_until(now) < now) {
    }
    pass(now);
    std::visit([this](const auto& one) { happens(one); }, event);
  }

  std::optional<Ticks> next() const override {
    std::optional<Ticks> soonest;
    const auto take = [&](Ticks due) { soonest = std::min(due, soonest.value_or(due)); };
    for (const Line& line : lines_) {
      if (line.ends) take(*line.ends);
    }
    if (!node_) return soonest;
    if (const auto due = node_->due()) take(std::max(static_cast<Ticks>(*due), now_));
    return soonest;
  }

  Ticks run_until(Ticks time) override {
    const std::size_t before = outputs_.size();
    int at_once = 0;
    while (const auto soonest = next()) {
      const bool emitted = outputs_.size() > before;
      if (*soonest > time || (emitted && *soonest > now_)) break;
      at_once = *soonest == now_ ? at_once + 1 : 0;
      if (at_once > kRunsAtOnceMax) throw runner::TargetBroken("it is due for ever");
      pass(*soonest);
      if (!end_one()) node_->run_due();
    }
    if (outputs_.size() > before) return now_;
    pass(time);
    return time;
  }

  const std::vector<Output>& outputs() const override { return outputs_; }
  void hold_link_acks(bool hold) override { hold_link_acks_ = hold; }

 private:
  struct Line {
    bool taken = false;         // By another station,
    bool sending = false;       // or by the node's own frame,
    bool unconfirmed = false;   // which asked for a link ack,
    std::optional<Ticks> ends;  // and ends by itself.
  };
  Line& at(Link link) { return lines_[static_cast<std::size_t>(link)]; }

  void pass(Ticks time) {
    now_ = std::max(now_, time);
    if (node_) node_->set_time(now_);
  }

  void start() {
    settings_.now = now_;
    node_.reset();
    if (role_ == Role::kMote) node_ = std::make_unique<node::Mote>(settings_, *this);
    if (role_ == Role::kSink) node_ = std::make_unique<node::Sink>(settings_, *this);
    if (role_ == Role::kBaseStation) node_ = std::make_unique<node::BaseStation>(settings_, *this);
    for (const Link link : {Link::kRadio, Link::kSerial}) tell_busy(link);
  }
  void stop() {
    if (node_) settings_.next_number = node_->next_number();
    node_.reset();
    for (Line& line : lines_) line = {line.taken, false, false, {}};
  }

  void tell_busy(Link link) {
    if (node_) node_->set_busy(node_line(link), at(link).taken || at(link).sending);
  }

  // Ends one transmission that is due now; returns false if there is none.
  bool end_one() {
    for (const Link link : {Link::kRadio, Link::kSerial, Link::kPeis}) {
      if (at(link).ends != now_) continue;
      end(link, true);
      return true;
    }
    return false;
  }
  void end(Link link, bool acked) {
    Line& line = at(link);
    const bool unconfirmed = std::exchange(line.unconfirmed, false);
    line.sending = false;
    line.ends.reset();
    tell_busy(link);  // It sends nothing before it knows how the frame ended.
    if (unconfirmed && node_) node_->confirmed(acked);
  }

  // Events.
  void happens(const machine::Heard& heard) {
    if (!node_) return;
    const machine::Frame& frame = heard.frame;
    node::Frame given;
    given.dest = frame.dest;
    given.src = frame.src;
    given.type = static_cast<node::AmType>(frame.type);
    given.payload.assign(frame.payload.begin(), frame.payload.end());
    node_->heard(node_line(frame.link), given);
  }
  void happens(const machine::Called& called) {
    if (node_) std::visit([this](const auto& one) { call(one); }, called.call);
  }
  void happens(const machine::TimerDue&) {}  // Its timers are its own.
  void happens(const machine::SendDone& done) {
    if (at(done.link).sending) end(done.link, done.acked);
  }
  void happens(const machine::LinkBusy& busy) {
    at(busy.link).taken = busy.busy;
    tell_busy(busy.link);
  }
  void happens(const machine::AppBusy& busy) {
    if (node_) node_->set_application_busy(busy.busy);
  }
  void happens(const machine::Reboot&) {
    stop();
    start();
  }
  void happens(const machine::PowerOff&) { stop(); }

  // Calls.
  void result(bool success) { tell(machine::OperationResult{success}); }
  void call(const machine::JoinIsland& c) {
    node::MoteDesc description;
    description.mote_type = static_cast<rubicon::MoteType>(c.descriptor.mote_type);
    description.transducers = rubicon::TransducerMask(c.descriptor.transducers);
    description.actuators = rubicon::ActuatorMask(c.descriptor.actuators);
    node_->join(description);
  }
  void call(const machine::Send& c) {
    const auto application = static_cast<node::Component>(c.app_id);
    tell(machine::SendResult{node_->send(address_of(c.dest), application, c.reliable, c.data)});
  }
  void call(const machine::SetInterface& c) {
    result(node_->set_interface(node_line(c.link), c.on));
  }
  void call(const machine::GetInterface& c) {
    const auto on = node_->interface(node_line(c.link));
    if (!on) return result(false);
    tell(machine::InterfaceState{c.link, *on});
  }
  void call(const machine::CreateChannel& c) {
    const auto id = node_->create(static_cast<node::Direction>(c.direction), address_of(c.peer),
                                  c.size, static_cast<node::Mode>(c.mode));
    tell(machine::ChannelResult{id.value_or(0), id.has_value()});
  }
  void call(const machine::DisposeChannel& c) { result(node_->synaptic().dispose(c.id)); }
  void call(const machine::StartChannel& c) { result(node_->start_channel(c.id)); }
  void call(const machine::StopChannel& c) { result(node_->synaptic().stop(c.id)); }
  void call(const machine::StartAllChannels&) {
    node_->start_all_channels();
    result(true);
  }
  void call(const machine::StopAllChannels&) {
    node_->synaptic().stop_all();
    result(true);
  }
  void call(const machine::WriteOutput& c) {
    result(node_->synaptic().write(c.id, c.pos, c.value));
  }
  void call(const machine::ReadInput& c) {
    const auto value = node_->synaptic().read(c.id, c.pos);
    tell(machine::InputValue{value.value_or(0), value.has_value()});
  }
  void call(const machine::SetTimeStep& c) { result(node_->synaptic().set_period(c.ticks)); }
  void call(const machine::SetIslandId& c) { result(node_->set_island(c.island)); }
  void call(const machine::GetClock&) { tell(machine::Clock{node_->clock_ms()}); }

  // World.
  void transmit(node::Line which, const node::Frame& frame) override {
    const Link link = link_of(which);
    Output output;
    output.time = now_;
    output.is_frame = true;
    machine::Transmit& out = output.frame;
    out.link = link;
    out.link_ack = frame.link_ack;
    out.type = static_cast<std::uint8_t>(frame.type);
    out.dest = frame.dest;
    out.src = frame.src;
    const std::size_t size = std::min(frame.payload.size(), out.payload.size());
    out.size_bytes = static_cast<std::uint8_t>(size);
    std::copy_n(frame.payload.begin(), size, out.payload.begin());
    outputs_.push_back(output);
    if (link == Link::kPeis) return;
    Line& line = at(link);
    line.sending = true;
    line.unconfirmed = frame.link_ack;
    const bool held = frame.link_ack && hold_link_acks_;
    if (!held) line.ends = now_ + runner::transmission_ticks(link, size);
    tell_busy(link);
  }
  void joined(node::Address own, bool success) override {
    tell(machine::Joined{address_of(own), success});
  }
  void mote_joined(node::Address mote, const node::MoteDesc& description) override {
    tell(machine::MoteJoined{address_of(mote),
                             {static_cast<std::uint8_t>(description.mote_type),
                              description.actuators.raw(), description.transducers.raw()}});
  }
  void received(node::Address src, node::Component application, Bytes data) override {
    tell(machine::Received{address_of(src), static_cast<std::uint8_t>(application), {}});
    outputs_.back().data.assign(data.begin(), data.end());
  }
  void ack_received(node::Component application, std::uint16_t number, bool success) override {
    tell(machine::AckReceived{static_cast<std::uint8_t>(application), number, success});
  }
  void syn_data(node::ChannelId channel, node::DataStatus status) override {
    tell(machine::SynDataReceived{channel, static_cast<machine::DataStatus>(status)});
  }
  void tell(const Notice& notice) {
    Output output;
    output.time = now_;
    output.notice = notice;
    outputs_.push_back(std::move(output));
  }

  Role role_ = Role::kMote;
  node::Settings settings_;
  std::unique_ptr<node::Node> node_;  // None while the power is off.
  std::array<Line, 3> lines_;
  std::vector<Output> outputs_;
  Ticks now_ = 0;
  bool hold_link_acks_ = false;
};

}  // namespace

std::unique_ptr<runner::Target> cpp_target() { return std::make_unique<CppTarget>(); }

}  // namespace rubric::script
