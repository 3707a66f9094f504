// A base station in the tuple space.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tools/commands/run/application.h"
#include "tools/commands/run/refusals.h"
#include "tools/commands/run/station.h"
#include "tools/commands/space/layout.h"
#include "tools/commands/space/space.h"

namespace rubric::space {

/// Publishes an island's motes, readings and events, passes wishes on to motes, and is the line to
/// other base stations. What makes no sense is refused, with a line on stderr.
class Gateway final : public run::Application, public run::Peers {
 public:
  struct Settings {
    std::uint16_t island = 0;
    /// A mote is offline when nothing was heard of it for so long; 0: never.
    lines::Milliseconds gone_after{0};
    /// The root of topics, if motes are to be announced to Home Assistant; else empty.
    std::string home_assistant = {};
  };
  Gateway(const Settings& settings, std::unique_ptr<Space> space)
      : settings_(settings), space_(std::move(space)) {}

  void start(run::Caller& caller) override;
  void happened(const machine::Notice& notice, run::Caller& caller) override;
  lines::SteadyTime run(run::Caller& caller) override;
  void stop(run::Caller& caller) override;

  void send(Bytes packet) override;
  void receive(const std::function<void(Bytes packet)>& take) override;

 private:
  struct Member {
    Mote mote;
    std::optional<bool> online;  ///< As this run has written it.
    /// Since when it is waited for after an earlier run; the node watches those that it has heard.
    std::optional<lines::SteadyTime> awaited;
  };
  struct Waiting {
    std::uint16_t mote = 0;
    std::string key;
    Wish wish;
  };
  struct Awaited {
    std::uint16_t mote = 0;
    std::string id;
  };
  void take(const Tuple& tuple);
  void say_online();
  void take_availability(const Tuple& tuple);
  void take_wish(const Tuple& tuple, std::uint16_t mote);
  void give_wishes(run::Caller& caller);
  void heard(const machine::Received& message);
  void joined(const machine::Received& message);
  void announce(std::uint16_t id, const Mote& mote);
  void set_online(std::uint16_t id, Member& member, bool online);
  void put_event(const std::string& data) {
    space_->put(events_key(settings_.island), data, Space::Stay::kEvent);
  }
  void refuse(const std::string& key, const std::string& why);

  Settings settings_;
  std::unique_ptr<Space> space_;
  std::map<std::uint16_t, Member> members_;
  std::deque<Waiting> wishes_;                // Not given to the serial line yet.
  lines::SteadyTime all_sent_{};              // When the sink's radio has sent those that were.
  std::map<std::uint16_t, Awaited> awaited_;  // By sequence number.
  std::deque<std::vector<std::uint8_t>> arrived_;  // From other base stations.
  std::set<std::int64_t> wrote_online_;            // By when.
  lines::SteadyTime said_other_{};
  run::Refusals refusals_{"space"};
};

}  // namespace rubric::space
