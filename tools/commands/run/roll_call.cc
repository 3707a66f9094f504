#include "tools/commands/run/roll_call.h"

#include <algorithm>
#include <chrono>

#include "conformance/machine/messages.h"
#include "conformance/node/sizes.h"
#include "conformance/node/types.h"

namespace rubric::run {
namespace {

using std::chrono::steady_clock;

constexpr int kAskAfter = 2;            // Of the time after which a mote is gone: a half.
constexpr int kAskEvery = 8;            // An eighth.
constexpr std::size_t kMotesMax = 255;  // As many as the node watches.

}  // namespace

bool RollCall::takes(const machine::Notice& notice) {
  const auto* ack = std::get_if<machine::AckReceived>(&notice);
  if (ack == nullptr) return false;
  const auto question = questions_.find(ack->seq_num);
  if (question == questions_.end()) return false;
  const auto found = motes_.find(question->second);
  questions_.erase(question);
  if (found == motes_.end()) return true;
  found->second.is_asked = false;
  if (ack->success) found->second.heard = steady_clock::now();
  return true;
}

void RollCall::happened(const machine::Notice& notice, Caller&) {
  const auto now = steady_clock::now();
  if (const auto* message = std::get_if<machine::Received>(&notice)) {
    const std::uint16_t mote = message->src.devid;
    const bool is_mote =
        message->src.pid == island_ && mote != node::kSinkId && !machine::is_reserved(mote);
    if (!is_mote || (motes_.size() >= kMotesMax && !motes_.contains(mote))) return;
    motes_[mote].heard = now;
  }
  if (const auto* left = std::get_if<machine::MoteLeft>(&notice)) motes_.erase(left->address.devid);
}

lines::SteadyTime RollCall::run(Caller& caller) {
  const auto now = steady_clock::now();
  auto next = lines::SteadyTime::max();
  std::uint16_t mote = node::kNullDevid;
  for (auto& [id, presence] : motes_) {
    if (presence.is_asked) continue;
    const auto due = std::max(presence.heard + gone_after_ / kAskAfter,
                              presence.asked + gone_after_ / kAskEvery);
    if (due <= now) mote = id;
    next = std::min(next, due);
  }
  if (mote != node::kNullDevid) ask(mote, caller);
  return next;
}

// A mote may be found gone within the call.
void RollCall::ask(std::uint16_t mote, Caller& caller) {
  motes_[mote].asked = steady_clock::now();
  machine::Send send;
  send.dest = {island_, mote};
  send.app_id = machine::component::kControlLayer;
  send.reliable = true;
  const auto number = std::get<machine::SendResult>(*caller.call(send)).seq_num;
  const auto found = motes_.find(mote);
  if (number == machine::kNoSeq || found == motes_.end()) return;
  found->second.is_asked = true;
  questions_[number] = mote;
}

}  // namespace rubric::run
