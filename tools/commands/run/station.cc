#include "tools/commands/run/station.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <chrono>
#include <random>
#include <utility>

#include "codec/text/text.h"
#include "tools/commands/run/own_layer.h"
#include "tools/commands/run/packets.h"
#include "tools/commands/run/target_layer.h"
#include "tools/commands/run/wall_clock.h"

namespace rubric::run {
namespace {

using node::Line;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kMoment{5};     // Between looks at a tuple space.
constexpr int kPacketsMax = 64;        // Of a serial line, in a step: others want to run, too.
constexpr milliseconds kLongest{100};  // Until a stop is seen.
constexpr milliseconds kSayDroppedEvery{1000};

// A call into the layer, also where it ends by an exception.
class Depth {
 public:
  explicit Depth(int& depth) : depth_(depth) { ++depth_; }
  Depth(const Depth&) = delete;
  Depth& operator=(const Depth&) = delete;
  ~Depth() { --depth_; }

 private:
  int& depth_;
};

node::Ticks gone_after(const StationSetup& setup) { return setup.gone_after_s * 1024; }

}  // namespace

std::string name_of(node::Role role, std::uint16_t island, std::uint16_t id) {
  if (role == node::Role::kSink) return fmt::format("sink{}", island);
  if (role == node::Role::kBaseStation) return fmt::format("pc{}", island);
  return island == 0 ? fmt::format("mote{}", id) : fmt::format("mote{}_{}", island, id);
}

trace::NodeHeader header_of(const StationSetup& setup) {
  trace::NodeHeader header{.name = setup.name};
  const bool mote = setup.role == node::Role::kMote;
  const bool base = setup.role == node::Role::kBaseStation;
  header.role = mote ? trace::Role::kMote : base ? trace::Role::kBaseStation : trace::Role::kSink;
  if (!base) header.id = setup.id;
  if (!mote) header.island = setup.island;
  header.iut = true;
  header.stated = {{trace::ParameterId::kResponse, kResponseTicks}};
  if (!base && setup.target.empty()) {
    header.stated.push_back({trace::ParameterId::kChannels, node::AnySizes::kChannels});
  }
  if (setup.gone_after_s != 0) {
    header.stated.push_back({trace::ParameterId::kGoneAfter, gone_after(setup)});
  }
  return header;
}

Station::Station(StationSetup setup, Keeper& keeper)
    : setup_(std::move(setup)),
      keeper_(keeper),
      started_(steady_clock::now()),
      island_(setup_.island) {
  names_.node = setup_.name;
  names_.radio = setup_.air_name;
  names_.serial = fmt::format("ser{}", setup_.island);
  names_.radio_group = kPan;
  if (!is_base_station()) open_radio();
  if (setup_.to) serial_.emplace(*setup_.to);
  if (!setup_.offered.empty()) serial_.emplace(setup_.offered);
  layer_ = make_layer();
  started_ = steady_clock::now();
}

std::unique_ptr<Layer> Station::make_layer() {
  LayerUser& user = *this;
  const auto last = static_cast<std::uint16_t>(std::mt19937(setup_.seed)() % 60'000);
  if (!setup_.target.empty()) {
    return std::make_unique<TargetLayer>(setup_.target, setup_.id, last + 1, user);
  }
  node::Setup setup{};
  setup.role = setup_.role;
  setup.id = setup_.id;
  setup.island = setup_.island;
  setup.channels = node::AnySizes::kChannels;
  setup.last_seq_num = last;
  setup.slack = 1;
  return std::make_unique<OwnLayer>(setup, gone_after(setup_), user);
}

void Station::open_radio() {
  VirtualRadio::User user;
  user.listens = [this] { return layer_->listens(); };
  user.heard = [this](Bytes packet) { heard(Line::kRadio, packet); };
  user.sent = [this](bool acked) {
    catch_up();
    if (awaits_link_ack_) keeper_.given(names_, machine::SendDone{machine::Link::kRadio, acked});
    awaits_link_ack_ = false;
    layer_->sent(Line::kRadio, acked);
  };
  user.on_air = [this](const Packet& packet) {
    if (setup_.keeps) keeper_.frame(packet, setup_.air_name == "rA" ? "radio" : setup_.air_name);
  };
  user.twin = [this] {
    if (std::exchange(warned_, true)) return;
    if (is_mote()) {
      text::print(stderr, "rubric: another mote on this air has the id {}, too\n", setup_.id);
    } else {
      text::print(
          stderr,
          "rubric: {}: another sink is on this air, too: a mote joins the one that it hears "
          "first\n",
          setup_.name);
    }
  };
  radio_.emplace(VirtualRadio::Settings{setup_.id, setup_.loss, setup_.seed}, setup_.air,
                 std::move(user));
  radio_->open();
}

node::Ticks Station::ticks() const {
  const auto us = (steady_clock::now() - started_) / std::chrono::microseconds(1);
  return static_cast<node::Ticks>(us * 1024 / 1'000'000);
}

// Lets the node do what is due; returns when it wants to run next. Does nothing within a callback,
// which happens at the time of what it comes from.
lines::SteadyTime Station::catch_up() {
  const lines::SteadyTime latest = steady_clock::now() + kLongest;
  if (depth_ > 0) return latest;
  const node::Ticks now = ticks();
  std::optional<node::Ticks> due;
  {
    const Depth depth(depth_);
    due = layer_->run(now);
  }
  if (!due) return latest;
  const std::int64_t left_ticks = static_cast<std::int32_t>(*due - now);
  const milliseconds left(std::max<std::int64_t>(0, left_ticks) * 1000 / 1024 + 1);
  return std::min(latest, steady_clock::now() + left);
}

void Station::heard(Line line, Bytes packet) {
  catch_up();
  keeper_.given(names_, machine::Heard{frame_of(line, packet)});
  const Depth depth(depth_);
  layer_->received(line, packet);
}

void Station::transmit(Line line, Bytes packet, bool link_ack) {
  keeper_.did(names_, frame_of(line, packet));
  if (line == Line::kRadio && radio_) {
    awaits_link_ack_ = link_ack;
    return radio_->send(packet, link_ack);
  }
  if (line == Line::kSerial && serial_) {
    const std::vector<std::uint8_t> bytes(packet.begin(), packet.end());
    keep_serial(bytes, !is_sink());
    serial_->send(bytes);
  }
  if (line == Line::kPeis && peers_ != nullptr) peers_->send(packet);
  layer_->sent(line, false);
}

std::optional<machine::Notice> Station::call(const machine::Call& call) {
  catch_up();
  keeper_.given(names_, machine::Called{call});
  std::optional<machine::Notice> result;
  {
    const Depth depth(depth_);
    result = layer_->call(call);
  }
  if (result) keeper_.did(names_, *result);
  catch_up();
  return result;
}

void Station::happened(const machine::Notice& notice) {
  keeper_.did(names_, notice);
  const std::size_t full =
      std::holds_alternative<machine::MoteJoined>(notice) ? layer_->full_list() : 0;
  if (full != 0) {
    text::print(stderr, "rubric: {}: its list is full with {} motes: it answers no other\n",
                setup_.name, full);
  }
  for (run::Application* application : applications_) {
    if (application->takes(notice)) return;
  }
  for (run::Application* application : applications_) application->happened(notice, *this);
}

void Station::keep_serial(const std::vector<std::uint8_t>& bytes, bool inbound) {
  if (!is_sink() && !setup_.keeps) return;
  Packet packet;
  packet.framing = Framing::kSf;
  packet.direction = inbound ? Direction::kInbound : Direction::kOutbound;
  packet.bytes = Bytes(bytes.data(), bytes.size());
  packet.time_ns = wall_ns();
  const bool several = setup_.air_name != "rA";
  keeper_.frame(packet, fmt::format("serial:{}", several ? setup_.island : 1));
}

void Station::run(const std::function<bool()>& stop) {
  for (run::Application* application : applications_) application->start(*this);
  while (!stop() && !has_ended()) step();
  say_dropped_ = {};
  say_dropped();
  for (run::Application* application : applications_) application->stop(*this);
}

bool Station::has_ended() const {
  return std::any_of(applications_.begin(), applications_.end(),
                     [](const run::Application* one) { return one->ended(); });
}

void Station::step() {
  lines::SteadyTime until = catch_up();
  if (serial_waits_) until = steady_clock::now();
  int calls = -1;
  for (run::Application* application : applications_) {
    until = std::min(until, application->run(*this));
    if (calls < 0) calls = application->fd();
  }
  if (serial_) {
    if (serial_->open() && is_base_station()) call(machine::SetIslandId{setup_.island});
    until = std::min(until, serial_->next_try());
  }
  if (peers_ != nullptr) {
    peers_->receive([this](Bytes packet) { heard(Line::kPeis, packet); });
    until = std::min(until, steady_clock::now() + kMoment);
  }
  const int serial = serial_ ? serial_->fd() : -1;
  if (radio_) {
    radio_->run(until, {calls, serial});
  } else {
    const auto left = std::chrono::ceil<milliseconds>(until - steady_clock::now()).count();
    pollfd inputs[] = {{calls, POLLIN, 0}, {serial, POLLIN, 0}};
    ::poll(inputs, 2, static_cast<int>(std::max<std::int64_t>(0, left)));
  }
  serial_waits_ = hear_serial();
  say_dropped();
  look_at_air();
  keeper_.settle();
}

// Hears some packets; returns whether there may be more.
bool Station::hear_serial() {
  for (int count = 0; count < kPacketsMax; ++count) {
    if (!serial_ || !serial_->is_open()) return false;
    const std::vector<std::uint8_t> packet = serial_->receive(steady_clock::now());
    if (packet.empty()) return false;
    keep_serial(packet, is_sink());
    heard(Line::kSerial, Bytes(packet.data(), packet.size()));
    look_at_island();
  }
  return true;
}

std::string Station::air_address() const {
  const bool here = setup_.air.host == lines::kThisHost;
  return fmt::format("zep:{}{}{}", here ? "" : setup_.air.host, here ? "" : ":", radio_->port());
}

// Says that another program has the port of the air, or that another host does not answer.
void Station::look_at_air() {
  if (!radio_ || said_unanswered_ || !radio_->is_unanswered()) return;
  said_unanswered_ = true;
  if (setup_.air.host != lines::kThisHost) {
    return text::print(stderr, "rubric: {}: nothing there answers as an air does\n", air_address());
  }
  text::print(stderr,
              "rubric: {}: the port is held by a program that does not answer as an air does "
              "('ss -ulpn sport = {}' names it)\n",
              air_address(), radio_->port());
}

// Says, at most once a second, how many messages found no room in the radio's buffer.
void Station::say_dropped() {
  const std::size_t dropped = layer_->dropped();
  if (dropped == said_dropped_ || steady_clock::now() < say_dropped_) return;
  text::print(
      stderr,
      "rubric: {}: {} messages from the serial line were dropped: they came faster than the "
      "radio sends\n",
      setup_.name, dropped - said_dropped_);
  said_dropped_ = dropped;
  say_dropped_ = steady_clock::now() + kSayDroppedEvery;
}

// Says that the host at a sink's serial line has another island in mind.
void Station::look_at_island() {
  const std::uint16_t island = layer_->island();
  if (!is_sink() || island == island_) return;
  text::print(stderr,
              "rubric: the host at the serial line changed the island to {}, which was {}\n",
              island, island_);
  island_ = island;
}

}  // namespace rubric::run
