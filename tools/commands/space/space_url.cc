#include "tools/commands/space/space_url.h"

#include <fmt/format.h>

#include "tools/commands/space/layout.h"
#include "tools/commands/space/mqtt_space.h"

namespace rubric::space {

std::unique_ptr<Space> open_mqtt(const std::string& url, const std::string& credentials,
                                 std::uint16_t island) {
  MqttSettings settings = parse_mqtt(url);
  add_credentials(credentials, settings);
  Tuple will{.key = island_availability_key(island), .data = availability_data(false)};
  return std::make_unique<MqttSpace>(settings, fmt::format("{}:null", island), will);
}

std::unique_ptr<Space> watch_mqtt(const std::string& url, const std::string& credentials) {
  MqttSettings settings = parse_mqtt(url);
  add_credentials(credentials, settings);
  return std::make_unique<MqttSpace>(settings, "monitor", Tuple{});
}

}  // namespace rubric::space
