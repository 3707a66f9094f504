// The motes of an island as a network behind the proxy.
#pragma once

#include <map>
#include <set>
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
  std::string command(const std::string& device, const std::string& text,
                      std::uint64_t number) override;
  bool answers() const override { return true; }
  lines::SteadyTime run() override;

 private:
  struct Request {
    std::uint16_t mote = 0;
    std::string wish;
    bool samples = false;
    int tries = 0;
    std::uint64_t command = 0;  // The caller's number.
  };
  struct Member {
    space::Mote mote;
    bool described = false;         // It has joined since the proxy began.
    std::set<std::string> sensors;  // Of its description; else those that it was heard to read.
    bool there = false;             // As the clients know.
  };
  std::string device_of(std::uint16_t mote) const;
  bool is_there(std::uint16_t mote) const;
  void leave(std::uint16_t mote);
  void received(const machine::Received& message);
  void confirmed(const Request& request, bool success);
  /// Sends what a wish of the tuple space means. Returns why not; empty if it was sent.
  std::string send(const Request& request);

  std::uint16_t island_;
  Above& above_;
  run::Caller* caller_ = nullptr;  // Within happened(), and from then on.
  std::map<std::uint16_t, Member> motes_;
  std::map<std::uint16_t, Request> awaited_;  // By sequence number.
  std::map<std::uint16_t, Request> unsent_;   // By mote: the buffer was full.
};

}  // namespace rubric::proxy
