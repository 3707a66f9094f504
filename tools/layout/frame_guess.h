// One frame that somebody typed or pasted: which framing it has.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "codec/containers/packet.h"

namespace rubric::layout {

/// A frame as it was given, and what it was taken for.
struct GivenFrame {
  std::vector<std::uint8_t> bytes;  ///< Flags, escapes and length bytes taken off.
  Packet packet;                    ///< Borrows `bytes`.
  std::string what;                 ///< "a serial frame from its kind byte to its CRC".
};

/// Takes `given` as "sf", "hdlc", "radio" (FCS or not) or "bare", or guesses with "auto": a frame
/// whose check sum fits, else one whose lengths fit, else one that begins as it should. Nothing
/// where nothing speaks for any.
std::optional<GivenFrame> take_frame(const std::vector<std::uint8_t>& given,
                                     std::string_view framing);

}  // namespace rubric::layout
