#include "tools/commands/run/own_layer.h"

#include "tools/commands/run/calls.h"

namespace rubric::run {

OwnLayer::OwnLayer(const node::Setup& setup, node::Ticks gone_after, LayerUser& user)
    : user_(user), role_(setup.role), node_(*this, *this) {
  node_.start(setup);
  silence_.start(gone_after);
}

std::optional<node::Ticks> OwnLayer::run(node::Ticks now) {
  now_ = now;
  node::Ticks due = 0;
  bool runs = node_.run(now, due);
  node::Ticks gone = 0;
  if (silence_.run(node_, *this, now, gone)) {
    if (!runs || node::is_reached(gone, due)) due = gone;
    runs = true;
  }
  return runs ? std::optional(due) : std::nullopt;
}

void OwnLayer::received(node::Line line, Bytes packet) {
  node_.received(line, packet);
  silence_.received(node_, role_, line, packet, now_);
}

std::optional<machine::Notice> OwnLayer::call(const machine::Call& call) {
  return perform(call, node_);
}

void OwnLayer::transmit(node::Line line, Bytes packet, bool link_ack) {
  user_.transmit(line, packet, link_ack);
}

void OwnLayer::joined(node::Address own, bool success) {
  user_.happened(machine::Joined{address_of(own), success});
}

void OwnLayer::mote_joined(node::Address mote, const node::Descriptor& descriptor) {
  user_.happened(machine::MoteJoined{address_of(mote), descriptor_of(descriptor)});
}

void OwnLayer::mote_left(node::Address mote) {
  user_.happened(machine::MoteLeft{address_of(mote)});
}

void OwnLayer::received(node::Address src, std::uint8_t app_id, Bytes data) {
  user_.happened(machine::Received{address_of(src), app_id, data});
}

void OwnLayer::ack_received(std::uint8_t app_id, std::uint16_t seq_num, bool success) {
  user_.happened(machine::AckReceived{app_id, seq_num, success});
}

void OwnLayer::syn_data_received(node::ChannelId channel, node::DataStatus status) {
  user_.happened(machine::SynDataReceived{channel, static_cast<machine::DataStatus>(status)});
}

}  // namespace rubric::run
