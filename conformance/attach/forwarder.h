// A TinyOS serial forwarder over TCP, either end of it.
#pragma once

#include <deque>
#include <functional>

#include "conformance/attach/packet_line.h"
#include "conformance/attach/stream.h"

namespace rubric::attach {

class ForwarderLine : public PacketLine {
 public:
  /// Makes the connection before a deadline, or throws runner::TargetBroken.
  using Connect = std::function<ByteStream(SteadyTime deadline)>;
  explicit ForwarderLine(Connect connect) : connect_(std::move(connect)) {}

  void open(SteadyTime deadline) override;
  void close() override;
  void send(const std::vector<std::uint8_t>& packet, SteadyTime deadline) override;
  std::optional<TimedPacket> receive(SteadyTime deadline) override;

 private:
  bool read_more(SteadyTime deadline);
  void shake_hands(SteadyTime deadline);

  Connect connect_;
  ByteStream stream_;
  std::vector<std::uint8_t> bytes_;  // Read and not yet a whole packet.
};

}  // namespace rubric::attach
