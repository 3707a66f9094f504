// The node of conformance/node as a station's layer.
#pragma once

#include "conformance/node/node.h"
#include "conformance/node/refusal.h"
#include "conformance/node/silence.h"
#include "tools/commands/run/layer.h"

namespace rubric::run {

class OwnLayer final : public Layer, private node::Driver, private node::Application {
 public:
  /// `setup.now` is 0. `gone_after`: the silence after which a mote has left; 0: never.
  OwnLayer(const node::Setup& setup, node::Ticks gone_after, LayerUser& user);

  std::optional<node::Ticks> run(node::Ticks now) override;
  void received(node::Line line, Bytes packet) override;
  void sent(node::Line line, bool acked) override { node_.sent(line, acked); }
  std::optional<machine::Notice> call(const machine::Call& call) override;
  bool listens() const override { return node_.interface_is_on(node::Line::kRadio); }
  std::uint16_t island() const override { return node_.address().pid; }
  std::size_t full_list() const override { return node_.list_is_full() ? node_.members() : 0; }
  std::size_t dropped() const override { return dropped_; }
  node::Refusal refusal(const machine::Send& send) const override;

 private:
  // node::Driver
  void transmit(node::Line line, Bytes packet, bool link_ack) override;
  // node::Application
  void joined(node::Address own, bool success) override;
  void mote_joined(node::Address mote, const node::Descriptor& descriptor) override;
  void mote_left(node::Address mote) override;
  void received(node::Address src, std::uint8_t app_id, Bytes data) override;
  void ack_received(std::uint8_t app_id, std::uint16_t seq_num, bool success) override;
  void syn_data_received(node::ChannelId channel, node::DataStatus status) override;

  LayerUser& user_;
  node::Role role_;
  node::Ticks now_ = 0;
  std::size_t dropped_ = 0;
  node::SizedNode<node::AnySizes> node_;
  node::Silence<255> silence_;
};

}  // namespace rubric::run
