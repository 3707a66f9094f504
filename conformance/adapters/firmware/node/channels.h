// Synaptic channels and their clock. (paper: Synaptic Communication)
#pragma once

#include "codec/runtime/bytes.h"
#include "conformance/adapters/firmware/node/limits.h"
#include "conformance/adapters/firmware/node/ports.h"

namespace rubric {
namespace firmware {

/// One end of a channel. Values are kept as they travel, as little-endian binary32.
struct Channel {
  ChannelId id;
  uint16_t peer_pid;
  uint8_t size;
  bool power_save : 1;
  bool started : 1;
  bool fresh : 1;  ///< Out: changed, or first tick after start. In: came since the last tick.
  uint8_t values[4 * kConnectionsMax];
};
static_assert(sizeof(Channel) <= kPaperChannelBytes, "a channel is larger than the paper's");

/// Channels of one direction, in the order of their creation.
class ChannelList {
 public:
  void clear() { count_ = 0; }
  uint8_t size() const { return count_; }
  Channel& operator[](uint8_t i) { return channels_[i]; }
  Channel* find(ChannelId id);
  bool dispose(ChannelId id);
  /// Creates a channel, `limit` at most.
  bool create(ChannelId id, uint16_t own_pid, uint16_t peer_pid, uint8_t size, Mode mode,
              uint8_t limit);
  void start(Channel& channel, bool fresh);
  void start_all(bool fresh);
  void stop_all();
  bool any_started() const;

 private:
  Channel channels_[kChannelsRoom];
  uint8_t count_ = 0;
};

class Channels {
 public:
  /// Allows `limit` of each direction, at most kChannelsRoom. `phase` delays the clock's first
  /// tick.
  void reset(uint8_t limit);

  ChannelResult create(bool out, Address own, Address peer, uint8_t size, Mode mode);
  bool dispose(ChannelId id);
  bool start(ChannelId id, Ticks now, Ticks phase);
  bool stop(ChannelId id);
  void start_all(Ticks now, Ticks phase);
  void stop_all();
  bool write(ChannelId id, uint8_t pos, float value);
  InputValue read(ChannelId id, uint8_t pos);
  bool set_period(uint16_t ticks, Ticks now);

  /// Handles data from `src`.
  void hear(Address own, Address src, Bytes floats, Application& application);

  /// Returns true once for each tick of the clock.
  bool tick(Ticks now);
  bool next_due(Ticks& due) const;
  uint8_t out_count() const { return out_.size(); }
  Channel& out(uint8_t i) { return out_[i]; }
  /// Returns whether an output takes part in this tick; to be called once a tick for each.
  bool takes_part(Channel& channel);
  bool is_local(const Channel& channel, Address own) const;
  /// Passes a local channel's values to its other end.
  void hand_over(const Channel& channel, Address own);
  /// Handles the other half of a tick.
  void signal_inputs(Application& application);

 private:
  void begin_clock(Ticks now, Ticks phase);
  void end_clock();

  ChannelList out_;
  ChannelList in_;
  Ticks due_ = 0;
  Ticks phase_ = 0;  ///< For the clock's first tick; then 0.
  uint16_t period_ = kSynapticPeriodTicks;
  uint8_t limit_ = kChannelsRoom;
  bool running_ = false;
};

}  // namespace firmware
}  // namespace rubric
