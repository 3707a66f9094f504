// Handles the frames around a message: turns the active-message header and the frame's members into
// values for the encoder.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "codec/containers/packet.h"
#include "codec/reflect/schema.h"
#include "codec/reflect/value.h"

namespace rubric::encode {

/// Returns the AM type under which a carrier's frames hold this message; nothing if they do not.
std::optional<std::int64_t> am_type_on(const reflect::Type& carrier, const reflect::Type& message);

/// Returns the field of a carrier's structure that holds the messages.
const reflect::Field& payload_field(const reflect::Type& carrier);

/// Returns the values of a serial packet: the members of `am` and `frame`, and the payload.
reflect::Value serial_values(const reflect::Value& am, const reflect::Value& frame,
                             const reflect::Value& payload);

/// Returns the values of a radio frame. Values in both `am` and `frame` must agree; throws
/// RecordError.
reflect::Value radio_values(const reflect::Value& am, const reflect::Value& frame, bool has_network,
                            const reflect::Value& payload);

/// Returns where a path into those values is in a line: "payload.src" is "fields.src", "mac.dsn" is
/// "frame.dsn".
std::string path_in_line(std::string_view path);

/// Returns the check sum of the packet's frame, which has one: the CRC of a serial frame, the FCS
/// of a radio frame.
std::int32_t check_sum(const Packet& packet);

}  // namespace rubric::encode
