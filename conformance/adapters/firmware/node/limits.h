// Sizes and times of a node, fixed when its firmware is built.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "codec/generated/tinyos/am_header.h"

#ifndef RUBRIC_FIRMWARE_SINK
#define RUBRIC_FIRMWARE_SINK 0  // 1: firmware of a sink.
#endif
#ifndef RUBRIC_FIRMWARE_CHANNELS
#define RUBRIC_FIRMWARE_CHANNELS 4  // Synaptic channels of each direction.
#endif

namespace rubric {
namespace firmware {

constexpr bool kIsSink = RUBRIC_FIRMWARE_SINK != 0;

// Buffers of messages. (paper: Memory Occupation, Table 1)
constexpr uint8_t kRadioOutRoom = 4;
constexpr uint8_t kRadioInRoom = 4;
constexpr uint8_t kSerialOutRoom = 2;
constexpr uint8_t kSerialInRoom = 2;

constexpr uint8_t kChannelsRoom = RUBRIC_FIRMWARE_CHANNELS;
constexpr uint8_t kConnectionsMax = 10;
constexpr uint8_t kAwaitedRoom = 8;  ///< Reliable messages whose acks are awaited at once.
constexpr uint8_t kMembersMax = 20;  ///< In an island. (release 1.0)
/// Motes known to a sink: its members, and joins that it has answered.
constexpr uint8_t kAdmissionsRoom = kIsSink ? kMembersMax + 4 : 1;

/// Paper, Memory Occupation: base + 12 messages of 122 bytes + 8 channels of 56 bytes.
constexpr size_t kPaperMessageBytes = 122;
constexpr size_t kPaperChannelBytes = 56;
constexpr size_t kPaperTotalBytes = 450 + 12 * kPaperMessageBytes + 8 * kPaperChannelBytes;

// Times in ticks, 1024 to the second, as in spec/profiles/paper.
constexpr uint16_t kJoinPeriodTicks = 500;
constexpr uint16_t kAckTimeoutTicks = 1000;
constexpr uint16_t kSynapticPeriodTicks = 500;
constexpr uint8_t kSynapticPhaseTicks = 30;  ///< (devid - 1) times this.
constexpr uint8_t kJoinRequestsMax = 5;      ///< In one call. (decision 101)
constexpr uint8_t kAckJoinsMax = 5;          ///< For one accepted reply. (decision 102)

constexpr uint16_t kSinkId = 1;  ///< AM address and devid of every sink.

constexpr size_t kAmPayloadMax = 114;
constexpr size_t kAmHeaderBytes = tinyos::AmHeaderView::kMaxSizeBytes;
constexpr size_t kAppDataMax = 100;  ///< After TRANSID and APPID.

}  // namespace firmware
}  // namespace rubric
