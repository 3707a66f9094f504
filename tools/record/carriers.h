// The frames around a message: from the active-message header and the frame's members to values
// that the encoder takes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "codec/containers/packet.h"
#include "codec/reflect/schema.h"
#include "codec/reflect/value.h"

namespace rubric::record {

/// The AM type under which a carrier's frames hold this message; nothing if they do not.
std::optional<std::int64_t> am_type_on(const reflect::Type& carrier, const reflect::Type& message);

/// The field of a carrier's structure that the messages stand in.
const reflect::Field& payload_field(const reflect::Type& carrier);

/// The values of a serial packet: the members of `am` and `frame`, and the payload.
reflect::Value serial_values(const reflect::Value& am, const reflect::Value& frame,
                             const reflect::Value& payload);

/// The values of a radio frame. What stands in `am` and in `frame` must agree; throws RecordError.
reflect::Value radio_values(const reflect::Value& am, const reflect::Value& frame,
                            bool has_network, const reflect::Value& payload);

/// Where a path into those values stands in a line: "payload.src" is "fields.src", "mac.dsn" is
/// "frame.dsn".
std::string path_in_line(std::string_view path);

/// The check sum of the packet's frame, which has one: of a serial frame its CRC, of a radio frame
/// its FCS.
std::int32_t check_sum(const Packet& packet);

}  // namespace rubric::record
