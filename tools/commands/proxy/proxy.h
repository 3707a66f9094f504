// One access point to the devices of several networks, as the paper's Proxy: clients subscribe to a
// device without knowing its network, and while anybody does, the network is configured to read it.
#pragma once

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "codec/lines/stream.h"
#include "tools/commands/proxy/line_network.h"
#include "tools/commands/proxy/mote_network.h"
#include "tools/commands/run/application.h"
#include "tools/commands/run/line_splitter.h"

namespace rubric::proxy {

/// Serves clients at a TCP port of this host, by JSON lines:
///
///   {"subscribe":"11:5","sensors":["light"],"period_ms":500}    all sensors, if none are named
///   {"unsubscribe":"11:5"}                                      as the end of the connection does
///   {"command":"open","device":"1/1/8"}
///
/// A command's client gets {"event":"command","device":"11:5","command":"open","outcome":"done"},
/// or "no answer"; "sent" where the network says no more, and "refused" with the "text" why.
/// They get {"event":"device"}, at once for those that are there, "left", and "reading" for what
/// they subscribed to; "awaited" for a subscription to what is not there yet, and "error" for a
/// line that makes no sense. A device is read as often as its
/// most eager subscriber wants, and again when it comes back.
class Proxy final : public run::Application, private Above {
 public:
  /// Throws Broken if the port cannot be had; 0 is a free one.
  Proxy(std::uint16_t island, std::uint16_t port);
  ~Proxy() override;
  void add_lines(const lines::HostPort& at);
  std::uint16_t port() const;

  void happened(const machine::Notice& notice, run::Caller& caller) override;
  lines::SteadyTime run(run::Caller& caller) override;
  int fd() const override { return poll_.get(); }

 private:
  using Json = nlohmann::ordered_json;
  static constexpr std::size_t kRequestMax = 4096;

  struct Client {
    lines::ByteStream stream;
    run::LineSplitter input{kRequestMax};
    std::string output;
    std::map<std::string, Sampling> wants;   // By device.
    std::map<std::uint64_t, Json> commands;  // Without an outcome yet, by number.
  };
  struct Known {
    Network* network = nullptr;
    Device device;
    Sampling set;  ///< As the network was told.
  };

  // Above
  void joined(const Device& device) override;
  void read(const std::string& device, const std::string& data) override;
  void left(const std::string& device) override;
  void answered(std::uint64_t command, bool done) override;

  void accept();
  /// Returns whether there may be more to read.
  bool read(Client& client);
  void take(Client& client, const std::string& line);
  void command(Client& client, const Json& request);
  void subscribe(Client& client, const std::string& device, const Sampling& wanted);
  void put_error(Client& client, const std::string& text);
  void put(Client& client, std::string line);
  void put_all(const std::string& line);
  void watch(int fd) const;
  /// Configures a device as its subscribers want it now.
  void apply(const std::string& device);
  static std::string line_of(const Known& known);

  lines::Descriptor listener_;
  lines::Descriptor poll_;  // Of all descriptors.
  std::vector<std::unique_ptr<Network>> networks_;
  MoteNetwork* motes_;
  Network* telling_ = nullptr;  // Which network runs.
  std::uint64_t commands_ = 0;  // So many were given.
  int watched_ = -1;            // The descriptor of the network of lines.
  std::vector<std::unique_ptr<Client>> clients_;
  std::map<std::string, Known> devices_;
};

}  // namespace rubric::proxy
