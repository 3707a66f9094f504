// Synaptic channels. (paper: Synaptic Communication)
#pragma once

#include "conformance/machine/actions.h"
#include "conformance/machine/state.h"

namespace rubric::machine {

ChannelId channel_id(std::uint16_t source_devid, std::uint16_t destination_devid);

/// The operations of the paper's interface on the channels of node `own`; each result is notified.
void call_synaptic(Synaptic& synaptic, const Config& config, Address own, Ticks now,
                   const Call& call, Actions& actions);
/// Data of a channel arrives from mote `src`: S1-READ, S5-UNKNOWN.
void hear_synaptic(Synaptic& synaptic, Address own, Address src, Bytes floats, Actions& actions);

/// What a tick wants sent.
struct SynapticSend {
  ChannelId id = 0;
  Address dest;
  std::uint8_t size = 0;
  std::array<std::uint32_t, kConnectionsMax> value_bits;
  ReqId requirement = ReqId::kNone;
};
using SynapticSends = BoundedList<SynapticSend, kChannelsRoom>;
/// The clock ticks: S2, S3, S4, S6. Sets the next tick.
void tick_synaptic(Synaptic& synaptic, Address own, Ticks now, SynapticSends& sends,
                   Actions& actions);

/// What a tick wanted sent was refused: a later tick sends it. (S3-CHANGED)
void keep_change(Synaptic& synaptic, ChannelId id);

}  // namespace rubric::machine
