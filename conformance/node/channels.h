// Synaptic channels and their clock. (paper: Synaptic Communication)
#pragma once

#include <string.h>

#include "codec/generated/rubicon/synaptic_data.h"
#include "conformance/node/driver.h"
#include "conformance/node/sizes.h"

namespace rubric {
namespace node {

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
  ChannelList(Channel* places, uint8_t room) : channels_(places), room_(room), limit_(room) {}
  /// Allows `limit` channels, if there is room.
  void reset(uint8_t limit);
  uint8_t size() const { return count_; }
  Channel& operator[](uint8_t i) { return channels_[i]; }
  Channel* find(ChannelId id);
  bool dispose(ChannelId id);
  bool create(ChannelId id, uint16_t own_pid, uint16_t peer_pid, uint8_t size, Mode mode);
  void start(Channel& channel, bool fresh);
  void start_all(bool fresh);
  void stop_all();
  bool any_started() const;

 private:
  Channel* channels_;
  uint8_t count_ = 0;
  uint8_t room_;
  uint8_t limit_;
};

class Channels {
 public:
  /// Borrows places for `room` outputs and as many inputs.
  Channels(Channel* places, uint8_t room) : out_(places, room), in_(places + room, room) {}
  /// Allows `limit` channels of each direction, if there is room.
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
  bool running_ = false;
};

using FloatsAt = rubicon::SynapticDataLayout::ValuesAt;
constexpr uint8_t kFloatBytes = FloatsAt::kUnitBytes;

inline ChannelId channel_id(uint16_t source, uint16_t destination) {
  return static_cast<ChannelId>(source) << 16 | destination;
}

// Ids hold no island, but peers do. (decision 130)
inline bool same_island(uint16_t a, uint16_t b, uint16_t own_pid) {
  if (a == kLocalIsland) a = own_pid;
  if (b == kLocalIsland) b = own_pid;
  return a == b;
}

inline Channel* ChannelList::find(ChannelId id) {
  for (uint8_t i = 0; i < count_; ++i) {
    if (channels_[i].id == id) return &channels_[i];
  }
  return nullptr;
}

inline bool ChannelList::dispose(ChannelId id) {
  Channel* const channel = find(id);
  if (channel == nullptr) return false;
  --count_;
  const uint8_t behind = static_cast<uint8_t>(&channels_[count_] - channel);
  memmove(channel, channel + 1, sizeof(Channel) * behind);
  return true;
}

inline bool ChannelList::create(ChannelId id, uint16_t own_pid, uint16_t peer_pid, uint8_t size,
                                Mode mode) {
  Channel* channel = find(id);
  const uint8_t before = channel == nullptr ? uint8_t{0} : channel->size;
  //= S1-LIMIT: Creation beyond the stated number of channels of a direction (four unless the node
  //= says otherwise), or ten connections of a channel, is refused and changes nothing.
  if (size == 0 || size > kConnectionsMax - before) return false;
  if (channel != nullptr) {
    // One to the same devid of another island would be taken for this one.
    if (!same_island(channel->peer_pid, peer_pid, own_pid)) return false;
    //= S1-ENLARGE: Creating a channel that exists enlarges it by size.
    channel->size = static_cast<uint8_t>(before + size);
    return true;
  }
  if (count_ >= limit_) return false;
  channel = &channels_[count_++];
  memset(channel, 0, sizeof(*channel));
  channel->id = id;
  channel->peer_pid = peer_pid;
  channel->size = size;
  //= S1-MODE: The mode given at creation, reliable or power-save, is the one in which the channel
  //= sends.
  channel->power_save = mode == Mode::kPowerSave;
  return true;
}

inline void ChannelList::start(Channel& channel, bool fresh) {
  if (channel.started) return;
  channel.started = true;
  channel.fresh = fresh;
}

inline void ChannelList::start_all(bool fresh) {
  for (uint8_t i = 0; i < count_; ++i) start(channels_[i], fresh);
}

inline void ChannelList::stop_all() {
  for (uint8_t i = 0; i < count_; ++i) channels_[i].started = channels_[i].fresh = false;
}

inline bool ChannelList::any_started() const {
  for (uint8_t i = 0; i < count_; ++i) {
    if (channels_[i].started) return true;
  }
  return false;
}

inline void ChannelList::reset(uint8_t limit) {
  count_ = 0;
  limit_ = limit < room_ ? limit : room_;
}

inline void Channels::reset(uint8_t limit) {
  out_.reset(limit);
  in_.reset(limit);
  period_ = kSynapticPeriodTicks;
  end_clock();
}

inline void Channels::begin_clock(Ticks now, Ticks phase) {
  //= S6-CLOCK: Starting a channel again does not shift the clock of the others.
  if (running_) return;
  running_ = true;
  phase_ = phase;
  due_ = now + phase + period_;
}

inline void Channels::end_clock() { running_ = out_.any_started() || in_.any_started(); }

inline ChannelResult Channels::create(bool out, Address own, Address peer, uint8_t size,
                                      Mode mode) {
  //= S1-ID: Creating a channel returns its id: source devid in the upper, destination devid in the
  //= lower 16 bits.
  const ChannelId id = out ? channel_id(own.devid, peer.devid) : channel_id(peer.devid, own.devid);
  ChannelList& list = out ? out_ : in_;
  return {id, list.create(id, own.pid, peer.pid, size, mode)};
}

inline bool Channels::dispose(ChannelId id) {
  //= S6-DISPOSED: A disposed channel sends nothing, signals nothing and frees its place.
  const bool out = out_.dispose(id);  // A local channel has both ends here.
  const bool in = in_.dispose(id);
  end_clock();
  return out || in;
}

inline bool Channels::start(ChannelId id, Ticks now, Ticks phase) {
  Channel* const out = out_.find(id);
  Channel* const in = in_.find(id);
  if (out == nullptr && in == nullptr) return false;
  //= S3-FIRST: The first tick after start sends the values in either mode.
  if (out != nullptr) out_.start(*out, true);
  if (in != nullptr) in_.start(*in, false);
  begin_clock(now, phase);
  return true;
}

inline bool Channels::stop(ChannelId id) {
  Channel* const out = out_.find(id);
  Channel* const in = in_.find(id);
  //= S6-OTHERS: stop_syn_channel stops that channel only.
  if (out != nullptr) out->started = out->fresh = false;
  if (in != nullptr) in->started = in->fresh = false;
  end_clock();
  return out != nullptr || in != nullptr;
}

inline void Channels::start_all(Ticks now, Ticks phase) {
  out_.start_all(true);
  in_.start_all(false);
  if (out_.any_started() || in_.any_started()) begin_clock(now, phase);
}

inline void Channels::stop_all() {
  out_.stop_all();
  in_.stop_all();
  end_clock();
}

inline bool Channels::write(ChannelId id, uint8_t pos, float value) {
  Channel* const channel = out_.find(id);
  //= S1-WRITE: write_output_value sets the value at pos, which the next tick sends; a pos outside
  //= the channel is refused.
  if (channel == nullptr || pos >= channel->size) return false;
  uint8_t bytes[kFloatBytes];
  FloatsAt::store(bytes, 0, value);
  uint8_t* const at = channel->values + kFloatBytes * pos;
  // A value that changes there and back between two ticks has changed.
  if (memcmp(at, bytes, kFloatBytes) != 0) channel->fresh = true;
  memcpy(at, bytes, kFloatBytes);
  return true;
}

inline InputValue Channels::read(ChannelId id, uint8_t pos) {
  const Channel* const channel = in_.find(id);
  //= S1-READ: read_input_value tells the value at pos that was received last; a pos outside the
  //= channel is refused.
  if (channel == nullptr || pos >= channel->size) return {0, false};
  return {FloatsAt::load(channel->values, pos), true};
}

inline bool Channels::set_period(uint16_t ticks, Ticks now) {
  if (ticks == 0) return false;
  period_ = ticks;
  if (running_) due_ = now + phase_ + ticks;
  return true;
}

inline void Channels::hear(Address own, Address src, Bytes floats, Application& application) {
  const ChannelId id = channel_id(src.devid, own.devid);
  Channel* const channel = in_.find(id);
  //= S5-UNKNOWN: Data for an unknown channel is reported by its status and not stored.
  if (channel == nullptr || !same_island(channel->peer_pid, src.pid, own.pid)) {
    return application.syn_data_received(id, DataStatus::kUnknownChannel);
  }
  if (!channel->started) return;
  // The data do not show how many connections their sender meant; takes what both sides have.
  // (decision 8)
  size_t count = floats.size() / kFloatBytes;
  if (count > channel->size) count = channel->size;
  if (count == 0) return;
  memcpy(channel->values, floats.data(), kFloatBytes * count);
  channel->fresh = true;
}

inline bool Channels::tick(Ticks now) {
  if (!running_ || !is_reached(due_, now)) return false;
  //= S2-TICK: A channel sends at most once a tick, and ticks are no closer than the clock's period.
  // A tick that is handled late, when it has partly gone, must not bring the next one closer.
  due_ = now == due_ ? now + period_ : now + period_ + 1;
  phase_ = 0;
  return true;
}

inline bool Channels::next_due(Ticks& due) const {
  due = due_;
  return running_;
}

inline bool Channels::takes_part(Channel& channel) {
  if (!channel.started) return false;
  //= S3-UNCHANGED: In power-save mode a tick, but for the first after start, sends nothing when no
  //= value changed since the last tick.
  const bool takes = channel.fresh || !channel.power_save;
  channel.fresh = false;
  return takes;
}

inline bool Channels::is_local(const Channel& channel, Address own) const {
  return static_cast<uint16_t>(channel.id) == own.devid &&
         same_island(channel.peer_pid, own.pid, own.pid);
}

inline void Channels::hand_over(const Channel& channel, Address own) {
  //= S4-LOCAL: A channel from a node to itself hands its values over at the tick without sending
  //= anything.
  Channel* const in = in_.find(channel.id);
  if (in == nullptr || !in->started || !same_island(in->peer_pid, own.pid, own.pid)) return;
  memcpy(in->values, channel.values,
         size_t{kFloatBytes} * (in->size < channel.size ? in->size : channel.size));
  in->fresh = true;
}

inline void Channels::signal_inputs(Application& application) {
  for (uint8_t i = 0; i < in_.size(); ++i) {
    Channel& channel = in_[i];
    if (!channel.started) continue;
    //= S2-SIGNAL: At each tick every started input channel signals synData_received with status new
    //= or old.
    const DataStatus status = channel.fresh ? DataStatus::kNew : DataStatus::kOld;
    channel.fresh = false;
    application.syn_data_received(channel.id, status);
  }
}

}  // namespace node
}  // namespace rubric
