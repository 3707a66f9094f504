#include "tools/commands/run/islands.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <deque>
#include <exception>
#include <map>
#include <memory>
#include <stdexcept>
#include <thread>
#include <utility>

#include "codec/lines/broken.h"
#include "codec/lines/stop.h"
#include "codec/text/text.h"
#include "conformance/test/targets/process.h"
#include "tools/commands/run/json_application.h"
#include "tools/commands/run/mote_application.h"
#include "tools/commands/run/roll_call.h"
#include "tools/commands/run/station.h"
#include "tools/commands/space/gateway.h"
#include "tools/commands/space/memory_space.h"
#include "tools/commands/space/mqtt_space.h"
#include "tools/commands/space/space_url.h"

namespace rubric::run {
namespace {

constexpr lines::Milliseconds kApplicationEnds{2000};  // Of itself, when its input has ended.
constexpr lines::Milliseconds kLinkTime{5000};         // Of base stations and their sinks.
constexpr lines::Milliseconds kLinkPoll{5};

// One node with what belongs to it. Members end in the order of their need for each other.
struct Inhabitant {
  std::unique_ptr<targets::Process> child;
  std::deque<std::unique_ptr<Application>> applications;
  std::unique_ptr<space::Gateway> gateway;
  std::unique_ptr<Station> station;
};

// The setups of an ecology, island by island: sink, base station, motes.
class Plan {
 public:
  explicit Plan(const Ecology& ecology) : ecology_(ecology) {}

  StationSetup sink(const EcologyIsland& island) {
    StationSetup setup = on_air(island, node::Role::kSink, node::kSinkId);
    setup.offered = island.serial.empty() ? "sf-server:0" : island.serial;
    setup.gone_after_s = ecology_.gone_after_s;
    return setup;
  }
  StationSetup base_station(const EcologyIsland& island) {
    StationSetup setup;
    setup.role = node::Role::kBaseStation;
    setup.name = name_of(setup.role, island.island, setup.id);
    setup.island = island.island;
    setup.seed = next_seed();
    setup.gone_after_s = ecology_.gone_after_s;
    setup.keeps = false;  // Its sink keeps the line's frames.
    return setup;
  }
  StationSetup mote(const EcologyIsland& island, const EcologyMote& mote) {
    StationSetup setup = on_air(island, node::Role::kMote, mote.id);
    setup.target = mote.target;
    setup.keeps = false;
    return setup;
  }

 private:
  StationSetup on_air(const EcologyIsland& island, node::Role role, std::uint16_t id) {
    StationSetup setup;
    setup.role = role;
    setup.id = id;
    setup.name = name_of(role, island.island, id);
    setup.island = role == node::Role::kSink ? island.island : std::uint16_t{0};
    setup.air = lines::parse_address(island.radio)->at;
    setup.loss = ecology_.loss_percent / 100.0;
    setup.seed = next_seed();
    // A free port makes an air of its own.
    const bool own = setup.air.port == 0;
    const std::string key = own ? fmt::format("island {}", island.island) : island.radio;
    const bool first = !airs_.contains(key);
    if (first) airs_[key] = airs_.size() + 1;
    setup.air_name = fmt::format("r{}", airs_[key]);
    setup.keeps = first;
    return setup;
  }
  std::uint32_t next_seed() { return static_cast<std::uint32_t>(ecology_.seed * 1000 + ++count_); }

  const Ecology& ecology_;
  std::map<std::string, std::size_t> airs_;
  std::uint32_t count_ = 0;
};

class Islands {
 public:
  Islands(const Ecology& ecology, const std::string& credentials, Keeper& keeper,
          std::shared_ptr<LineOutput> events)
      : ecology_(ecology), credentials_(credentials), keeper_(keeper), events_(std::move(events)) {
    Plan plan(ecology);
    for (const EcologyIsland& island : ecology.islands) settle(island, plan);
  }

  void run() {
    std::deque<std::thread> threads;
    const auto start = [&](bool motes) {
      for (auto& inhabitant : inhabitants_) {
        Station* const station = inhabitant->station.get();
        const bool is_mote = station->setup().role == node::Role::kMote;
        if (is_mote == motes) threads.emplace_back([this, station] { run(*station); });
      }
    };
    start(false);
    await_links();
    start(true);
    for (std::thread& thread : threads) thread.join();
    end_applications();
    events_->finish(std::chrono::steady_clock::now() + kLastWords);
    say_goodbyes();
    // Motes first, then what they talk to.
    while (!inhabitants_.empty()) inhabitants_.pop_back();
    if (!fault_.empty()) throw lines::Broken(fault_);
  }

 private:
  // A sink tells of a mote's joining once, and nobody where its serial line is not in use yet.
  void await_links() {
    const auto deadline = std::chrono::steady_clock::now() + kLinkTime;
    for (const auto& inhabitant : inhabitants_) {
      const Station& station = *inhabitant->station;
      if (station.setup().role != node::Role::kBaseStation) continue;
      while (!station.is_linked() && !lines::stop_requested() &&
             std::chrono::steady_clock::now() < deadline) {
        std::this_thread::sleep_for(kLinkPoll);
      }
    }
  }
  // At the same time, as each may wait for a broker that does not answer.
  void say_goodbyes() {
    std::deque<std::thread> threads;
    for (const auto& inhabitant : inhabitants_) {
      if (inhabitant->gateway) threads.emplace_back([&] { inhabitant->gateway.reset(); });
    }
    for (std::thread& thread : threads) thread.join();
  }
  // All of them have the same time.
  void end_applications() {
    for (const auto& inhabitant : inhabitants_) {
      if (inhabitant->child) inhabitant->child->close_input();
    }
    const auto deadline = std::chrono::steady_clock::now() + kApplicationEnds;
    for (const auto& inhabitant : inhabitants_) {
      const auto left =
          std::chrono::ceil<lines::Milliseconds>(deadline - std::chrono::steady_clock::now());
      if (inhabitant->child) inhabitant->child->end(std::max(left, lines::Milliseconds(0)));
    }
  }

  void settle(const EcologyIsland& island, Plan& plan) {
    Inhabitant& sink = add(plan.sink(island), island.sink_app, nullptr);
    text::print(stderr, "rubric: island {}: {}, {}\n", island.island, sink.station->air_address(),
                sink.station->serial_address());
    if (island.serial.empty()) {
      StationSetup setup = plan.base_station(island);
      setup.to = lines::required_address(sink.station->serial_address());
      Inhabitant& base = add(std::move(setup), island.app, nullptr);
      base.gateway = gateway_of(island.island);
      base.station->add(*base.gateway);
      base.station->join_peers(*base.gateway);
      if (ecology_.gone_after_s != 0) {
        base.station->add(*base.applications.emplace_back(std::make_unique<RollCall>(
            island.island, std::chrono::seconds(ecology_.gone_after_s))));
      }
    }
    for (const EcologyMote& mote : island.motes) {
      StationSetup setup = plan.mote(island, mote);
      setup.air.port = sink.station->air_port();
      add(std::move(setup), mote.app, &mote);
    }
  }

  Inhabitant& add(StationSetup setup, const std::string& app, const EcologyMote* mote) {
    Inhabitant& one = *inhabitants_.emplace_back(std::make_unique<Inhabitant>());
    const std::string name = setup.name;
    one.station = station_of(std::move(setup), name);
    one.applications.push_back(
        std::make_unique<JsonApplication>(JsonApplication::Ends{-1, events_, name, true}));
    if (!app.empty() && app != "demo") {
      one.child = targets::Process::run(app, targets::Process::Stderr::kOurs);
      auto calls = std::make_shared<LineOutput>(one.child->in_fd(), "the application of " + name);
      one.applications.push_back(std::make_unique<JsonApplication>(
          JsonApplication::Ends{one.child->out_fd(), std::move(calls), ""}));
    } else if (mote != nullptr) {
      one.applications.push_back(
          std::make_unique<MoteApplication>(mote->descriptor, app == "demo"));
    }
    for (const auto& application : one.applications) one.station->add(*application);
    return one;
  }

  // Errors of a file with many nodes name theirs.
  std::unique_ptr<Station> station_of(StationSetup setup, const std::string& name) {
    try {
      return std::make_unique<Station>(std::move(setup), keeper_);
    } catch (const lines::Broken& broken) {
      throw lines::Broken(fmt::format("{}: {}", name, broken.what()));
    } catch (const std::invalid_argument& mistake) {
      throw std::invalid_argument(fmt::format("{}: {}", name, mistake.what()));
    }
  }

  std::unique_ptr<space::Gateway> gateway_of(std::uint16_t island) {
    const std::string creator = fmt::format("{}:null", island);
    std::unique_ptr<space::Space> space;
    if (ecology_.space.empty()) {
      space = std::make_unique<space::MemorySpace>(board_, creator);
    } else {
      space = space::open_mqtt(ecology_.space, credentials_, island);
    }
    space::Gateway::Settings settings{island, std::chrono::seconds(ecology_.gone_after_s)};
    if (ecology_.home_assistant) settings.home_assistant = space::parse_mqtt(ecology_.space).root;
    return std::make_unique<space::Gateway>(settings, std::move(space));
  }

  void run(Station& station) {
    try {
      station.run(lines::stop_requested);
    } catch (const std::exception& broken) {
      const std::lock_guard lock(mutex_);
      fault_ = fmt::format("{}: {}", station.setup().name, broken.what());
      lines::request_stop();
    }
    if (events_->error() != 0) lines::request_stop();
    if (lines::stop_requested()) return;
    text::print(stderr, "rubric: the application of {} has ended, and the node with it\n",
                station.setup().name);
    if (++ended_ == inhabitants_.size()) lines::request_stop();
  }

  const Ecology& ecology_;
  const std::string& credentials_;
  Keeper& keeper_;
  std::shared_ptr<LineOutput> events_;
  std::shared_ptr<space::MemoryBoard> board_ = std::make_shared<space::MemoryBoard>();
  std::deque<std::unique_ptr<Inhabitant>> inhabitants_;
  std::mutex mutex_;
  std::string fault_;
  std::atomic<std::size_t> ended_ = 0;
};

}  // namespace

std::vector<trace::NodeHeader> nodes_of(const Ecology& ecology) {
  std::vector<trace::NodeHeader> out;
  Plan plan(ecology);
  for (const EcologyIsland& island : ecology.islands) {
    out.push_back(header_of(plan.sink(island)));
    if (island.serial.empty()) out.push_back(header_of(plan.base_station(island)));
    for (const EcologyMote& mote : island.motes) out.push_back(header_of(plan.mote(island, mote)));
  }
  return out;
}

void run_ecology(const Ecology& ecology, const std::string& credentials, Keeper& keeper,
                 std::shared_ptr<LineOutput> events) {
  Islands(ecology, credentials, keeper, std::move(events)).run();
}

}  // namespace rubric::run
