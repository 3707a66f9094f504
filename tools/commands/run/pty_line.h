// A sink's serial line as a pseudo-terminal, at which a host opens a serial device.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "codec/lines/packet_line.h"
#include "codec/lines/stream.h"
#include "codec/runtime/hdlc.h"

namespace rubric::run {

/// The mote's end: sends packets that need no confirmation, and confirms those that ask for it.
/// (TEP 113) What nobody reads is lost, as on a UART.
class PtyLine : public lines::PacketLine {
 public:
  /// Makes the device. Throws Broken.
  PtyLine();

  const std::string& device() const { return device_; }
  bool open(lines::SteadyTime deadline) override;
  void close() override { is_open_ = false; }
  void send(const std::vector<std::uint8_t>& packet, lines::SteadyTime deadline) override;
  std::optional<lines::TimedPacket> receive(lines::SteadyTime deadline) override;
  int fd() const override { return master_.get(); }

 private:
  void take(Bytes bytes);
  void write(Bytes frame);

  lines::Descriptor master_;
  lines::Descriptor device_end_;  // Held open, so that a host may come and go.
  std::string device_;
  bool is_open_ = false;
  std::uint8_t room_[512];
  HdlcDeframer deframer_{MutableBytes(room_, sizeof room_)};
  std::deque<lines::TimedPacket> packets_;
};

}  // namespace rubric::run
