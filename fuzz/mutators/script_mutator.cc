#include "fuzz/mutators/script_mutator.h"

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "codec/generated/rubicon/ack_join.h"
#include "codec/generated/rubicon/join_reply.h"
#include "codec/generated/rubicon/join_request.h"
#include "codec/generated/rubicon/messages.h"
#include "codec/generated/rubicon/net_msg.h"
#include "codec/generated/rubicon/radio_i_frame.h"
#include "codec/generated/rubicon/radio_t_frame.h"
#include "codec/generated/rubicon/rubicon_ack.h"
#include "codec/reflect/am_frames.h"
#include "codec/reflect/registry.h"
#include "conformance/machine/messages.h"
#include "conformance/selftest/scripts/bytes.h"
#include "conformance/test/runner/subject_target.h"

namespace rubric::fuzz {
namespace {

using machine::Frame;
using machine::Link;
using machine::Role;
using machine::Transmit;
using script::Script;
using script::Step;
namespace am = machine::am;

using reflect::kAmHeaderBytes;
using rubicon::NetMsgLayout;

template <class Value>
std::vector<std::uint8_t> bytes_of(const Value& value) {
  std::vector<std::uint8_t> bytes(machine::kAmPayloadMax);
  const auto written = write(value, MutableBytes(bytes.data(), bytes.size()));
  bytes.resize(written ? written->size() : 0);
  return bytes;
}

const reflect::Protocol& protocol() { return *reflect::find_protocol("rubicon"); }

void store_address(std::vector<std::uint8_t>& payload, std::size_t at, machine::Address address) {
  rubicon::RAddrLayout::store(machine::wire_of(address), payload.data() + at);
}

Step heard(const Frame& frame, std::vector<std::uint8_t> payload) {
  payload.resize(std::min<std::size_t>(payload.size(), machine::kAmPayloadMax));
  return {0, machine::Heard{frame}, std::move(payload)};
}

// Returns the serial form of a frame, whatever line brings it: the table has it for every message.
std::vector<std::uint8_t> packet_of(const Frame& frame, const std::vector<std::uint8_t>& payload) {
  return reflect::serial_packet({.dest = frame.dest, .src = frame.src, .type = frame.type},
                                Bytes(payload.data(), payload.size()));
}

}  // namespace

// Notes what is due before each step, as play() gives it.
class ScriptMutator::Recorder : public runner::SubjectTarget {
 public:
  explicit Recorder(std::vector<Moment>& out)
      : SubjectTarget(std::make_unique<runner::Machine>()), out_(out) {}
  void give(machine::Ticks now, const machine::Event& event) override {
    out_.push_back({now, outputs().size(), next()});
    SubjectTarget::give(now, event);
  }

 private:
  std::vector<Moment>& out_;
};

ScriptMutator::ScriptMutator(std::uint64_t seed)
    : generator_(protocol(), rubicon::messages::kRoutes, seed) {
  for (std::size_t i = 0; i < rubicon::messages::kRoutes.count; ++i) {
    const reflect::Route& route = rubicon::messages::kRoutes.routes[i];
    try {
      generator_.valid(route);
      routes_.push_back(&route);
    } catch (const std::logic_error&) {  // No frame takes it.
    }
  }
}

void ScriptMutator::mutate(Script& script) {
  for (std::size_t changes = 1 + below(4); changes > 0; --changes) change(script);
  const std::vector<std::uint8_t> bytes = script::encode(script);
  script = script::decode(Bytes(bytes.data(), bytes.size()));
}

void ScriptMutator::change(Script& script) {
  std::vector<Step>& steps = script.steps;
  if (steps.empty()) return insert(script);
  const auto place = [&] {
    return steps.begin() + static_cast<std::ptrdiff_t>(below(steps.size()));
  };
  switch (below(12)) {
    case 0: {
      const Step copy = *place();
      steps.insert(place(), copy);
      return;
    }
    case 1: steps.erase(place()); return;
    case 2: std::swap(*place(), *place()); return;
    case 3:
    case 4: return change_delay(script);
    case 5:
    case 6: return change_field(script);
    case 7: steps.insert(place(), happening(script)); return;
    default: return insert(script);
  }
}

ScriptMutator::History ScriptMutator::history_of(const Script& script) {
  History history;
  Recorder recorder(history.before);
  history.outputs = script::play(script, recorder).outputs;
  history.before.push_back({script.length(), history.outputs.size(), recorder.next()});
  return history;
}

void ScriptMutator::insert(Script& script) {
  const History history = history_of(script);
  const std::size_t at = below(script.steps.size() + 1);
  std::optional<Step> step;
  if (!one_in(3)) step = answer(script, history, at);
  if (!step) step = message(script, history, at);
  step->delay = static_cast<machine::Ticks>(below(12));
  script.steps.insert(script.steps.begin() + static_cast<std::ptrdiff_t>(at), std::move(*step));
}

// Returns an answer to one of the last frames that the node has sent before that step.
std::optional<Step> ScriptMutator::answer(const Script& script, const History& history,
                                          std::size_t at) {
  const std::size_t shown = history.before[at].outputs;
  for (std::size_t tries = 0; tries < 4 && shown > 0; ++tries) {
    const std::size_t back = below(std::min<std::size_t>(shown, 6));
    const runner::Output& output = history.outputs[shown - 1 - back];
    if (!output.is_frame) continue;
    if (auto step = answer_to(script, output.frame)) return step;
  }
  return {};
}

std::optional<Step> ScriptMutator::answer_to(const Script& script, const Transmit& sent) {
  const machine::Config& config = script.config;
  Frame frame{sent.link, sent.src, sent.dest, 0, {}};
  if (sent.type == am::kJoin) {
    const auto request = rubicon::JoinRequestView::parse(sent.bytes());
    if (!request) return {};
    rubicon::JoinReply reply;
    reply.island_addr = static_cast<std::uint16_t>(11 + below(2));
    reply.mote_addr = config.id;
    reply.cur_time = static_cast<std::uint32_t>(below(100000));
    reply.seq_num = static_cast<std::uint16_t>(request->seq_num() - (one_in(6) ? 1U : 0U));
    frame.type = am::kJoinReply;
    return heard(frame, bytes_of(reply));
  }
  if (sent.type == am::kJoinReply) {
    const auto reply = rubicon::JoinReplyView::parse(sent.bytes());
    if (!reply) return {};
    rubicon::AckJoin ack;
    ack.dest = machine::wire_of(machine::Address{reply->island_addr(), config.id});
    ack.src = machine::wire_of(machine::Address{reply->island_addr(), sent.dest});
    ack.seq_num = static_cast<std::uint16_t>(reply->seq_num() - (one_in(6) ? 1U : 0U));
    frame.type = am::kAckJoin;
    return heard(frame, bytes_of(ack));
  }
  const auto message = rubicon::NetMsgView::parse(sent.bytes());
  if (sent.type != am::kNet || !message) return {};
  // An ack, from the message's destination.
  rubicon::RubiconAck body;
  body.type = rubicon::AmType::kLearningNotification;
  body.seq_num = message->seq_num();
  std::vector<std::uint8_t> payload{machine::component::kRubiconAck,
                                    message->payload()[rubicon::AppMsgLayout::AppIdAt::kAt]};
  const std::vector<std::uint8_t> written = bytes_of(body);
  payload.insert(payload.end(), written.begin(), written.end());
  rubicon::NetMsg ack;
  ack.dest = message->src().to_value();
  ack.src = message->dest().to_value();
  ack.seq_num = static_cast<std::uint16_t>(below(200));
  ack.payload = Bytes(payload.data(), payload.size());
  frame.type = am::kNet;
  if (sent.link == Link::kPeis) std::swap(frame.dest, frame.src);
  return heard(frame, bytes_of(ack));
}

// Returns a message from the table, mostly valid, for this node and from an earlier sender.
Step ScriptMutator::message(const Script& script, const History& history, std::size_t at) {
  const reflect::Route& route = *routes_[below(routes_.size())];
  const generate::Generated made =
      one_in(5) ? generator_.near_valid(route) : generator_.valid(route);
  const bool radio = made.framing == Framing::kRadio;
  // The AM type follows the 802.15.4 header, in most networks after their own byte.
  std::size_t begin = kAmHeaderBytes;
  if (radio) {
    const bool network = std::string_view(route.carrier) == "radio_i";
    begin = network ? rubicon::RadioIFrameLayout::PayloadAt::kAt
                    : rubicon::RadioTFrameLayout::PayloadAt::kAt;
  }
  Frame frame;
  std::vector<std::uint8_t> payload;
  if (made.bytes.size() > begin) {
    frame.type = made.bytes[begin - 1];
    payload.assign(made.bytes.begin() + static_cast<std::ptrdiff_t>(begin), made.bytes.end());
  }
  const Role role = script.config.role;
  frame.link = role == Role::kMote ? Link::kRadio : Link::kSerial;
  if (role == Role::kSink && !one_in(3)) frame.link = Link::kRadio;
  if (role == Role::kBaseStation && one_in(2)) frame.link = Link::kPeis;
  fit_message(script, history, at, frame, payload);
  return heard(frame, std::move(payload));
}

void ScriptMutator::fit_message(const Script& script, const History& history, std::size_t at,
                                Frame& frame, std::vector<std::uint8_t>& payload) {
  const machine::Config& config = script.config;
  const bool peis = frame.link == Link::kPeis;
  frame.dest = one_in(12) ? machine::kAmBroadcast : peis ? config.island : config.id;
  frame.src = static_cast<std::uint16_t>(one_in(4) ? 1 : 2 + below(8));
  // Addresses and numbers of frames that the node sent or received.
  const std::size_t shown = history.before[at].outputs;
  if (frame.type != am::kNet || payload.size() < NetMsgLayout::SeqNumAt::kEnd) return;
  const std::uint16_t island = config.role == Role::kMote ? 11 : config.island;
  if (!one_in(6)) {
    const auto own = config.role == Role::kBaseStation ? machine::kNullDevid : config.id;
    const std::uint16_t dest = one_in(4) ? std::uint16_t{machine::kBroadcastDevid} : own;
    store_address(payload, NetMsgLayout::DestAt::kAt, {island, dest});
    store_address(payload, NetMsgLayout::SrcAt::kAt, {island, frame.src});
  }
  if (shown == 0) return;
  const runner::Output& output = history.outputs[below(shown)];
  const auto sent = rubicon::NetMsgView::parse(output.frame.bytes());
  if (!output.is_frame || output.frame.type != am::kNet || !sent) return;
  if (one_in(2)) NetMsgLayout::SeqNumAt::store(payload.data(), sent->seq_num());
  if (one_in(2)) {
    store_address(payload, NetMsgLayout::SrcAt::kAt, machine::address_of(sent->dest()));
  }
}

// Returns a call, a busy line, power: a kind of step with small numbers in it.
Step ScriptMutator::happening(const Script& script) {
  Script head{script.config, {}, 0};
  std::vector<std::uint8_t> bytes = script::encode(head);
  constexpr std::uint8_t kFirst = 5;
  constexpr std::size_t kKinds = 20;  // Apart from frames, see bytes.cc.
  bytes.push_back(static_cast<std::uint8_t>(kFirst + below(kKinds)));
  bytes.push_back(0);
  bytes.push_back(static_cast<std::uint8_t>(below(60)));
  const std::uint8_t island = static_cast<std::uint8_t>(11 + below(2));
  const std::uint8_t device = static_cast<std::uint8_t>(1 + below(9));
  for (const std::uint8_t byte : {std::uint8_t{0}, island, std::uint8_t{0}, device}) {
    bytes.push_back(byte);
  }
  for (int i = 0; i < 12; ++i) bytes.push_back(static_cast<std::uint8_t>(below(12)));
  const Script one = script::decode(Bytes(bytes.data(), bytes.size()));
  return one.steps.at(0);
}

// Sets a delay to when something is due, just before it or just after; or to anything.
void ScriptMutator::change_delay(Script& script) {
  const std::size_t at = below(script.steps.size());
  machine::Ticks& delay = script.steps[at].delay;
  constexpr machine::Ticks kSome[] = {0, 1, 5, 10, 60, 300, 350, 500, 501, 1000, 3000};
  if (one_in(3)) {
    delay = kSome[below(std::size(kSome))];
    return;
  }
  const History history = history_of(script);
  const machine::Ticks before = at == 0 ? 0 : history.before[at - 1].now;
  const std::optional<machine::Ticks> due = at == 0 ? std::nullopt : history.before[at].due;
  if (!due || *due < before) return;
  const machine::Ticks wait = *due - before + static_cast<machine::Ticks>(below(3));
  delay = script::fitting_delay(wait == 0 ? 0 : wait - 1);
}

void ScriptMutator::change_field(Script& script) {
  Step& step = script.steps[below(script.steps.size())];
  auto* const frame = std::get_if<machine::Heard>(&step.event);
  if (frame != nullptr && !one_in(4)) {
    std::vector<std::uint8_t> packet = packet_of(frame->frame, step.bytes);
    constexpr std::size_t kMax = kAmHeaderBytes + machine::kAmPayloadMax;
    if (!generate::change_field(protocol(), Framing::kSf, packet, kMax, random())) return;
    if (packet.size() < kAmHeaderBytes) return;
    frame->frame.dest = tinyos::AmHeaderLayout::DestAt::load(packet.data());
    frame->frame.src = tinyos::AmHeaderLayout::SrcAt::load(packet.data());
    frame->frame.type = tinyos::AmHeaderLayout::TypeAt::load(packet.data());
    step.bytes.assign(packet.begin() + kAmHeaderBytes, packet.end());
    return;
  }
  // A byte of the step itself.
  const std::size_t at = static_cast<std::size_t>(&step - script.steps.data());
  const std::vector<std::size_t> offsets = script::step_offsets(script);
  std::vector<std::uint8_t> bytes = script::encode(script);
  const std::size_t size = offsets[at + 1] - offsets[at];
  std::uint8_t& byte = bytes[offsets[at] + below(size)];
  byte = static_cast<std::uint8_t>(one_in(2) ? below(20) : byte + (one_in(2) ? 1U : 255U));
  script = script::decode(Bytes(bytes.data(), bytes.size()));
}

Script ScriptMutator::cross_over(const Script& one, const Script& other) {
  Script out = one;
  if (one_in(2)) {
    out.steps.resize(below(one.steps.size() + 1));
    const std::size_t from = below(other.steps.size() + 1);
    out.steps.insert(out.steps.end(), other.steps.begin() + static_cast<std::ptrdiff_t>(from),
                     other.steps.end());
  } else {
    out.steps.clear();
    for (std::size_t i = 0; i < std::max(one.steps.size(), other.steps.size()); ++i) {
      if (i < one.steps.size() && !one_in(4)) out.steps.push_back(one.steps[i]);
      if (i < other.steps.size() && one_in(2)) out.steps.push_back(other.steps[i]);
    }
  }
  const std::vector<std::uint8_t> bytes = script::encode(out);
  return script::decode(Bytes(bytes.data(), bytes.size()));
}

}  // namespace rubric::fuzz
