// A tuple space over MQTT: retained messages are tuples, the last will tells who has gone.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tools/commands/space/space.h"

namespace rubric::space {

/// Where a broker is, and what it wants to see.
struct MqttSettings {
  std::string host;
  std::uint16_t port = 1883;
  bool tls = false;
  std::string root = "rubicon";  ///< Begins each topic.
  std::string user;              ///< Empty: none.
  std::string password;
  std::string ca_file;  ///< Of TLS; empty: the system's.
  std::string cert_file;
  std::string key_file;
};

/// Parses mqtt://HOST[:PORT][/ROOT], or mqtts:// for TLS. Throws std::invalid_argument.
MqttSettings parse_mqtt(const std::string& url);
/// Takes user, password, ca, cert and key from lines NAME=VALUE of a file, unless its path is
/// empty, and else user and password from RUBRIC_MQTT_USER and RUBRIC_MQTT_PASSWORD. Throws
/// std::invalid_argument with the place of a mistake, lines::Broken for a file that cannot be read.
void add_credentials(const std::string& file, MqttSettings& settings);

/// Reconnects after pauses that grow from one second to 30, and writes its tuples anew then. Says
/// on stderr when the broker comes and goes. Messages that make no sense are refused with a line
/// there.
class MqttSpace final : public Space {
 public:
  /// `will`: what the broker writes under its key when this participant has gone without a word;
  /// nothing if it has no key.
  MqttSpace(const MqttSettings& settings, const std::string& creator, const Tuple& will);
  ~MqttSpace() override;

  std::int64_t put(const std::string& key, const std::string& data, Stay stay) override;
  void announce(const std::string& topic, const std::string& payload) override;
  void remove(const std::string& key) override;
  void subscribe(const std::string& filter) override;
  std::vector<Tuple> take() override;

 private:
  class Client;
  std::unique_ptr<Client> client_;
};

}  // namespace rubric::space
