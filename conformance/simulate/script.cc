#include "conformance/simulate/script.h"

#include <variant>

#include "codec/generated/rubicon/updates.h"
#include "codec/runtime/bytes.h"

namespace rubric::simulate {
namespace {

// Reasons to wake; sends and cuts are numbered from their first.
constexpr std::uint32_t kJoin = 0;
constexpr std::uint32_t kCompute = 1;
constexpr std::uint32_t kRadioOn = 2;
constexpr std::uint32_t kSends = 1'000;
constexpr std::uint32_t kCuts = 2'000;

constexpr int kReadingMax = 1023;  // The motes have 10-bit converters.

std::vector<std::uint8_t> readings(std::uint16_t transducers, Random& random) {
  rubicon::Updates updates;
  updates.type = rubicon::AmType::kUpdates;
  for (unsigned bit = 1; bit <= transducers; bit <<= 1) {
    if ((transducers & bit) == 0) continue;
    rubicon::TransducerUpdate update;
    update.transducer = rubicon::TransducerMask(static_cast<std::uint16_t>(bit));
    update.value = static_cast<std::uint16_t>(random.between(0, kReadingMax));
    updates.updates.push(update);
  }
  std::vector<std::uint8_t> body(rubicon::UpdatesLayout::size_bytes(updates));
  rubicon::UpdatesLayout::store(updates, body.data());
  return body;
}

}  // namespace

void ScriptedApplication::booted(Host& host) {
  outputs_.clear();
  created_ = 0;
  if (!booted_before_) {
    for (std::size_t i = 0; i < script_.cuts.size(); ++i) {
      host.wake_after(script_.cuts[i].at_us, kCuts + static_cast<std::uint32_t>(i));
    }
  }
  booted_before_ = true;
  if (!script_.join_us) return ready(host);
  host.wake_after(*script_.join_us, kJoin);
}

void ScriptedApplication::woken(Host& host, std::uint32_t token) {
  if (token == kJoin) return host.call(machine::JoinIsland{script_.descriptor});
  if (token == kCompute) return compute(host);
  if (token == kRadioOn) return host.call(machine::SetInterface{machine::Link::kRadio, true});
  if (token >= kCuts) return cut(host, script_.cuts.at(token - kCuts));
  send(host, token - kSends);
}

void ScriptedApplication::notified(Host& host, const machine::Notice& notice) {
  if (const auto* joined = std::get_if<machine::Joined>(&notice)) {
    if (joined->success) return ready(host);
    host.wake_after(script_.rejoin_us, kJoin);
  } else if (const auto* made = std::get_if<machine::ChannelResult>(&notice)) {
    // Results come in the order of the calls.
    const ScriptedChannel& channel = script_.channels.at(created_++);
    const bool out = made->success && channel.direction == machine::Direction::kOut;
    outputs_.push_back(out ? made->id : 0);
    if (created_ == script_.channels.size()) {
      host.call(machine::StartAllChannels{});
      compute(host);
    }
  }
}

void ScriptedApplication::ready(Host& host) {
  for (std::size_t i = 0; i < script_.sends.size(); ++i) {
    host.wake_after(script_.sends[i].first_us, kSends + static_cast<std::uint32_t>(i));
  }
  if (script_.time_step_ticks == 0) return;
  host.call(machine::SetTimeStep{script_.time_step_ticks});
  for (const ScriptedChannel& channel : script_.channels) {
    host.call(machine::CreateChannel{channel.direction, channel.peer, channel.size, channel.mode});
  }
}

void ScriptedApplication::send(Host& host, std::size_t index) {
  const ScriptedSend& send = script_.sends.at(index);
  const std::vector<std::uint8_t> data =
      send.readings_of == 0 ? send.data : readings(send.readings_of, host.random());
  host.call(machine::Send{send.dest, send.app_id, send.reliable, Bytes(data.data(), data.size())});
  if (send.period_us == 0) return;
  host.wake_after(send.period_us, kSends + static_cast<std::uint32_t>(index));
}

// Computes the learning network's output of this cycle, for the next tick.
void ScriptedApplication::compute(Host& host) {
  bool any = false;
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    if (outputs_[i] == 0) continue;
    any = true;
    for (std::uint8_t pos = 0; pos < script_.channels[i].size; ++pos) {
      const auto value = static_cast<float>(host.random().between(0, kReadingMax));
      host.call(machine::WriteOutput{outputs_[i], pos, value / 1024});
    }
  }
  if (any) host.wake_after(us_of(script_.time_step_ticks), kCompute);
}

void ScriptedApplication::cut(Host& host, const ScriptedCut& cut) {
  if (!cut.radio_only) return host.power_off(cut.for_us);
  host.call(machine::SetInterface{machine::Link::kRadio, false});
  if (cut.for_us >= 0) host.wake_after(cut.for_us, kRadioOn);
}

}  // namespace rubric::simulate
