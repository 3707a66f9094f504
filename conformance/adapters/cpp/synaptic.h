// Synaptic channels: values that are sent, or signalled, at each tick of one clock (S1 to S6).
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "conformance/adapters/cpp/world.h"

namespace rubric::cpp_node {

enum class Direction : std::uint8_t { kOut, kIn };
enum class Mode : std::uint8_t { kReliable, kPowerSave };
using Values = std::vector<float>;

class Synaptic {
 public:
  /// Sends values to an address; returns false if they could not be sent.
  using Send = std::function<bool(Address dest, const Values& values)>;

  /// Makes `room` channels of each direction; the first tick comes `phase` later than a period.
  Synaptic(std::size_t room, Ticks phase, World& world, Send send)
      : room_(room), phase_(phase), world_(world), send_(std::move(send)) {}

  /// Returns the channel's id; nothing if it is refused, and then nothing changed.
  std::optional<ChannelId> create(Direction direction, Address own, Address peer, std::size_t size,
                                  Mode mode);
  // These return false if there is no such channel, or no such position.
  bool dispose(ChannelId id);
  bool start(ChannelId id, Ticks now);
  bool stop(ChannelId id);
  bool write(ChannelId id, std::size_t pos, float value);
  std::optional<float> read(ChannelId id, std::size_t pos) const;
  void start_all(Ticks now);
  void stop_all();
  bool set_period(Ticks period);

  /// Takes values from `src`; those beyond the channel's size are left-over bytes.
  void take(Address own, Address src, const Values& values);

  std::optional<Ticks> next_tick() const { return next_tick_; }
  void tick(Address own);

 private:
  struct Channel {
    Direction direction = Direction::kOut;
    ChannelId id = 0;
    Address peer;
    Mode mode = Mode::kReliable;
    Values values;
    bool started = false;
    bool fresh = false;  ///< Not yet sent, or not yet signalled.
  };
  const Channel* find(Direction direction, ChannelId id) const;
  Channel* find(Direction direction, ChannelId id);
  void begin(Channel& channel, Ticks now);
  void rest();
  void hand_over(Channel& channel, Address own);

  std::size_t room_;
  Ticks phase_;
  World& world_;
  Send send_;
  std::vector<Channel> channels_;
  Ticks period_ = 500;
  std::optional<Ticks> next_tick_;  ///< While a channel is started.
};

}  // namespace rubric::cpp_node
