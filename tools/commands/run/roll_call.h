// Asks motes that were silent for long whether they are there.
#pragma once

#include <cstdint>
#include <map>

#include "tools/commands/run/application.h"

namespace rubric::run {

/// For a base station that calls silent motes gone: of a mote it hears only what passes its serial
/// line, and not what goes to the sink or to other motes. After half of the time it sends a
/// reliable message without data, whose ack shows that the mote is there, to sink and base station
/// alike. No message of the protocol lets a sink say so. (decision 124)
class RollCall final : public Application {
 public:
  RollCall(std::uint16_t island, lines::Milliseconds gone_after)
      : island_(island), gone_after_(gone_after) {}

  bool takes(const machine::Notice& notice) override;
  void happened(const machine::Notice& notice, Caller& caller) override;
  lines::SteadyTime run(Caller& caller) override;

 private:
  void ask(std::uint16_t mote, Caller& caller);
  struct Presence {
    lines::SteadyTime heard{};
    lines::SteadyTime asked{};
    bool is_asked = false;  // And the outcome is not known.
  };

  std::uint16_t island_;
  lines::Milliseconds gone_after_;
  std::map<std::uint16_t, Presence> motes_;
  std::map<std::uint16_t, std::uint16_t> questions_;  // Their motes, by sequence number.
};

}  // namespace rubric::run
