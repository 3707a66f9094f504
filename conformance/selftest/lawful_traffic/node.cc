// Clock, buffers and synaptic channels of a node.
#include "conformance/selftest/lawful_traffic/node.h"

#include <algorithm>
#include <utility>

#include "conformance/selftest/lawful_traffic/world.h"

namespace rubric::lawful {

Node::Node(World& world, int number, std::uint16_t id, int island_index, const std::string& role)
    : Device(world, number, id, island_index),
      Endpoint(world, number, id, role),
      clock_ppm_(static_cast<int>(
          world.random().between(world.traits().clock_ppm_min, world.traits().clock_ppm_max))) {}

void Node::timer(std::int64_t local_us, std::function<void()> call) {
  const std::int64_t real_us = local_us + local_us * clock_ppm_ / 1'000'000;
  world().scheduler().after(real_us, [this, boot = boots_, call = std::move(call)] {
    if (boot == boots_) call();
  });
}

void Node::work(bool buffered, std::function<void()> call) {
  if (buffered && in_use_ >= world().traits().in_buffer) return;
  const auto delay =
      world().random().between(world().traits().delay_min_us, world().traits().delay_max_us);
  last_work_us_ = std::max(last_work_us_, world().now_us() + delay);
  if (buffered) ++in_use_;
  world().scheduler().at(last_work_us_, [this, buffered, boot = boots_, call = std::move(call)] {
    if (boot != boots_) return;
    if (buffered) --in_use_;
    call();
  });
}

bool Node::radio_full() const { return queued() >= world().traits().out_buffer; }

void Node::transmit_net(const NetMessage& message, std::uint16_t am) {
  RadioFrame frame{.dst = am,
                   .type = static_cast<std::uint8_t>(rubicon::AmType::kNet),
                   .payload = encode(message)};
  transmit(std::move(frame));
}

void Node::reboot_clock() {
  ++boots_;
  ++clock_;
  clock_runs_ = false;
  in_use_ = 0;
  channels_.clear();
}

std::size_t Node::create_out(Address dest, std::size_t size, bool power_save) {
  OutChannel channel{.dest = dest, .size = size, .power_save = power_save};
  channel.values.assign(size, 0.5F);
  channels_.push_back(std::move(channel));
  return channels_.size() - 1;
}

void Node::start(std::size_t channel) {
  if (channel >= channels_.size()) return;
  const bool again = clock_runs_;
  channels_[channel].started = true;
  channels_[channel].first = true;
  if (!clock_runs_) {
    clock_runs_ = true;
    start_clock(world().traits().phase_shift ? phase_us() : 0);
  } else if (again && world().traits().restart_shifts_clock) {
    ++clock_;
    start_clock(0);
  }
}

void Node::stop(std::size_t channel) {
  if (channel < channels_.size()) channels_[channel].started = false;
}

void Node::write_value(std::size_t channel, std::size_t pos, float value) {
  if (channel < channels_.size()) channels_[channel].values[pos] = value;
}

void Node::start_clock(std::int64_t first_us) {
  timer(first_us + world().traits().synaptic_period_us, [this, clock = clock_] { tick(clock); });
}

void Node::tick(int clock) {
  if (clock != clock_) return;
  start_clock(0);
  if (!is_member()) return;
  // The order within a tick is free.
  const std::size_t shift = world().random().below(channels_.size());
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    OutChannel& channel = channels_[(i + shift) % channels_.size()];
    if (channel.started) send_channel(channel);
  }
}

void Node::send_channel(OutChannel& channel) {
  const bool changed = channel.first || channel.values != channel.sent;
  channel.first = false;
  channel.sent = channel.values;
  if (channel.power_save && !changed) return;
  // A channel of a node to itself hands its values over without sending.
  if (channel.dest == address()) return;
  send_unreliable(channel.dest,
                  app_msg(rubicon::Component::kSynChannel, world().traits().synaptic_app,
                          synaptic_body(channel.values)));
}

}  // namespace rubric::lawful
