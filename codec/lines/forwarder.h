// A TinyOS serial forwarder over TCP, either end of it.
#pragma once

#include <optional>
#include <vector>

#include "codec/lines/stream.h"

namespace rubric::lines {

class ForwarderLine : public StreamLine {
 public:
  using StreamLine::StreamLine;

  void send(const std::vector<std::uint8_t>& packet, SteadyTime deadline) override;
  std::optional<TimedPacket> receive(SteadyTime deadline) override;

 private:
  void begin(SteadyTime deadline) override;
  void take(Bytes bytes) override;

  std::vector<std::uint8_t> bytes_;  // Read and not yet a whole packet.
};

}  // namespace rubric::lines
