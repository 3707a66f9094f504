#include "tools/commands/proxy/mote_network.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <nlohmann/json.hpp>

#include "codec/generated/rubicon/serial_joined.h"
#include "conformance/machine/messages.h"
#include "tools/commands/run/names.h"

namespace rubric::proxy {
namespace {

constexpr int kTriesMax = 4;
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

void MoteNetwork::happened(const machine::Notice& notice, run::Caller& caller) {
  caller_ = &caller;
  if (const auto* message = std::get_if<machine::Received>(&notice)) received(*message);
  if (const auto* left = std::get_if<machine::MoteLeft>(&notice)) {
    const auto device = fmt::format("{}:{}", island_, left->address.devid);
    if (motes_.erase(left->address.devid) > 0) above_.left(device);
  }
  const auto* ack = std::get_if<machine::AckReceived>(&notice);
  const auto found = ack ? awaited_.find(ack->seq_num) : awaited_.end();
  if (found == awaited_.end()) return;
  const Request request = found->second;
  awaited_.erase(found);
  if (!ack->success && request.tries < kTriesMax && motes_.contains(request.mote)) send(request);
}

void MoteNetwork::received(const machine::Received& message) {
  if (message.src.pid != island_) return;
  const std::string device = fmt::format("{}:{}", island_, message.src.devid);
  const auto view = rubicon::SerialJoinedView::parse(message.data);
  if (message.app_id == machine::component::kControlLayer && view &&
      view->msg_type() == rubicon::AmType::kSerialJoined) {
    if (static_cast<std::uint16_t>(view->mote_addr()) != message.src.devid) return;
    space::Mote& mote = motes_[message.src.devid];
    mote.descriptor = {static_cast<std::uint8_t>(view->mote_type()), view->actuators().raw(),
                       view->transducers().raw()};
    return above_.joined({device, set_of(run::transducer_names(mote.descriptor.transducers)),
                          set_of(run::actuator_names(mote.descriptor.actuators))});
  }
  const auto known = motes_.find(message.src.devid);
  if (known == motes_.end()) return;
  const std::string state = space::state_data(known->second, message.app_id, message.data);
  if (!state.empty()) above_.read(device, state);
}

void MoteNetwork::sample(const std::string& device, const Sampling& wanted) {
  const std::uint32_t period =
      wanted.period_ms == 0 ? 0 : std::clamp(wanted.period_ms, kShortestMs, kLongestMs);
  const nlohmann::json wish = {{"sampling_ms", period}, {"transducers", wanted.sensors}};
  const Request request{mote_of(device), wish.dump(), true, 0};
  unsent_.erase(request.mote);
  if (!send(request).empty()) unsent_[request.mote] = request;
}

lines::SteadyTime MoteNetwork::run() {
  std::erase_if(unsent_, [this](const auto& one) {
    return !motes_.contains(one.first) || send(one.second).empty();
  });
  constexpr lines::Milliseconds kAgain{50};
  return unsent_.empty() ? lines::SteadyTime::max() : std::chrono::steady_clock::now() + kAgain;
}

std::string MoteNetwork::command(const std::string& device, const std::string& text) {
  return send({mote_of(device), nlohmann::json{{"command", text}}.dump(), false, 0});
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
  if (number == machine::kNoSeq) return "the outgoing buffer is full";
  awaited_[number] = {request.mote, request.wish, request.samples, request.tries + 1};
  return {};
}

}  // namespace rubric::proxy
