// A network in virtual time.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "conformance/selftest/lawful_traffic/air.h"
#include "conformance/selftest/lawful_traffic/node.h"
#include "conformance/selftest/lawful_traffic/plan.h"
#include "conformance/selftest/lawful_traffic/random.h"
#include "conformance/selftest/lawful_traffic/serial_line.h"
#include "conformance/selftest/lawful_traffic/traffic.h"

namespace rubric::lawful {

/// Runs events in order of time and, at one time, in order of scheduling.
class Scheduler {
 public:
  std::int64_t now_us() const { return now_us_; }

  void at(std::int64_t time_us, std::function<void()> call) {
    due_.emplace(std::pair(time_us < now_us_ ? now_us_ : time_us, order_++), std::move(call));
  }
  void after(std::int64_t delay_us, std::function<void()> call) {
    at(now_us_ + delay_us, std::move(call));
  }
  void run_until(std::int64_t end_us) {
    while (!due_.empty() && due_.begin()->first.first <= end_us) {
      auto first = due_.extract(due_.begin());
      now_us_ = first.key().first;
      first.mapped()();
    }
    now_us_ = end_us;
  }

 private:
  std::map<std::pair<std::int64_t, std::uint64_t>, std::function<void()>> due_;
  std::int64_t now_us_ = 0;
  std::uint64_t order_ = 0;
};

/// A device that only sends what a script gives it: a tester, an anchor, a node of another network.
class Outsider final : public Device {
 public:
  Outsider(World& world, int number, std::uint16_t am);
  void heard(const RadioFrame&) override {}
  void send(std::uint16_t dst, std::uint8_t am_type, Octets payload);
};

class World {
 public:
  World(Plan plan, std::uint64_t seed);
  ~World();

  /// Runs the plan to its end and returns the contents of the capture.
  Traffic run();

  const Plan& plan() const { return plan_; }
  const Traits& traits() const { return plan_.traits; }
  Random& random() { return random_; }
  Scheduler& scheduler() { return scheduler_; }
  Air& air() { return air_; }
  std::int64_t now_us() const { return scheduler_.now_us(); }
  /// Returns when applications stop starting new messages, so that the capture ends without open
  /// ends.
  std::int64_t last_send_us() const { return plan_.end_us - 1'300'000; }

  const std::vector<Device*>& devices() const { return devices_; }
  /// By their order in the plan.
  Mote& mote(std::size_t index) { return *motes_[index]; }
  std::size_t motes() const { return motes_.size(); }
  Sink& sink(std::size_t island_index) { return *sinks_[island_index]; }
  BaseStation& base(std::size_t island_index) { return *bases_[island_index]; }
  std::size_t islands() const { return sinks_.size(); }
  /// Returns an outsider, made when first asked for.
  Outsider& outsider(std::uint16_t am, Role role);

  /// Carries a message from a base station to those of its destination.
  void peis(std::uint16_t from_island, const NetMessage& message);

  void capture_radio(std::int64_t time_us, Octets record);
  void capture_serial(std::int64_t time_us, const std::string& interface, Direction direction,
                      Octets record);
  void record_event(AppEvent event);

 private:
  void build();
  void plan_chats();
  void chat();
  Address random_dest(Address from);
  void finish();

  Plan plan_;
  Random random_;
  Scheduler scheduler_;
  Air air_;
  Traffic traffic_;
  bool missed_first_ = false;  // By the sniffer; then the capture does not begin cold.
  std::vector<Device*> devices_;
  std::vector<std::unique_ptr<Mote>> motes_;
  std::vector<std::unique_ptr<Sink>> sinks_;
  std::vector<std::unique_ptr<BaseStation>> bases_;
  std::vector<std::unique_ptr<SerialLine>> lines_;
  std::vector<std::unique_ptr<Outsider>> outsiders_;
};

}  // namespace rubric::lawful
