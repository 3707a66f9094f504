// Acknowledgements of the link: whether a frame that asked for one got it.
#pragma once

#include <cstdint>

#include "conformance/check/observation.h"

namespace rubric::check {

inline constexpr std::int64_t kRadioByteUs = 32;  ///< 250 kbit/s. (IEEE 802.15.4, 6.1.1)
/// Bytes of a frame on the air around its payload: preamble, SFD, length, MAC header, type, FCS.
inline constexpr std::int64_t kAroundBytes = 19;
/// The longest frame on the air: preamble, SFD and length before 127 bytes.
inline constexpr std::int64_t kAirMaxUs = (6 + 127) * kRadioByteUs;

/// Within this time the link may repeat a frame, with its DSN (decision 111).
inline constexpr std::int64_t kLinkRepeatUs = 100'000;

/// Returns how long a captured radio frame is on the air after its time, that is after its start.
/// Its receivers have it then, not before, and their times count from there. 0 for all else: serial
/// frames have the time of their end, and logs that of what the node did.
inline std::int64_t air_us(const Observation& seen) {
  if (seen.kind != Observation::Kind::kRadio || !seen.node.empty()) return 0;
  return (static_cast<std::int64_t>(seen.frame.payload.size()) + kAroundBytes) * kRadioByteUs;
}

/// Returns how long after its time a captured radio frame is acknowledged at the latest.
inline std::int64_t ack_within_us(const Observation& sent) { return air_us(sent) + 2500; }

/// Returns whether the 802.15.4 acknowledgement of radio frame `index`, by its DSN, came 0 to 2.5
/// ms after its end. It proves that *some* node of that address received it; its absence proves
/// nothing.
bool link_acked(const Run& run, std::uint32_t index);

/// Returns the same for a packet down a serial line: the mote's stack confirmed its number.
bool serial_acked(const Run& run, std::uint32_t index);

}  // namespace rubric::check
