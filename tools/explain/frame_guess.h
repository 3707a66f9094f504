// Guesses the framing of one frame that was typed or pasted.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "codec/containers/packet.h"

namespace rubric::explain {

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
