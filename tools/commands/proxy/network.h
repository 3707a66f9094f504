// A network behind the proxy. The paper's RubiconNetwork: each kind of network implements it once,
// and those above need not know which one a device is in.
#pragma once

#include <cstdint>
#include <set>
#include <string>

#include "codec/lines/time.h"

namespace rubric::proxy {

/// Of a stream in a step: others want to run, too, and Ctrl-C to be seen.
constexpr int kReadsMax = 64;

/// A device as the network describes it.
struct Device {
  std::string id;  ///< Unique over all networks: 11:5, 1/1/7.
  std::set<std::string> sensors;
  std::set<std::string> actuators;
  bool is_described = true;  ///< It has no other sensors.
};

/// What subscribers want of a device together; a period of 0 ends its readings.
struct Sampling {
  std::uint32_t period_ms = 0;
  std::set<std::string> sensors;
  friend bool operator==(const Sampling&, const Sampling&) = default;
};

/// What a network tells. All functions are called from within those of Network.
class Above {
 public:
  virtual void joined(const Device& device) = 0;
  /// `data` is JSON as in the tuple space: {"light":{"raw":512}}.
  virtual void read(const std::string& device, const std::string& data) = 0;
  virtual void left(const std::string& device) = 0;
  /// Tells what became of a command that was sent.
  virtual void answered(std::uint64_t command, bool done) = 0;

 protected:
  ~Above() = default;
};

class Network {
 public:
  virtual ~Network() = default;
  virtual const char* name() const = 0;
  /// Configures the readings of a device that is there.
  virtual void sample(const std::string& device, const Sampling& wanted) = 0;
  /// Gives a command to a device that is there, under a number of the caller's. Returns why not;
  /// empty if it was sent.
  virtual std::string command(const std::string& device, const std::string& text,
                              std::uint64_t number) = 0;
  /// Returns whether Above::answered() follows a command.
  virtual bool answers() const { return false; }
  /// Returns the descriptor on which news come; -1: none.
  virtual int fd() const { return -1; }
  /// Takes news; returns when it wants to run next.
  virtual lines::SteadyTime run() { return lines::SteadyTime::max(); }
};

}  // namespace rubric::proxy
