#include "tools/commands/proxy/mote_network.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <nlohmann/json.hpp>
#include <utility>

#include "codec/generated/rubicon/serial_joined.h"
#include "conformance/machine/messages.h"
#include "tools/commands/run/names.h"

namespace rubric::proxy {
namespace {

constexpr int kTriesMax = 4;
constexpr std::uint16_t kSinkId = 1;
constexpr std::size_t kMotesMax = 1024;  // Anybody may send as any mote.
constexpr std::uint32_t kShortestMs = 20;
constexpr std::uint32_t kLongestMs = 65'535;  // The field has 16 bits.

std::set<std::string> set_of(const std::vector<std::string>& names) {
  return {names.begin(), names.end()};
}

// Reads the mote in 11:5, which is one of this network.
std::uint16_t mote_of(const std::string& device) {
  std::uint16_t mote = 0;
  std::from_chars(device.data() + device.find(':') + 1, device.data() + device.size(), mote);
  return mote;
}

}  // namespace

std::string MoteNetwork::device_of(std::uint16_t mote) const {
  return fmt::format("{}:{}", island_, mote);
}

bool MoteNetwork::is_there(std::uint16_t mote) const {
  const auto found = motes_.find(mote);
  return found != motes_.end() && found->second.there;
}

void MoteNetwork::happened(const machine::Notice& notice, run::Caller& caller) {
  caller_ = &caller;
  if (const auto* message = std::get_if<machine::Received>(&notice)) received(*message);
  if (const auto* left = std::get_if<machine::MoteLeft>(&notice)) leave(left->address.devid);
  const auto* ack = std::get_if<machine::AckReceived>(&notice);
  const auto found = ack ? awaited_.find(ack->seq_num) : awaited_.end();
  if (found == awaited_.end()) return;
  const Request request = found->second;
  awaited_.erase(found);
  confirmed(request, ack->success);
}

void MoteNetwork::confirmed(const Request& request, bool success) {
  const bool again =
      !success && is_there(request.mote) && request.tries < kTriesMax && send(request).empty();
  if (!request.samples && !again) above_.answered(request.command, success);
}

// A mote that is alive does not join again, so its description is kept until it is heard again.
void MoteNetwork::leave(std::uint16_t mote) {
  const auto found = motes_.find(mote);
  if (found == motes_.end() || !std::exchange(found->second.there, false)) return;
  above_.left(device_of(mote));
}

void MoteNetwork::received(const machine::Received& message) {
  const std::uint16_t mote = message.src.devid;
  if (message.src.pid != island_ || mote <= kSinkId || machine::is_reserved(mote)) return;
  if (motes_.size() >= kMotesMax && !motes_.contains(mote)) return;
  const auto view = rubicon::SerialJoinedView::parse(message.data);
  const bool joins = message.app_id == machine::component::kControlLayer && view &&
                     view->msg_type() == rubicon::AmType::kSerialJoined;
  if (joins && static_cast<std::uint16_t>(view->mote_addr()) != mote) return;
  Member& member = motes_[mote];
  bool news = !std::exchange(member.there, true) || joins;
  std::string state;
  if (joins) {
    member.mote.descriptor = {static_cast<std::uint8_t>(view->mote_type()), view->actuators().raw(),
                              view->transducers().raw()};
    member.sensors = set_of(run::transducer_names(member.mote.descriptor.transducers));
    member.described = true;
  } else {
    state = space::state_data(member.mote, message.app_id, message.data);
  }
  if (!member.described && !state.empty()) {
    const std::set<std::string> known = set_of(run::transducer_names(0xFFFF));
    const auto readings = nlohmann::json::parse(state);
    for (const auto& [sensor, reading] : readings.items()) {
      if (known.contains(sensor)) news |= member.sensors.insert(sensor).second;
    }
  }
  if (news) {
    above_.joined({device_of(mote), member.sensors,
                   set_of(run::actuator_names(member.mote.descriptor.actuators)),
                   member.described});
  }
  if (!state.empty()) above_.read(device_of(mote), state);
}

void MoteNetwork::sample(const std::string& device, const Sampling& wanted) {
  const std::uint32_t period =
      wanted.period_ms == 0 ? 0 : std::clamp(wanted.period_ms, kShortestMs, kLongestMs);
  const nlohmann::json wish = {{"sampling_ms", period}, {"transducers", wanted.sensors}};
  const Request request{mote_of(device), wish.dump(), true, 0, 0};
  unsent_.erase(request.mote);
  if (!send(request).empty()) unsent_[request.mote] = request;
}

lines::SteadyTime MoteNetwork::run() {
  std::erase_if(unsent_, [this](const auto& one) {
    return !is_there(one.first) || send(one.second).empty();
  });
  constexpr lines::Milliseconds kAgain{50};
  return unsent_.empty() ? lines::SteadyTime::max() : std::chrono::steady_clock::now() + kAgain;
}

std::string MoteNetwork::command(const std::string& device, const std::string& text,
                                 std::uint64_t number) {
  return send({mote_of(device), nlohmann::json{{"command", text}}.dump(), false, 0, number});
}

std::string MoteNetwork::send(const Request& request) {
  space::Wish wish;
  const std::string wrong = space::parse_wish(request.wish, wish);
  if (!wrong.empty()) return wrong;
  // What is wanted now replaces what was wanted before and is not confirmed yet.
  std::erase_if(awaited_, [&](const auto& one) {
    return request.samples && one.second.samples && one.second.mote == request.mote;
  });
  machine::Send send;
  send.dest = {island_, request.mote};
  send.app_id = wish.app_id;
  send.reliable = true;
  send.data = Bytes(wish.data.data(), wish.data.size());
  const auto result = caller_->call(send);
  const std::uint16_t number = std::get<machine::SendResult>(*result).seq_num;
  if (number == machine::kNoSeq) return run::refusal_text(caller_->refusal(send));
  Request& awaited = awaited_[number] = request;
  ++awaited.tries;
  return {};
}

}  // namespace rubric::proxy
