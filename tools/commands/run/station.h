// A node of `rubric run` with its lines and applications.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "conformance/node/sizes.h"
#include "conformance/trace/trace.h"
#include "tools/commands/run/application.h"
#include "tools/commands/run/keeper.h"
#include "tools/commands/run/layer.h"
#include "tools/commands/run/serial_end.h"
#include "tools/commands/run/virtual_radio.h"

namespace rubric::run {

struct StationSetup {
  std::string name;  ///< In the log.
  node::Role role = node::Role::kMote;
  std::uint16_t id = node::kSinkId;  ///< Of a mote or sink.
  std::uint16_t island = 0;          ///< Of a sink or base station.
  lines::HostPort air;               ///< Of a mote or sink.
  std::string air_name = "rA";       ///< In log and capture.
  double loss = 0;                   ///< Share of the frames that are not received.
  std::uint32_t seed = 0;
  std::string offered;               ///< A sink's serial line: pty, sf-server:PORT; empty: none.
  std::optional<lines::Address> to;  ///< A base station's line to its sink.
  std::uint32_t gone_after_s = 0;    ///< Silence after which a mote has left; 0: never.
  std::string target;                ///< Another implementation of a mote; empty: our own.
  bool keeps = true;  ///< Whether it keeps the frames of its lines; not if another node there does.
};

/// What a PC promises: a process may be late. (decision 125)
constexpr int kResponseTicks = 1000;

/// Returns the name of a node in logs and events: sink11, pc11, mote5, or mote11_5 where there are
/// several islands; `island` is then not 0.
std::string name_of(node::Role role, std::uint16_t island, std::uint16_t id);
/// Returns the node as a log names it.
trace::NodeHeader header_of(const StationSetup& setup);

/// The line between base stations: takes what a node sends to other islands.
class Peers {
 public:
  /// Takes a packet from its dispatch byte on.
  virtual void send(Bytes packet) = 0;
  /// Passes on what has come.
  virtual void receive(const std::function<void(Bytes packet)>& take) = 0;

 protected:
  ~Peers() = default;
};

/// Runs in one thread.
class Station final : private LayerUser, public Caller {
 public:
  /// Opens its lines. Throws Broken if one cannot be had.
  Station(StationSetup setup, Keeper& keeper);

  /// Applications in the order in which they hear of events; all before run().
  void add(run::Application& application) { applications_.push_back(&application); }
  void join_peers(Peers& peers) { peers_ = &peers; }
  const StationSetup& setup() const { return setup_; }
  std::uint16_t air_port() const { return radio_->port(); }
  /// Returns the air as --radio names it.
  std::string air_address() const;
  /// Returns the sink's serial line as a base station names it.
  const std::string& serial_address() const { return serial_->other_end(); }
  /// Returns whether somebody is at the other end of its serial line. From any thread.
  bool is_linked() const { return serial_ && serial_->is_open(); }

  /// Runs until stop() holds or an application ends it. Throws Broken.
  void run(const std::function<bool()>& stop);

  std::optional<machine::Notice> call(const machine::Call& call) override;
  node::Refusal refusal(const machine::Send& send) const override { return layer_->refusal(send); }

 private:
  // LayerUser
  void transmit(node::Line line, Bytes packet, bool link_ack) override;
  void happened(const machine::Notice& notice) override;

  bool is_mote() const { return setup_.role == node::Role::kMote; }
  bool is_sink() const { return setup_.role == node::Role::kSink; }
  bool is_base_station() const { return setup_.role == node::Role::kBaseStation; }
  node::Ticks ticks() const;
  std::unique_ptr<Layer> make_layer();
  void open_radio();
  void keep_serial(const std::vector<std::uint8_t>& bytes, bool inbound);
  lines::SteadyTime catch_up();
  void heard(node::Line line, Bytes packet);
  void step();
  bool hear_serial();
  void look_at_island();
  void say_dropped();
  void look_at_air();
  bool has_ended() const;

  StationSetup setup_;
  Keeper& keeper_;
  events::NodeNames names_;
  lines::SteadyTime started_;
  std::unique_ptr<Layer> layer_;
  std::vector<run::Application*> applications_;
  Peers* peers_ = nullptr;
  std::optional<VirtualRadio> radio_;
  std::optional<SerialEnd> serial_;
  bool awaits_link_ack_ = false;
  bool serial_waits_ = false;  // There may be more to read.
  int depth_ = 0;              // Of calls into the layer: a callback may call.
  bool warned_ = false;
  bool said_unanswered_ = false;
  std::size_t said_dropped_ = 0;  // Of the messages that the layer dropped.
  lines::SteadyTime say_dropped_{};
  std::uint16_t island_ = 0;
};

}  // namespace rubric::run
