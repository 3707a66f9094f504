// Runs a network in virtual time: reference machines, their lines, and their applications.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "conformance/machine/step.h"
#include "conformance/simulate/event_queue.h"
#include "conformance/simulate/network.h"
#include "conformance/simulate/radio.h"
#include "conformance/simulate/recorder.h"
#include "conformance/simulate/script.h"
#include "conformance/simulate/serial.h"

namespace rubric::simulate {

/// The results of a run in numbers.
struct Statistics {
  std::uint64_t steps = 0;         ///< Events that machines took.
  std::uint64_t radio_frames = 0;  ///< Without link acks.
  std::uint64_t link_acks = 0;
  std::uint64_t serial_frames = 0;  ///< Confirmations included.
  std::uint64_t peis_messages = 0;
  std::uint64_t lost = 0;
  std::uint64_t collided = 0;
  std::uint64_t doubled = 0;
  std::uint64_t unheard = 0;
  std::uint64_t received = 0;  ///< Deliveries to applications.
  std::uint64_t joins = 0;     ///< joined(SUCCESS) at motes.
  std::uint64_t join_failures = 0;
  std::uint64_t acks = 0;  ///< receive_ack(success).
  std::uint64_t ack_failures = 0;
  std::uint64_t synaptic_new = 0;
  std::uint64_t synaptic_old = 0;
  std::uint64_t synaptic_unknown = 0;
  friend bool operator==(const Statistics&, const Statistics&) = default;
};

/// Runs the network. The same network and seed give the same run, step by step. Recorders must
/// outlive it.
class Simulation final : RadioUser, SerialUser, Recorder {
 public:
  explicit Simulation(Network network, std::vector<Recorder*> recorders = {});
  ~Simulation() override;
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// Lets everything happen that is due up to and including `end_us`.
  void run_until(Micros end_us) { queue_.run_until(end_us); }

  const Network& network() const { return network_; }
  const machine::State& state(NodeId node) const;
  const Statistics& statistics() const { return statistics_; }

 private:
  class Node;

  // RadioUser, SerialUser
  bool listens(NodeId node) const override;
  void heard(NodeId node, const machine::Frame& frame) override;
  void radio_sent(NodeId node, bool acked) override;
  bool serial_on(NodeId node) const override;
  void serial_heard(NodeId node, const machine::Frame& frame) override;
  void serial_sent(NodeId node) override;
  // Recorder: counts, and calls all recorders.
  void given(Micros time_us, NodeId node, const machine::Event& event) override;
  void did(Micros time_us, NodeId node, const machine::Actions& actions) override;
  void mishap(Micros time_us, NodeId node, Mishap what, const machine::Frame& frame) override;
  void link_ack(Micros time_us, NodeId node, bool acked) override;
  void on_air(Micros time_us, std::size_t radio, Bytes frame) override;
  void on_serial(Micros time_us, std::size_t line, bool to_sink, const SerialFrame& frame) override;

  void boot(NodeId node);
  void turn_off(NodeId node, Micros on_after_us);
  void step(NodeId node, const machine::Event& event);
  void set_timer(NodeId node);
  void fire_timers(NodeId node);
  void transmit(NodeId node, const machine::Transmit& frame);
  void to_peis(NodeId node, const machine::Transmit& frame);
  void peis_heard(NodeId node, const machine::Transmit& frame);
  void beacon(const BeaconPlan& plan, std::size_t station);
  void count(const machine::Notice& notice);

  Network network_;
  std::vector<Recorder*> recorders_;
  EventQueue queue_;
  Random random_;
  std::vector<std::unique_ptr<Radio>> radios_;
  std::vector<std::unique_ptr<Serial>> serials_;
  std::vector<std::unique_ptr<Node>> nodes_;
  machine::Actions actions_;
  Statistics statistics_;
};

}  // namespace rubric::simulate
