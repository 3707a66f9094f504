// The link layer's acknowledgement, which exists below every protocol: its route, for a
// FrameGenerator of tinyos::tables::kProtocol.
#pragma once

#include "codec/generated/tinyos/enums.h"
#include "codec/generated/tinyos/tables.h"
#include "codec/reflect/schema.h"

namespace rubric::generate {

// IEEE 802.15.4-2006, section 7.2.2.3: the frame type, and nothing else, is set.
constexpr reflect::RouteChoice kLinkAckChoices[] = {
    {0, 2, true, static_cast<uint32_t>(tinyos::FrameControl::kAck)}};
constexpr reflect::Route kLinkAckRoute[] = {
    {"radio_ack", &tinyos::tables::types::kMacAck, 0, UINT32_MAX, kLinkAckChoices, 1, nullptr, 0}};
constexpr reflect::RouteTable kLinkAckRoutes{kLinkAckRoute, 1};

}  // namespace rubric::generate
