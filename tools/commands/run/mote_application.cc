#include "tools/commands/run/mote_application.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "codec/generated/rubicon/read_updates.h"
#include "codec/generated/rubicon/updates.h"
#include "conformance/machine/messages.h"

namespace rubric::run {
namespace {

using std::chrono::steady_clock;

constexpr lines::Milliseconds kJoinAgain{1000};
constexpr lines::Milliseconds kShortest{20};

// A wave of its own for each sensor, in the n-th reading.
std::uint16_t reading(rubicon::TransducerMask sensor, std::uint32_t n) {
  const double wave = std::sin(n / 10.0 + sensor.raw());
  if (sensor.has(rubicon::TransducerMask::kTemp)) {
    return static_cast<std::uint16_t>(std::lround((21.5 + 2 * wave + 40) * 100));
  }
  return static_cast<std::uint16_t>(std::lround(500 + 300 * wave));
}

}  // namespace

void MoteApplication::happened(const machine::Notice& notice, Caller&) {
  if (const auto* joined = std::get_if<machine::Joined>(&notice)) {
    joined_ = joined_ || joined->success;
    if (joined_) {
      send_at_ = steady_clock::now() + period_;
    } else {
      join_at_ = steady_clock::now() + kJoinAgain;
    }
  }
  const auto* received = std::get_if<machine::Received>(&notice);
  if (received != nullptr && received->app_id == machine::component::kControlLayer) {
    asked(received->data);
  }
}

void MoteApplication::asked(Bytes data) {
  const auto view = rubicon::ReadUpdatesView::parse(data);
  if (!view || view->type() != rubicon::AmType::kReadUpdates) return;
  // It reads only the transducers that it has.
  transducers_ = static_cast<std::uint16_t>(view->transducers().raw() & descriptor_.transducers);
  period_ = lines::Milliseconds(view->sampling_rate());
  send_at_ = steady_clock::now() + std::max(period_, kShortest);
}

lines::SteadyTime MoteApplication::run(Caller& caller) {
  const auto now = steady_clock::now();
  if (now >= join_at_) {
    join_at_ = lines::SteadyTime::max();
    caller.call(machine::JoinIsland{descriptor_});
  }
  if (!demo_ || !joined_ || period_.count() == 0) return join_at_;
  if (now >= send_at_) {
    send_at_ = now + std::max(period_, kShortest);
    send(caller);
  }
  return std::min(join_at_, send_at_);
}

void MoteApplication::send(Caller& caller) {
  rubicon::Updates updates;
  updates.type = rubicon::AmType::kUpdates;
  ++sent_;
  for (std::uint32_t bit = 1; bit <= transducers_; bit <<= 1) {
    const rubicon::TransducerMask sensor(static_cast<std::uint16_t>(transducers_ & bit));
    if (sensor.raw() == 0) continue;
    rubicon::TransducerUpdate& update = updates.updates.items[updates.updates.count++];
    update.transducer = sensor;
    update.value = reading(sensor, sent_);
  }
  if (updates.updates.count == 0) return;
  std::uint8_t room[rubicon::UpdatesView::kMaxSizeBytes];
  const auto bytes = rubicon::write(updates, MutableBytes(room, sizeof room));
  machine::Send send;
  send.dest = {machine::kLocalPid, machine::kNullDevid};
  send.app_id = machine::component::kControlLayer;
  send.data = Bytes(bytes->data(), bytes->size());
  caller.call(send);
}

}  // namespace rubric::run
