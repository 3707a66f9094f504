#include "conformance/simulate/simulation.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <variant>

namespace rubric::simulate {

using machine::Link;
using machine::Role;
using machine::Ticks;

namespace {

constexpr Micros kRepeatUs[] = {500, 20'000};  // A message's double comes after this.

// A call that owns its bytes.
class OwnedCall {
 public:
  explicit OwnedCall(const machine::Call& call) : call_(call) {
    const auto* const send = std::get_if<machine::Send>(&call);
    if (send != nullptr) data_.assign(send->data.begin(), send->data.end());
  }
  machine::Called event() const {
    machine::Call call = call_;
    auto* const send = std::get_if<machine::Send>(&call);
    if (send != nullptr) send->data = Bytes(data_.data(), data_.size());
    return {call};
  }

 private:
  machine::Call call_;
  std::vector<std::uint8_t> data_;
};

constexpr std::size_t kLinkAckBytes = 3;

}  // namespace

// A node as its application sees it.
class Simulation::Node final : public Host {
 public:
  Node(Simulation& simulation, NodeId self) : simulation_(simulation), self_(self) {}

  Micros now() const override { return simulation_.queue_.now(); }
  Random& random() override { return simulation_.random_; }
  void call(const machine::Call& call) override {
    later(0, [this, owned = OwnedCall(call)] { simulation_.step(self_, owned.event()); });
  }
  void wake_after(Micros delay_us, std::uint32_t token) override {
    later(delay_us, [this, token] { application()->woken(*this, token); });
  }
  void power_off(Micros on_after_us) override {
    later(0, [this, on_after_us] { simulation_.turn_off(self_, on_after_us); });
  }

  /// Runs `work` later, unless the power fails before.
  template <class Work>
  void later(Micros delay_us, Work work) {
    simulation_.queue_.after(delay_us, [this, work = std::move(work), then = life] {
      if (on && life == then) work();
    });
  }
  Application* application() { return simulation_.network_.nodes[self_].application.get(); }

  machine::State state;
  bool on = false;
  bool started = false;
  std::uint64_t life = 0;
  std::uint64_t timer_number = 0;  ///< Number of the wake-up that counts.
  std::optional<std::size_t> station;
  Radio* radio = nullptr;
  Serial* serial = nullptr;

 private:
  Simulation& simulation_;
  NodeId self_;
};

Simulation::Simulation(Network network, std::vector<Recorder*> recorders)
    : network_(std::move(network)), recorders_(std::move(recorders)), random_(network_.seed) {
  Recorder& recorder = *this;
  RadioUser& radio_user = *this;
  SerialUser& serial_user = *this;
  for (std::size_t i = 0; i < network_.radios.size(); ++i) {
    const RadioPlan& plan = network_.radios[i];
    radios_.push_back(std::make_unique<Radio>(i, plan, queue_, random_, recorder, radio_user));
  }
  for (NodeId i = 0; i < network_.nodes.size(); ++i) {
    nodes_.push_back(std::make_unique<Node>(*this, i));
    const NodePlan& plan = network_.nodes[i];
    if (plan.config.role == Role::kBaseStation) continue;
    nodes_[i]->radio = radios_.at(plan.radio).get();
    nodes_[i]->station = nodes_[i]->radio->add_station(i, plan.config.id);
  }
  for (std::size_t i = 0; i < network_.serials.size(); ++i) {
    const SerialPlan& plan = network_.serials[i];
    serials_.push_back(std::make_unique<Serial>(i, plan, queue_, random_, recorder, serial_user));
    nodes_.at(plan.sink)->serial = serials_[i].get();
    nodes_.at(plan.base_station)->serial = serials_[i].get();
  }
  for (const BeaconPlan& plan : network_.beacons) {
    const std::size_t station = radios_.at(plan.radio)->add_station(std::nullopt, plan.am_address);
    queue_.at(plan.first_us, [this, &plan, station] { beacon(plan, station); });
  }
  for (NodeId i = 0; i < nodes_.size(); ++i) boot(i);
}

Simulation::~Simulation() = default;

const machine::State& Simulation::state(NodeId node) const { return nodes_.at(node)->state; }

void Simulation::boot(NodeId id) {
  Node& node = *nodes_[id];
  node.on = true;
  if (node.started) {
    step(id, machine::Reboot{});
  } else {
    node.state = machine::start(network_.nodes[id].config);
    node.started = true;
  }
  node.later(0, [&node] {
    if (node.application() != nullptr) node.application()->booted(node);
  });
}

void Simulation::turn_off(NodeId id, Micros on_after_us) {
  Node& node = *nodes_[id];
  step(id, machine::PowerOff{});
  node.on = false;
  ++node.life;
  if (node.radio != nullptr) node.radio->reset(*node.station);
  if (node.serial != nullptr) node.serial->reset(id);
  if (on_after_us >= 0) queue_.after(on_after_us, [this, id] { boot(id); });
}

void Simulation::step(NodeId id, const machine::Event& event) {
  Node& node = *nodes_[id];
  if (!node.on) return;
  ++statistics_.steps;
  given(queue_.now(), id, event);
  machine::step(node.state, ticks_of(queue_.now()), event, actions_);
  did(queue_.now(), id, actions_);
  for (const machine::Transmit& frame : actions_.transmits()) transmit(id, frame);
  if (node.application() != nullptr) {  // Its calls happen after this: see Host::call.
    for (const machine::Notice& notice : actions_.notices())
      node.application()->notified(node, notice);
  }
  set_timer(id);
}

void Simulation::set_timer(NodeId id) {
  Node& node = *nodes_[id];
  const std::uint64_t number = ++node.timer_number;
  const auto timers = machine::timers(node.state);
  if (timers.empty()) return;
  const auto* const soonest = std::min_element(
      timers.begin(), timers.end(), [](const auto& a, const auto& b) { return a.due < b.due; });
  const Micros delay = std::max<Micros>(us_of(soonest->due) - queue_.now(), 0);
  node.later(delay, [this, id, number] {
    if (nodes_[id]->timer_number == number) fire_timers(id);
  });
}

void Simulation::fire_timers(NodeId id) {
  const Ticks now = ticks_of(queue_.now());
  for (const machine::DueTimer& timer : machine::timers(nodes_[id]->state)) {
    if (timer.due <= now) return step(id, machine::TimerDue{timer.timer});  // Sets the next.
  }
  set_timer(id);
}

void Simulation::transmit(NodeId id, const machine::Transmit& frame) {
  Node& node = *nodes_[id];
  switch (frame.link) {
    case Link::kRadio: return node.radio->send(*node.station, frame.frame(), frame.link_ack);
    case Link::kSerial:
      if (node.serial != nullptr) return node.serial->send(id, frame.frame());
      // Nothing is at the other end: the bytes are lost.
      return node.later(0, [this, id] { serial_sent(id); });
    case Link::kPeis: return to_peis(id, frame);
  }
}

void Simulation::to_peis(NodeId from, const machine::Transmit& frame) {
  ++statistics_.peis_messages;
  for (NodeId to = 0; to < nodes_.size(); ++to) {
    if (to == from || network_.nodes[to].config.role != Role::kBaseStation) continue;
    const bool all = frame.dest == machine::kBroadcastPid;
    if (!all && nodes_[to]->state.island != frame.dest) continue;
    const Faults& faults = network_.peis;
    if (random_.chance(faults.loss)) {
      mishap(queue_.now(), to, Mishap::kLost, frame.frame());
      continue;
    }
    const Micros delay = network_.peis_delay_us + random_.between(0, faults.delay_max_us);
    queue_.after(delay, [this, to, frame] { peis_heard(to, frame); });
    if (!random_.chance(faults.duplication)) continue;
    queue_.after(delay + random_.between(kRepeatUs[0], kRepeatUs[1]), [this, to, frame] {
      mishap(queue_.now(), to, Mishap::kDoubled, frame.frame());
      peis_heard(to, frame);
    });
  }
}

void Simulation::peis_heard(NodeId node, const machine::Transmit& frame) {
  if (!nodes_[node]->on) return mishap(queue_.now(), node, Mishap::kUnheard, frame.frame());
  step(node, machine::Heard{frame.frame()});
}

void Simulation::beacon(const BeaconPlan& plan, std::size_t station) {
  machine::Frame frame;
  frame.dest = machine::kAmBroadcast;
  frame.src = plan.am_address;
  frame.type = plan.am_type;
  frame.payload = Bytes(plan.payload.data(), plan.payload.size());
  radios_[plan.radio]->send(station, frame, false);
  queue_.after(plan.period_us, [this, &plan, station] { beacon(plan, station); });
}

bool Simulation::listens(NodeId node) const {
  return nodes_[node]->on && nodes_[node]->state.radio.on;
}

void Simulation::heard(NodeId node, const machine::Frame& frame) {
  step(node, machine::Heard{frame});
}

void Simulation::radio_sent(NodeId node, bool acked) {
  step(node, machine::SendDone{Link::kRadio, acked});
}

bool Simulation::serial_on(NodeId node) const {
  return nodes_[node]->on && nodes_[node]->state.serial.on;
}

void Simulation::serial_heard(NodeId node, const machine::Frame& frame) {
  step(node, machine::Heard{frame});
}

void Simulation::serial_sent(NodeId node) { step(node, machine::SendDone{Link::kSerial, true}); }

void Simulation::count(const machine::Notice& notice) {
  if (std::holds_alternative<machine::Received>(notice)) ++statistics_.received;
  if (const auto* joined = std::get_if<machine::Joined>(&notice)) {
    ++(joined->success ? statistics_.joins : statistics_.join_failures);
  }
  if (const auto* ack = std::get_if<machine::AckReceived>(&notice)) {
    ++(ack->success ? statistics_.acks : statistics_.ack_failures);
  }
  if (const auto* data = std::get_if<machine::SynDataReceived>(&notice)) {
    switch (data->status) {
      case machine::DataStatus::kNew: ++statistics_.synaptic_new; break;
      case machine::DataStatus::kOld: ++statistics_.synaptic_old; break;
      case machine::DataStatus::kUnknownChannel: ++statistics_.synaptic_unknown; break;
    }
  }
}

void Simulation::given(Micros time_us, NodeId node, const machine::Event& event) {
  for (Recorder* recorder : recorders_) recorder->given(time_us, node, event);
}

void Simulation::did(Micros time_us, NodeId node, const machine::Actions& actions) {
  for (const machine::Notice& notice : actions.notices()) count(notice);
  for (Recorder* recorder : recorders_) recorder->did(time_us, node, actions);
}

void Simulation::mishap(Micros time_us, NodeId node, Mishap what, const machine::Frame& frame) {
  switch (what) {
    case Mishap::kLost: ++statistics_.lost; break;
    case Mishap::kCollided: ++statistics_.collided; break;
    case Mishap::kDoubled: ++statistics_.doubled; break;
    case Mishap::kUnheard: ++statistics_.unheard; break;
  }
  for (Recorder* recorder : recorders_) recorder->mishap(time_us, node, what, frame);
}

void Simulation::link_ack(Micros time_us, NodeId node, bool acked) {
  for (Recorder* recorder : recorders_) recorder->link_ack(time_us, node, acked);
}

void Simulation::on_air(Micros time_us, std::size_t radio, Bytes frame) {
  ++(frame.size() == kLinkAckBytes ? statistics_.link_acks : statistics_.radio_frames);
  for (Recorder* recorder : recorders_) recorder->on_air(time_us, radio, frame);
}

void Simulation::on_serial(Micros time_us, std::size_t line, bool to_sink,
                           const SerialFrame& frame) {
  ++statistics_.serial_frames;
  for (Recorder* recorder : recorders_) recorder->on_serial(time_us, line, to_sink, frame);
}

}  // namespace rubric::simulate
