// A network in virtual time: its parts, its applications' small talk, its capture.
#include "conformance/selftest/lawful_traffic/world.h"

#include <algorithm>
#include <utility>

#include "codec/containers/link_record.h"

namespace rubric::lawful {
namespace {

constexpr std::int64_t kFirstChatUs = 2'500'000;

int sink_number(std::size_t island_index) { return static_cast<int>(island_index) * 100 + 1; }

}  // namespace

Outsider::Outsider(World& world, int number, std::uint16_t am) : Device(world, number, am, -1) {
  power(true);
}

void Outsider::send(std::uint16_t dst, std::uint8_t am_type, Octets payload) {
  RadioFrame frame{.dst = dst, .type = am_type, .payload = std::move(payload)};
  transmit(std::move(frame));
}

World::World(Plan plan, std::uint64_t seed) : plan_(std::move(plan)), random_(seed), air_(*this) {
  traffic_.seed = seed;
}

World::~World() = default;

void World::build() {
  for (std::size_t i = 0; i < plan_.islands.size(); ++i) {
    const int number = sink_number(i);
    const std::uint16_t island = plan_.islands[i];
    sinks_.push_back(std::make_unique<Sink>(*this, number, static_cast<int>(i), island));
    bases_.push_back(std::make_unique<BaseStation>(*this, number, island));
    lines_.push_back(std::make_unique<SerialLine>(*this, number));
    lines_[i]->connect(sinks_[i].get(), bases_[i].get());
    sinks_[i]->connect(lines_[i].get());
    bases_[i]->connect(lines_[i].get());
    devices_.push_back(sinks_[i].get());
    traffic_.nodes.push_back({number, Role::kSink, kSinkAm, island});
    traffic_.nodes.push_back({number, Role::kBaseStation, kNull, island});
    scheduler_.at(0, [sink = sinks_[i].get()] { sink->boot(); });
  }
  for (const MotePlan& plan : plan_.motes) {
    const std::uint16_t island = plan_.islands[static_cast<std::size_t>(plan.island)];
    const bool taken = std::any_of(devices_.begin(), devices_.end(), [&](const Device* device) {
      return device->number() == plan.id;
    });
    const int number = taken ? 1000 + plan.id : plan.id;
    motes_.push_back(std::make_unique<Mote>(*this, number, plan, island));
    Mote* mote = motes_.back().get();
    devices_.push_back(mote);
    traffic_.nodes.push_back({number, Role::kMote, plan.id, island});
    scheduler_.at(plan.boot_us, [mote] { mote->boot(); });
    if (plan.leave_us >= 0) scheduler_.at(plan.leave_us, [mote] { mote->switch_off(); });
  }
  for (const auto& [time_us, script] : plan_.script) {
    scheduler_.at(time_us, [this, script = script] { script(*this); });
  }
}

Outsider& World::outsider(std::uint16_t am, Role role) {
  for (const auto& outsider : outsiders_) {
    if (outsider->am() == am) return *outsider;
  }
  outsiders_.push_back(std::make_unique<Outsider>(*this, 2000 + am, am));
  devices_.push_back(outsiders_.back().get());
  traffic_.nodes.push_back({2000 + am, role, am, 0});
  return *outsiders_.back();
}

void World::plan_chats() {
  for (int i = 0; i < plan_.chats; ++i) {
    scheduler_.at(random_.between(kFirstChatUs, last_send_us()), [this] { chat(); });
  }
}

Address World::random_dest(Address from) {
  const bool foreign = plan_.foreign_chats && islands() > 1 && random_.chance(40);
  std::vector<Address> possible;
  for (const auto& base : bases_) possible.push_back(base->address());
  for (const auto& sink : sinks_) possible.push_back(sink->address());
  for (const auto& mote : motes_) {
    if (mote->joined()) possible.push_back(mote->address());
  }
  std::erase_if(possible,
                [&](Address to) { return to == from || (to.pid != from.pid) != foreign; });
  return possible.empty() ? Address{} : possible[random_.below(possible.size())];
}

void World::chat() {
  std::vector<Endpoint*> speakers;
  for (const auto& base : bases_) speakers.push_back(base.get());
  for (const auto& sink : sinks_) speakers.push_back(sink.get());
  for (const auto& mote : motes_) {
    if (mote->joined()) speakers.push_back(mote.get());
  }
  Endpoint& from = *speakers[random_.below(speakers.size())];
  const Address dest = random_dest(from.address());
  if (dest == Address{}) return;
  Octets body;
  if (random_.chance(25)) {
    body = demo_body(0x0041, 600);
  } else {
    body.assign(static_cast<std::size_t>(random_.between(1, 30)), 0);
    for (std::uint8_t& byte : body) byte = random_.byte();
    body[0] = 0xA0;  // No type of the demo application.
  }
  const auto app =
      random_.chance(70) ? rubicon::Component::kMockup : rubicon::Component::kApplicationMd;
  from.send(dest, static_cast<std::uint8_t>(app), body, random_.chance(60));
}

void World::peis(std::uint16_t from_island, const NetMessage& message) {
  const auto delay = random_.between(traits().peis_min_us, traits().peis_max_us);
  for (const auto& base : bases_) {
    const std::uint16_t island = base->address().pid;
    if (island == from_island) continue;
    if (message.dest.pid != island && message.dest.pid != kAllNodes) continue;
    scheduler_.after(delay, [to = base.get(), message] { to->peis_heard(message); });
  }
}

void World::capture_radio(std::int64_t time_us, Octets record) {
  if (!plan_.capture_radio) return;
  if (random_.chance(plan_.sniffer_misses_percent)) {
    missed_first_ = missed_first_ || traffic_.packets.empty();
    return;
  }
  traffic_.packets.push_back(
      {time_us, "radio", kLinkRadioFcs, Direction::kUnknown, std::move(record)});
}

void World::capture_serial(std::int64_t time_us, const std::string& interface, Direction direction,
                           Octets record) {
  if (!plan_.capture_serial) return;
  traffic_.packets.push_back({time_us, interface, kLinkSerial, direction, std::move(record)});
}

void World::record_event(AppEvent event) { traffic_.events.push_back(std::move(event)); }

void World::finish() {
  auto& packets = traffic_.packets;
  const auto earlier = [](const LawfulPacket& a, const LawfulPacket& b) {
    return a.time_us < b.time_us;
  };
  std::stable_sort(packets.begin(), packets.end(), earlier);
  std::erase_if(packets, [this](const LawfulPacket& packet) {
    return packet.time_us < plan_.capture_from_us || packet.time_us > plan_.end_us;
  });
  traffic_.sniffer_complete = plan_.sniffer_misses_percent == 0;
  traffic_.cold_start = plan_.capture_from_us == 0 && !missed_first_;
  traffic_.has_radio = plan_.capture_radio;
  traffic_.has_serial = plan_.capture_serial;
  traffic_.all_well_formed = plan_.all_well_formed;
}

Traffic World::run() {
  build();
  plan_chats();
  scheduler_.run_until(plan_.end_us);
  finish();
  return std::move(traffic_);
}

}  // namespace rubric::lawful
