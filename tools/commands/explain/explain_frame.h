// Explains a frame, field by field.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "codec/containers/packet.h"
#include "codec/reflect/frame.h"

namespace rubric::explain {

/// Returns rows of offset, bytes, field, value and meaning; then notes, and for a malformed frame
/// its fault, place, and rule. Offsets count from the frame's first byte: the kind byte, the
/// dispatch byte, the frame control field or the message.
std::string explain_frame(const reflect::Frame& frame);

/// A frame as it was given, and its guessed framing.
struct GivenFrame {
  std::vector<std::uint8_t> bytes;  ///< Flags, escapes and length bytes taken off.
  Packet packet;                    ///< Borrows `bytes`.
  std::string what;                 ///< "a serial frame from its kind byte to its CRC".
};

/// Takes `given` as "sf", "hdlc", "radio" (FCS or not) or "bare", or guesses with "auto": a frame
/// whose check sum fits, else one whose lengths fit, else one with a plausible beginning. Returns
/// nothing if no framing is plausible.
std::optional<GivenFrame> take_frame(const std::vector<std::uint8_t>& given,
                                     std::string_view framing);

}  // namespace rubric::explain
