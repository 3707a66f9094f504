#include "conformance/adapters/cpp/synaptic.h"

#include <algorithm>
#include <utility>

#include "codec/runtime/bytes.h"

namespace rubric::cpp_node {
namespace {

constexpr std::size_t kConnectionsMax = 10;

ChannelId channel_id(std::uint16_t source, std::uint16_t destination) {
  return ChannelId{source} << 16 | destination;
}

}  // namespace

const Synaptic::Channel* Synaptic::find(Direction direction, ChannelId id) const {
  for (const Channel& channel : channels_) {
    if (channel.direction == direction && channel.id == id) return &channel;
  }
  return nullptr;
}
Synaptic::Channel* Synaptic::find(Direction direction, ChannelId id) {
  return const_cast<Channel*>(std::as_const(*this).find(direction, id));
}

std::optional<ChannelId> Synaptic::create(Direction direction, Address own, Address peer,
                                          std::size_t size, Mode mode) {
  if (peer.island == kLocal) peer.island = own.island;
  const bool out = direction == Direction::kOut;
  const ChannelId id =
      out ? channel_id(own.device, peer.device) : channel_id(peer.device, own.device);
  Channel* channel = find(direction, id);
  if (size == 0 || (channel ? channel->values.size() : 0) + size > kConnectionsMax) return {};
  if (!channel) {
    const auto used = std::count_if(channels_.begin(), channels_.end(),
                                    [&](const Channel& one) { return one.direction == direction; });
    if (static_cast<std::size_t>(used) >= room_) return {};
    channel = &channels_.emplace_back();
    channel->direction = direction;
    channel->id = id;
    channel->peer = peer;
    channel->mode = mode;
  }
  if (channel->peer != peer) return {};  // An id holds no island: two peers would share it.
  //= S1-ENLARGE: Creating a channel that exists enlarges it by size.
  channel->values.resize(channel->values.size() + size);
  if (out) channel->fresh = true;
  return id;
}

bool Synaptic::dispose(ChannelId id) {
  const auto gone = std::erase_if(channels_, [&](const Channel& one) { return one.id == id; });
  rest();
  return gone > 0;
}

void Synaptic::begin(Channel& channel, Ticks now) {
  if (channel.started) return;
  channel.started = true;
  //= S3-FIRST: The first tick after start sends the values in either mode.
  if (channel.direction == Direction::kOut) channel.fresh = true;
  if (!next_tick_) next_tick_ = now + period_ + phase_;
}

// Stops the clock while no channel is started.
void Synaptic::rest() {
  const auto started = [](const Channel& one) { return one.started; };
  if (std::none_of(channels_.begin(), channels_.end(), started)) next_tick_.reset();
}

bool Synaptic::start(ChannelId id, Ticks now) {
  bool known = false;
  for (Channel& channel : channels_) {
    if (channel.id != id) continue;
    begin(channel, now);
    known = true;
  }
  return known;
}

bool Synaptic::stop(ChannelId id) {
  bool known = false;
  for (Channel& channel : channels_) {
    if (channel.id != id) continue;
    channel.started = false;
    known = true;
  }
  rest();
  return known;
}

void Synaptic::start_all(Ticks now) {
  for (Channel& channel : channels_) begin(channel, now);
}

void Synaptic::stop_all() {
  for (Channel& channel : channels_) channel.started = false;
  rest();
}

bool Synaptic::set_period(Ticks period) {
  if (period == 0) return false;
  period_ = period;
  return true;
}

bool Synaptic::write(ChannelId id, std::size_t pos, float value) {
  Channel* channel = find(Direction::kOut, id);
  if (!channel || pos >= channel->values.size()) return false;
  // Compares bits, for a NaN is unlike itself.
  channel->fresh |= bits_of_float(channel->values[pos]) != bits_of_float(value);
  channel->values[pos] = value;
  return true;
}

std::optional<float> Synaptic::read(ChannelId id, std::size_t pos) const {
  const Channel* channel = find(Direction::kIn, id);
  if (!channel || pos >= channel->values.size()) return {};
  return channel->values[pos];
}

void Synaptic::take(Address own, Address src, const Values& values) {
  const ChannelId id = channel_id(src.device, own.device);
  Channel* channel = find(Direction::kIn, id);
  //= S5-UNKNOWN: Data for an unknown channel is reported by its status and not stored.
  if (!channel || channel->peer != src) return world_.syn_data(id, DataStatus::kUnknownChannel);
  const std::size_t count = std::min(values.size(), channel->values.size());
  std::copy_n(values.begin(), count, channel->values.begin());
  channel->fresh = true;
}

//= S4-LOCAL: A channel from a node to itself hands its values over at the tick without sending
//= anything.
void Synaptic::hand_over(Channel& channel, Address own) {
  if (channel.peer != own) {
    // Values that could not be sent go with the next tick.
    if (send_(channel.peer, channel.values)) channel.fresh = false;
    return;
  }
  channel.fresh = false;
  if (find(Direction::kIn, channel.id)) take(own, own, channel.values);
}

void Synaptic::tick(Address own) {
  *next_tick_ += period_;
  for (Channel& channel : channels_) {
    const bool out = channel.started && channel.direction == Direction::kOut;
    if (out && (channel.mode == Mode::kReliable || channel.fresh)) hand_over(channel, own);
  }
  for (Channel& channel : channels_) {
    if (!channel.started || channel.direction == Direction::kOut) continue;
    world_.syn_data(channel.id, channel.fresh ? DataStatus::kNew : DataStatus::kOld);
    channel.fresh = false;
  }
}

}  // namespace rubric::cpp_node
