#include "conformance/selftest/scripts/cpp_target.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "codec/generated/tinyos/am_header.h"
#include "conformance/node/node.h"
#include "conformance/test/runner/subject_target.h"
#include "conformance/trace/events/lines.h"

namespace rubric::script {
namespace {

using machine::Address;
using machine::Link;
using machine::Notice;
using machine::Role;
using runner::Output;
using runner::Ticks;

constexpr int kRunsAtOnceMax = 1000;

node::Line node_line(Link link) { return static_cast<node::Line>(link); }
Link link_of(node::Line line) { return static_cast<Link>(line); }
node::Address node_address(Address one) { return {one.pid, one.devid}; }
Address address_of(node::Address one) { return {one.pid, one.devid}; }

class CppTarget : public runner::Target, public node::Driver, public node::Application {
 public:
  void reset(const machine::Config& config) override {
    setup_ = {};
    if (config.role == Role::kSink) setup_.role = node::Role::kSink;
    if (config.role == Role::kBaseStation) setup_.role = node::Role::kBaseStation;
    setup_.id = config.id;
    setup_.island = config.island;
    setup_.channels = config.profile.channels_max;
    setup_.last_seq_num = static_cast<std::uint16_t>(config.first_seq - 1);
    lines_ = {};
    outputs_.clear();
    now_ = 0;
    start();
  }

  void give(Ticks now, const machine::Event& event) override {
    while (run_until(now) < now) {
    }
    pass(now);
    run();
    std::visit([this](const auto& one) { happens(one); }, event);
    run();
  }

  std::optional<Ticks> next() const override {
    std::optional<Ticks> soonest;
    const auto take = [&](Ticks due) { soonest = std::min(due, soonest.value_or(due)); };
    for (const Line& line : lines_) {
      if (line.ends) take(*line.ends);
    }
    if (due_) take(*due_);
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
      run();
      if (end_one()) run();
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
    std::optional<Ticks> ends;  // and ends by itself.
  };
  Line& at(Link link) { return lines_[static_cast<std::size_t>(link)]; }

  void pass(Ticks time) { now_ = std::max(now_, time); }

  // Does what is due now.
  void run() {
    const auto now = static_cast<node::Ticks>(now_);
    node::Ticks due = 0;
    due_.reset();
    if (node_ && node_->run(now, due)) due_ = now_ + (due - now);
  }

  void start() {
    setup_.now = static_cast<node::Ticks>(now_);
    node_.emplace(*this, *this);
    node_->start(setup_);
    for (const Link link : {Link::kRadio, Link::kSerial}) tell_busy(link);
  }
  void stop() {
    if (node_) setup_.last_seq_num = node_->last_seq_num();
    node_.reset();
    for (Line& line : lines_) line = {line.taken, false, {}};
  }

  void tell_busy(Link link) {
    const bool sending = at(link).sending && link != Link::kRadio;
    if (node_) node_->set_busy(node_line(link), at(link).taken || sending);
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
    line.sending = false;
    line.ends.reset();
    if (link != Link::kRadio) return tell_busy(link);
    if (node_) node_->sent(node_line(link), acked);
  }

  // Events.
  void happens(const machine::Heard& heard) {
    if (!node_) return;
    const std::vector<std::uint8_t> packet = events::packet_of(heard.frame);
    node_->received(node_line(heard.frame.link), Bytes(packet.data(), packet.size()));
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
    node::Descriptor description;
    description.mote_type = static_cast<rubicon::MoteType>(c.descriptor.mote_type);
    description.transducers = rubicon::TransducerMask(c.descriptor.transducers);
    description.actuators = rubicon::ActuatorMask(c.descriptor.actuators);
    node_->join(description);
  }
  void call(const machine::Send& c) {
    tell(machine::SendResult{node_->send(node_address(c.dest), c.app_id, c.reliable, c.data)});
  }
  void call(const machine::SetInterface& c) {
    result(node_->set_interface(node_line(c.link), c.on));
  }
  void call(const machine::GetInterface& c) {
    if (c.link == Link::kPeis) return result(false);
    tell(machine::InterfaceState{c.link, node_->interface_is_on(node_line(c.link))});
  }
  void call(const machine::CreateChannel& c) {
    const bool out = c.direction == machine::Direction::kOut;
    const auto mode = static_cast<node::Mode>(c.mode);
    const node::Address peer = node_address(c.peer);
    const auto made =
        out ? node_->create_out(peer, c.size, mode) : node_->create_in(peer, c.size, mode);
    tell(machine::ChannelResult{made.id, made.success});
  }
  void call(const machine::DisposeChannel& c) { result(node_->dispose(c.id)); }
  void call(const machine::StartChannel& c) { result(node_->start_channel(c.id)); }
  void call(const machine::StopChannel& c) { result(node_->stop_channel(c.id)); }
  void call(const machine::StartAllChannels&) {
    node_->start_all();
    result(true);
  }
  void call(const machine::StopAllChannels&) {
    node_->stop_all();
    result(true);
  }
  void call(const machine::WriteOutput& c) { result(node_->write_output(c.id, c.pos, c.value)); }
  void call(const machine::ReadInput& c) {
    const node::InputValue value = node_->read_input(c.id, c.pos);
    tell(machine::InputValue{value.value, value.success});
  }
  void call(const machine::SetTimeStep& c) { result(node_->set_time_step(c.ticks)); }
  void call(const machine::SetIslandId& c) { result(node_->set_island(c.island)); }
  void call(const machine::GetClock&) { tell(machine::Clock{node_->clock_ms()}); }

  // What the node does.
  void transmit(node::Line which, Bytes packet, bool link_ack) override {
    const auto header = tinyos::AmHeaderView::parse(packet);
    const Link link = link_of(which);
    Output output;
    output.time = now_;
    output.is_frame = true;
    machine::Transmit& out = output.frame;
    out.link = link;
    out.link_ack = link_ack;
    out.type = header->type();
    out.dest = header->dest();
    out.src = header->src();
    const Bytes payload = packet.from(tinyos::AmHeaderView::kMaxSizeBytes);
    const std::size_t size = std::min(payload.size(), out.payload.size());
    out.size_bytes = static_cast<std::uint8_t>(size);
    std::copy_n(payload.begin(), size, out.payload.begin());
    outputs_.push_back(output);
    if (link == Link::kPeis) return node_->sent(which, false);  // It takes no time.
    Line& line = at(link);
    line.sending = true;
    const bool held = link_ack && hold_link_acks_;
    if (!held) line.ends = now_ + runner::transmission_ticks(link, size);
    if (link == Link::kRadio) return;
    tell_busy(link);  // The line has taken a copy, as the machine's do.
    node_->sent(which, false);
  }
  void joined(node::Address own, bool success) override {
    tell(machine::Joined{address_of(own), success});
  }
  void mote_joined(node::Address mote, const node::Descriptor& description) override {
    tell(machine::MoteJoined{address_of(mote),
                             {static_cast<std::uint8_t>(description.mote_type),
                              description.actuators.raw(), description.transducers.raw()}});
  }
  void received(node::Address src, std::uint8_t app_id, Bytes data) override {
    tell(machine::Received{address_of(src), app_id, {}});
    outputs_.back().data.assign(data.begin(), data.end());
  }
  void ack_received(std::uint8_t app_id, std::uint16_t number, bool success) override {
    tell(machine::AckReceived{app_id, number, success});
  }
  void syn_data_received(node::ChannelId channel, node::DataStatus status) override {
    tell(machine::SynDataReceived{channel, static_cast<machine::DataStatus>(status)});
  }
  void tell(const Notice& notice) {
    Output output;
    output.time = now_;
    output.notice = notice;
    outputs_.push_back(std::move(output));
  }

  node::Setup setup_{};
  std::optional<node::SizedNode<node::AnySizes>> node_;  // None while the power is off.
  std::optional<Ticks> due_;
  std::array<Line, 3> lines_;
  std::vector<Output> outputs_;
  Ticks now_ = 0;
  bool hold_link_acks_ = false;
};

}  // namespace

std::unique_ptr<runner::Target> cpp_target() { return std::make_unique<CppTarget>(); }

}  // namespace rubric::script
