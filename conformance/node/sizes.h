// Sizes and times of a node. Sizes are chosen when a program is built: a struct like MoteSizes.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "codec/generated/tinyos/am_header.h"

namespace rubric {
namespace node {

/// Messages that fit into each buffer, synaptic channels of each direction, reliable messages whose
/// acks are awaited at once, members of an island; each at most 120. A mote's and a sink's are
/// those of the paper (Memory Occupation, Table 1).
struct MoteSizes {
  static constexpr uint8_t kRadioOut = 4;
  static constexpr uint8_t kRadioIn = 4;
  static constexpr uint8_t kSerialOut = 2;
  static constexpr uint8_t kSerialIn = 2;
  static constexpr uint8_t kPeisOut = 0;
  static constexpr uint8_t kPeisIn = 0;
  static constexpr uint8_t kChannels = 4;
  static constexpr uint8_t kAwaited = 8;
  static constexpr uint8_t kMembers = 0;
};
struct SinkSizes : MoteSizes {
  static constexpr uint8_t kMembers = 20;  // Release 1.0.
};
/// Any role, with the room that a PC has.
struct AnySizes : SinkSizes {
  static constexpr uint8_t kPeisOut = 16;
  static constexpr uint8_t kPeisIn = 16;
  static constexpr uint8_t kChannels = 8;
};
struct BaseStationSizes : AnySizes {
  static constexpr uint8_t kRadioOut = 0;
  static constexpr uint8_t kRadioIn = 0;
  static constexpr uint8_t kSerialOut = 16;
  static constexpr uint8_t kSerialIn = 16;
  static constexpr uint8_t kMembers = 0;
};

constexpr uint8_t kConnectionsMax = 10;  ///< Of a synaptic channel.
/// Joins that a sink has answered and that were not acknowledged yet.
constexpr uint8_t kOpenJoinsMax = 4;

/// Paper, Memory Occupation: a base, and so much for each message and each channel.
constexpr size_t kPaperMessageBytes = 122;
constexpr size_t kPaperChannelBytes = 56;
constexpr size_t paper_bytes(size_t messages, size_t channels) {
  return 450 + messages * kPaperMessageBytes + channels * kPaperChannelBytes;
}

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

}  // namespace node
}  // namespace rubric
