// A flawed machine that tests of nodes on a line once let pass.
#pragma once

#include <algorithm>

#include "codec/generated/rubicon/app_msg.h"
#include "codec/generated/rubicon/net_msg.h"
#include "codec/generated/rubicon/rubicon_ack.h"
#include "conformance/machine/messages.h"
#include "conformance/test/runner/subject.h"

namespace rubric::targets {

/// Acks whatever it hears on its serial line: unreliable messages, broadcasts, what is for others,
/// and messages of a TRANSID that nobody knows. (T2-UNRELIABLE, T2-BROADCAST, T2-CONTENT,
/// T1-UNKNOWN)
class Overacking : public runner::Machine {
 public:
  void start(const machine::Config& config) override {
    Machine::start(config);
    const bool is_sink = config.role == machine::Role::kSink;
    devid_ = is_sink ? config.id : machine::kNullDevid;
    am_dest_ = is_sink ? 0xFFFF : 1;
  }
  void step(machine::Ticks now, const machine::Event& event, machine::Actions& actions) override {
    Machine::step(now, event, actions);
    const auto* const heard = std::get_if<machine::Heard>(&event);
    if (!heard || heard->frame.link != machine::Link::kSerial) return;
    const auto message = rubicon::NetMsgView::parse(heard->frame.payload);
    if (heard->frame.type != machine::am::kNet || !message) return;
    const auto trans_id = rubicon::AppMsgLayout::TransIdAt::load(message->payload().data());
    const bool is_ack = trans_id == rubicon::Component::kRubiconAck;
    const bool is_owed = message->reliable() == 1 && trans_id == rubicon::Component::kConnless &&
                         machine::address_of(message->dest()) == self();
    if (!is_ack && !is_owed) ack(*message, actions);
  }

 private:
  void ack(rubicon::NetMsgView message, machine::Actions& actions) const {
    rubicon::RubiconAck ack;
    ack.type = rubicon::AmType::kLearningNotification;
    ack.seq_num = message.seq_num();
    std::uint8_t body[rubicon::RubiconAckView::kMaxSizeBytes];
    rubicon::RubiconAckLayout::store(ack, body);
    rubicon::AppMsg app;
    app.trans_id = rubicon::Component::kRubiconAck;
    app.app_id = rubicon::AppMsgLayout::AppIdAt::load(message.payload().data());
    app.payload = Bytes(body, sizeof body);
    std::uint8_t payload[2 + sizeof body];
    rubicon::AppMsgLayout::store(app, payload);
    rubicon::NetMsg wire;
    wire.dest = message.src().to_value();
    wire.src = machine::wire_of(self());
    wire.payload = Bytes(payload, sizeof payload);
    machine::Transmit& out = actions.transmit(ReqId::kNone);
    out.link = machine::Link::kSerial;
    out.type = machine::am::kNet;
    out.dest = am_dest_;
    out.payload.fill(0);
    out.size_bytes = static_cast<std::uint8_t>(out.payload.size());
    rubicon::NetMsgLayout::store(wire, out.payload.data());
  }

  machine::Address self() const { return {state().island, devid_}; }

  std::uint16_t devid_ = 0;
  std::uint16_t am_dest_ = 0;
};

}  // namespace rubric::targets
