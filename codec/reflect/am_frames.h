// The frames of TinyOS around an active message, as the wire spec lays them out. Unlike write() of
// a generated structure they take any payload: simulators and tests send wrong messages too.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "codec/generated/rubicon/radio_i_frame.h"
#include "codec/generated/tinyos/am_header.h"
#include "codec/generated/tinyos/enums.h"
#include "codec/reflect/frame.h"
#include "codec/runtime/bytes.h"

namespace rubric::reflect {

inline constexpr std::size_t kAmHeaderBytes = tinyos::AmHeaderView::kMaxSizeBytes;
/// 802.15.4 header, network byte and AM type.
inline constexpr std::size_t kRadioIHeaderBytes = rubicon::RadioIFrameLayout::PayloadAt::kAt;

/// Returns a serial packet from its dispatch byte on. The length in it is that of the payload.
std::vector<std::uint8_t> serial_packet(const ActiveMessage& am, Bytes payload);

/// Returns an I-frame of the radio without its FCS.
std::vector<std::uint8_t> radio_frame(const MacHeader& mac, std::uint8_t am_type, Bytes payload);

constexpr std::uint16_t fcf_of(tinyos::FrameControl kind) {
  return static_cast<std::uint16_t>(kind);
}

}  // namespace rubric::reflect
