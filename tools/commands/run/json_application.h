// An application as JSON lines: calls of the node come in, its events go out, by the names of .rtr.
#pragma once

#include <cstdio>
#include <string>

#include "conformance/node/node.h"

namespace rubric::run {

/// Writes events to stdout, each at once.
class JsonApplication final : public node::Application {
 public:
  void joined(node::Address own, bool success) override;
  void mote_joined(node::Address mote, const node::Descriptor& descriptor) override;
  void received(node::Address src, std::uint8_t app_id, Bytes data) override;
  void ack_received(std::uint8_t app_id, std::uint16_t seq_num, bool success) override;
  void syn_data_received(node::ChannelId channel, node::DataStatus status) override;

  /// Makes the call of a line, such as {"call":"send","dest":"11:1","app_id":10,"reliable":true,
  /// "data":"0102"}, and writes its result; of a line that makes no sense, why.
  void call(const std::string& line, node::Node& node);

  /// Returns whether the last joined event was a refusal, once.
  bool take_refusal();
  /// Returns whether stdout has a reader.
  bool has_reader() const { return std::ferror(stdout) == 0; }

 private:
  bool refused_ = false;
};

}  // namespace rubric::run
