#include "conformance/selftest/scripts/difference.h"

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "codec/generated/rubicon/net_msg.h"
#include "codec/generated/tinyos/am_header.h"
#include "conformance/machine/messages.h"
#include "conformance/node/node.h"
#include "conformance/selftest/scripts/rtr.h"
#include "conformance/test/runner/run_case.h"
#include "conformance/test/runner/subject_target.h"
#include "conformance/trace/encode.h"
#include "conformance/trace/events/lines.h"

namespace rubric::script {
namespace {

using machine::Address;
using machine::Link;
using machine::Notice;
using machine::Role;
using runner::Output;
using runner::Ticks;
using trace::FieldValue;
using trace::Line;
using trace::Value;

namespace am = machine::am;

constexpr std::size_t kOutputsMax = 4000;  // A clock of a tick could fill any memory.

FieldValue* field(Line& line, std::string_view path) {
  for (FieldValue& one : line.message.fields) {
    if (one.path == path) return &one;
  }
  return nullptr;
}

void free_field(Line& line, std::string_view path) {
  if (FieldValue* found = field(line, path)) found->value = Value::any();
}

// Lets a clock be a millisecond off, by how it rounds.
void loosen(FieldValue* found) {
  if (!found || !found->value.is(Value::Kind::kNumber)) return;
  const std::int64_t ms = found->value.number;
  constexpr std::int64_t kMax = 0xFFFFFFFF;
  found->value = Value::range(std::max<std::int64_t>(ms - 1, 0), std::min(ms + 1, kMax));
}

// Replaces the node's own numbers, which it chooses freely, by variables, one for each.
class Numbers {
 public:
  /// Returns the variable for this number, whose first use binds it.
  Value chosen(std::uint16_t number) {
    auto [at, fresh] = names_.try_emplace(number);
    if (fresh) at->second = "q" + std::to_string(++count_);
    return Value::variable(at->second);
  }
  /// Returns its variable; nothing if the node has not used the number.
  std::optional<Value> known(std::uint16_t number) const {
    const auto at = names_.find(number);
    if (at == names_.end()) return {};
    return Value::variable(at->second);
  }

 private:
  std::map<std::uint16_t, std::string> names_;
  int count_ = 0;
};

bool is_forwarded(const Output& output, const std::set<std::uint16_t>& sent) {
  for (const ReqId rule :
       {"N6-FORWARD"_rule, "N6-ROUTE"_rule, "N7-RADIO"_rule, "N8-INCOMING"_rule}) {
    if (output.requirement == rule) return true;
  }
  if (output.requirement != "N8-PEIS"_rule) return false;
  const auto message = rubicon::NetMsgView::parse(output.frame.bytes());
  return !message || !sent.contains(message->seq_num()) ||
         machine::address_of(message->src()).devid != machine::kNullDevid;
}

bool same(const Output& a, const Output& b) {
  if (a.time != b.time || a.is_frame != b.is_frame) return false;
  if (!a.is_frame) return line_of(a, "").message == line_of(b, "").message;
  return a.frame.link == b.frame.link && a.frame.type == b.frame.type &&
         a.frame.dest == b.frame.dest && a.frame.src == b.frame.src &&
         equal(a.frame.bytes(), b.frame.bytes());
}
bool same(const std::vector<Output>& a, const std::vector<Output>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Output& x, const Output& y) { return same(x, y); });
}

class Lenient {
 public:
  Lenient(const Script& script, const Played& played)
      : script_(script), played_(played), node_(node_of(script).name) {
    for (const Output& output : played.outputs) {
      if (const auto number = number_sent(output)) sent_.insert(*number);
    }
  }

  trace::File file(const Title& title) {
    return to_file(
        script_, played_, title, [&](const Output& output) { return expected(output); },
        [&](const Step& step, Ticks now) { return given(step, now); });
  }

 private:
  Line expected(const Output& output) {
    Line line = line_of(output, node_);
    line.bytes.reset();
    line.message.open = output.is_frame;
    if (output.is_frame) {
      loosen_frame(output, line);
    } else {
      loosen_news(line);
    }
    return line;
  }

  void loosen_frame(const Output& output, Line& line) {
    const std::uint8_t type = output.frame.type;
    if (output.frame.link == Link::kSerial) line.am.reset();  // Not compared (FACTS 2).
    if (type == am::kJoinReply) {
      // A reply that waited for the radio may have the time of its request.
      if (output.time != heard_at_) free_field(line, "cur_time");
      loosen(field(line, "cur_time"));
    }
    if (type == am::kJoin || type == am::kAckJoin) variable(line, "seq_num");
    if (type != am::kNet) return;
    if (is_forwarded(output, sent_)) {
      FieldValue* acked = field(line, "payload.body.seq_num");
      const bool changed = acked && answered_.contains(acked->value.number);
      if (changed) variable(line, "payload.body.seq_num");
    } else if (output.requirement == "T2-ACK"_rule || output.requirement == "S2-SEND"_rule ||
               output.requirement == "S3-CHANGED"_rule || output.requirement == "J6-REPORT"_rule) {
      free_field(line, "seq_num");
      // An ack holds the number alone, or a code as well (decision 108).
      FieldValue* const nbytes = field(line, "nbytes");
      if (nbytes && output.requirement == "T2-ACK"_rule) nbytes->value = Value::range(4, 6);
    } else {
      variable(line, "seq_num");
    }
  }

  void variable(Line& line, std::string_view path) {
    FieldValue* found = field(line, path);
    if (!found || !found->value.is(Value::Kind::kNumber)) return;
    found->value = numbers_.chosen(static_cast<std::uint16_t>(found->value.number));
  }

  void loosen_news(Line& line) {
    const std::string& name = line.message.name;
    const FieldValue* number = field(line, "seq_num");
    const FieldValue* result = field(line, "result");
    const bool success = result && result->value.text == "success";
    if (name == "send_result") {
      if (number->value.number != machine::kNoSeq) variable(line, "seq_num");
    } else if (name == "ack_received") {
      const auto acked = static_cast<std::uint16_t>(number->value.number);
      if (success && not_well_.contains(acked)) free_field(line, "result");
      variable(line, "seq_num");
    } else if (name == "joined") {
      if (!success) free_field(line, "address");
    } else if (name == "channel_result") {
      if (!success) free_field(line, "channel");
    } else if (name == "input_value") {
      if (!success) free_field(line, "value");
    } else if (name == "clock") {
      loosen(field(line, "ms"));
    }
  }

  // Returns the line of a step; a frame that answers the node has the number that the node chose.
  Line given(const Step& step, Ticks now) {
    const bool frame = std::holds_alternative<machine::Heard>(step.event);
    heard_at_ = frame ? std::optional<Ticks>(now) : std::nullopt;
    Line line = line_of(step, now, node_);
    // Success and failure are both right for it (decision 108).
    const FieldValue* code = field(line, "payload.body.ack");
    const FieldValue* acked = field(line, "payload.body.seq_num");
    if (code && acked && code->value.number != 0) {
      not_well_.insert(static_cast<std::uint16_t>(acked->value.number));
    }
    for (const std::string_view path : {"seq_num", "payload.body.seq_num"}) {
      FieldValue* found = field(line, path);
      const bool answers = line.message.name == "join_reply" || path != "seq_num";
      if (!found || !answers || !found->value.is(Value::Kind::kNumber)) continue;
      const auto known = numbers_.known(static_cast<std::uint16_t>(found->value.number));
      if (!known || !is_whole(line)) continue;
      answered_.insert(found->value.number);
      found->value = *known;
      line.bytes.reset();
    }
    return line;
  }

  // Returns whether the fields of a frame's line cover all its bytes, except for left-over ones at
  // the end.
  bool is_whole(Line line) const try {
    trace::AmFrame exact = trace::frame_of(line, {});
    line.bytes.reset();
    trace::AmFrame said = trace::frame_of(line, {});
    if (exact.payload.size() < said.payload.size()) return false;
    const std::size_t content = trace::encode(line.message).payload.size();
    exact.payload.resize(content);
    said.payload.resize(content);
    return said == exact;
  } catch (const trace::TraceError&) {
    return false;  // Its nbytes counts left-over bytes as well.
  }

  const Script& script_;
  const Played& played_;
  std::string node_;
  Numbers numbers_;
  std::set<std::uint16_t> sent_;      // Numbers that send returned,
  std::set<std::uint16_t> not_well_;  // and that were acked with a code other than 0.
  std::set<std::int64_t> answered_;   // Numbers for which a given frame has their variable.
  std::optional<Ticks> heard_at_;     // If the last step was a frame.
};

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
    boot();
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

  void boot() {
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
    if (node_) std::visit([this](const auto& one) { ask(one); }, called.call);
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
    boot();
  }
  void happens(const machine::PowerOff&) { stop(); }

  // Calls.
  void result(bool success) { tell(machine::OperationResult{success}); }
  void ask(const machine::JoinIsland& c) {
    node::Descriptor description;
    description.mote_type = static_cast<rubicon::MoteType>(c.descriptor.mote_type);
    description.transducers = rubicon::TransducerMask(c.descriptor.transducers);
    description.actuators = rubicon::ActuatorMask(c.descriptor.actuators);
    node_->join(description);
  }
  void ask(const machine::Send& c) {
    tell(machine::SendResult{node_->send(node_address(c.dest), c.app_id, c.reliable, c.data)});
  }
  void ask(const machine::SetInterface& c) {
    result(node_->set_interface(node_line(c.link), c.on));
  }
  void ask(const machine::GetInterface& c) {
    if (c.link == Link::kPeis) return result(false);
    tell(machine::InterfaceState{c.link, node_->interface_is_on(node_line(c.link))});
  }
  void ask(const machine::CreateChannel& c) {
    const bool out = c.direction == machine::Direction::kOut;
    const auto mode = static_cast<node::Mode>(c.mode);
    const node::Address peer = node_address(c.peer);
    const auto made =
        out ? node_->create_out(peer, c.size, mode) : node_->create_in(peer, c.size, mode);
    tell(machine::ChannelResult{made.id, made.success});
  }
  void ask(const machine::DisposeChannel& c) { result(node_->dispose(c.id)); }
  void ask(const machine::StartChannel& c) { result(node_->start_channel(c.id)); }
  void ask(const machine::StopChannel& c) { result(node_->stop_channel(c.id)); }
  void ask(const machine::StartAllChannels&) {
    node_->start_all();
    result(true);
  }
  void ask(const machine::StopAllChannels&) {
    node_->stop_all();
    result(true);
  }
  void ask(const machine::WriteOutput& c) { result(node_->write_output(c.id, c.pos, c.value)); }
  void ask(const machine::ReadInput& c) {
    const node::InputValue value = node_->read_input(c.id, c.pos);
    tell(machine::InputValue{value.value, value.success});
  }
  void ask(const machine::SetTimeStep& c) { result(node_->set_time_step(c.ticks)); }
  void ask(const machine::SetIslandId& c) { result(node_->set_island(c.island)); }
  void ask(const machine::GetClock&) { tell(machine::Clock{node_->clock_ms()}); }

  // What the node does.
  void transmit(node::Line which, Bytes packet, bool link_ack) override {
    const auto header = tinyos::AmHeaderView::parse(packet);
    const Link link = link_of(which);
    Output output{.time = now_, .is_frame = true};
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
    tell(machine::Received{address_of(src), app_id, data});
  }
  void ack_received(std::uint8_t app_id, std::uint16_t number, bool success) override {
    tell(machine::AckReceived{app_id, number, success});
  }
  void syn_data_received(node::ChannelId channel, node::DataStatus status) override {
    tell(machine::SynDataReceived{channel, static_cast<machine::DataStatus>(status)});
  }
  void tell(const Notice& notice) {
    Output output{.time = now_, .news = events::from_notice(notice)};
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

trace::File lenient_file(const Script& script, const Played& played, const Title& title) {
  return Lenient(script, played).file(title);
}

Difference difference(const Script& script, flaws::StepFunction step) {
  const Script compared = without_guesses(until_free(without_undecided(script), step), step);
  runner::SubjectTarget reference(std::make_unique<runner::Machine>(step));
  const Played played = play(compared, reference);
  Difference out{.steps = compared.steps.size()};
  if (played.outputs.size() > kOutputsMax) return out;
  const auto other = cpp_target();
  if (same(played.outputs, play(compared, *other).outputs)) return out;  // Mostly, and fast.
  out.file = lenient_file(compared, played, {"repro.difference", {}, {}});
  const runner::CaseResult result = runner::run_case(
      out.file, out.file.cases[0], [](const trace::NodeHeader&) { return cpp_target(); });
  if (result.verdict == runner::CaseVerdict::kPass) return out;
  if (result.verdict == runner::CaseVerdict::kWeak) return out;
  out.text = result.failures.empty() ? result.reason : runner::explain(result, "difference");
  return out;
}

std::unique_ptr<runner::Target> cpp_target() { return std::make_unique<CppTarget>(); }

}  // namespace rubric::script
