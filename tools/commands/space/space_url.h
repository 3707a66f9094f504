// Opens a tuple space by its URL.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "tools/commands/space/space.h"

namespace rubric::space {

/// Returns the space of a broker, of which the base station of this island is a participant; its
/// last will says that the island is offline. `credentials`: a file, or empty. Throws
/// std::invalid_argument or Broken.
std::unique_ptr<Space> open_mqtt(const std::string& url, const std::string& credentials,
                                 std::uint16_t island);
/// Returns the same for somebody who only subscribes.
std::unique_ptr<Space> watch_mqtt(const std::string& url, const std::string& credentials);

}  // namespace rubric::space
