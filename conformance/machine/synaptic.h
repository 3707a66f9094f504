// Synaptic channels. (paper: Synaptic Communication)
#pragma once

#include "conformance/machine/actions.h"
#include "conformance/machine/state.h"

namespace rubric::machine {

ChannelId channel_id(std::uint16_t source_devid, std::uint16_t destination_devid);

/// Handles the operations of the paper's interface on the channels of node `own`; notifies each
/// result.
void call_synaptic(Synaptic& synaptic, const Config& config, Address own, Ticks now,
                   const Call& call, Actions& actions);
/// Handles data of a channel from mote `src`: S1-READ, S5-UNKNOWN.
void hear_synaptic(Synaptic& synaptic, Address own, Address src, Bytes floats, Actions& actions);

/// Data that a tick sends.
struct SynapticSend {
  ChannelId id = 0;
  Address dest;
  std::uint8_t size = 0;
  std::array<std::uint32_t, kConnectionsMax> value_bits;
  ReqId requirement = ReqId::kNone;
};
using SynapticSends = BoundedList<SynapticSend, kChannelsRoom>;
/// Handles a tick of the clock: S2, S3, S4, S6. Sets the next tick.
void tick_synaptic(Synaptic& synaptic, Address own, Ticks now, SynapticSends& sends,
                   Actions& actions);

/// Notes that a tick's data were refused, so that a later tick sends them. (S3-CHANGED)
void keep_change(Synaptic& synaptic, ChannelId id);

}  // namespace rubric::machine
