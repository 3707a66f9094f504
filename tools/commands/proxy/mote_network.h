// The motes of an island as a network behind the proxy.
#pragma once

#include <map>
#include <string>

#include "tools/commands/proxy/network.h"
#include "tools/commands/run/application.h"
#include "tools/commands/space/layout.h"

namespace rubric::proxy {

/// Hears of motes by the base station's events, and configures them by read_updates.
class MoteNetwork final : public Network {
 public:
  MoteNetwork(std::uint16_t island, Above& above) : island_(island), above_(above) {}

  void happened(const machine::Notice& notice, run::Caller& caller);

  const char* name() const override { return "motes"; }
  void sample(const std::string& device, const Sampling& wanted) override;
  std::string command(const std::string& device, const std::string& text) override;
  lines::SteadyTime run() override;

 private:
  struct Request {
    std::uint16_t mote = 0;
    std::string wish;
    bool samples = false;
    int tries = 0;
  };
  void received(const machine::Received& message);
  /// Sends what a wish of the tuple space means. Returns why not; empty if it was sent.
  std::string send(const Request& request);

  std::uint16_t island_;
  Above& above_;
  run::Caller* caller_ = nullptr;  // Within happened(), and from then on.
  std::map<std::uint16_t, space::Mote> motes_;
  std::map<std::uint16_t, Request> awaited_;  // By sequence number.
  std::map<std::uint16_t, Request> unsent_;   // By mote: the buffer was full.
};

}  // namespace rubric::proxy
