// The serial line between a sink and its base station: 115200 baud, TinyOS' serial stack. The base
// station sends PACKET_ACK frames and repeats those that the sink did not confirm; the sink sends
// PACKET_NOACK frames. (TEP 113)
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "conformance/machine/event.h"
#include "conformance/simulate/event_queue.h"
#include "conformance/simulate/network.h"
#include "conformance/simulate/recorder.h"

namespace rubric::simulate {

/// The owner of a serial line.
class SerialUser {
 public:
  virtual ~SerialUser() = default;
  /// Returns whether power and serial interface are on.
  virtual bool serial_on(NodeId node) const = 0;
  virtual void serial_heard(NodeId node, const machine::Frame& frame) = 0;
  virtual void serial_sent(NodeId node) = 0;
};

class Serial {
 public:
  Serial(std::size_t index, const SerialPlan& plan, EventQueue& queue, Random& random,
         Recorder& recorder, SerialUser& user)
      : index_(index),
        plan_(plan),
        queue_(queue),
        random_(random),
        recorder_(recorder),
        user_(user) {}

  /// Takes a frame from the sink or the base station, which waits for serial_sent() before the
  /// next.
  void send(NodeId from, const machine::Frame& frame);
  /// Makes that end of the line forget its pending frames.
  void reset(NodeId node) {
    ++end_of(node).life;
    end_of(node).awaited.reset();
  }

 private:
  /// The outgoing direction of one end.
  struct End {
    Micros free_us = 0;                   ///< The UART is busy until then.
    std::uint64_t life = 0;               ///< Work of a former life is not done.
    std::optional<std::uint8_t> awaited;  ///< Serial sequence number that the sink has to confirm.
  };
  struct Held {
    std::vector<std::uint8_t> packet;  ///< From the dispatch byte on; none in an ACK.
    machine::Frame am;                 ///< Its payload lies in `packet`.
    int tries = 0;
  };
  using Shared = std::shared_ptr<Held>;
  using Done = std::function<void(bool intact)>;

  End& end_of(NodeId node) { return node == plan_.sink ? sink_ : base_station_; }
  Micros shift_out(bool to_sink, std::uint8_t kind, std::int32_t seq, const Shared& held,
                   Done done);
  void try_host(const Shared& held);
  void confirm(std::uint8_t seq);
  void deliver(NodeId to, const Held& held, bool intact);

  std::size_t index_;
  const SerialPlan& plan_;
  EventQueue& queue_;
  Random& random_;
  Recorder& recorder_;
  SerialUser& user_;
  End sink_;
  End base_station_;
  std::uint8_t next_seq_ = 0;
};

}  // namespace rubric::simulate
