// The serial line between a sink and its base station.
#pragma once

#include <cstdint>
#include <deque>
#include <string>

#include "conformance/selftest/lawful_traffic/message.h"

namespace rubric::lawful {

class World;
class Sink;
class BaseStation;

/// Host to mote is stop-and-wait with PACKET_ACK frames; mote to host is PACKET_NOACK frames.
/// Source: TEP 113.
class SerialLine {
 public:
  SerialLine(World& world, int number);

  void connect(Sink* sink, BaseStation* host) {
    sink_ = sink;
    host_ = host;
  }

  void to_host(std::uint8_t am_type, const Octets& payload);
  void to_mote(std::uint8_t am_type, const Octets& payload);

 private:
  struct Outgoing {
    std::uint8_t am_type;
    Octets payload;
    int tries = 0;
  };
  void send_next();
  void mote_got(std::uint8_t am_type, const Octets& payload, std::uint8_t serial_seq, int turn);
  void host_confirmed(int turn);
  /// Stamps the end of a frame that is ready now.
  std::int64_t reserve(std::int64_t& busy_until_us, std::size_t content_bytes) const;

  World& world_;
  std::string interface_;
  Sink* sink_ = nullptr;
  BaseStation* host_ = nullptr;
  std::deque<Outgoing> to_mote_;
  bool host_sending_ = false;
  int turn_ = 0;
  std::uint8_t next_serial_seq_;
  std::int64_t out_busy_until_us_ = 0;
  std::int64_t in_busy_until_us_ = 0;
};

}  // namespace rubric::lawful
