// Motes that fall silent. No message of the protocol says goodbye, so a sink or base station that
// states a time calls a mote gone when nothing came from it for so long. (decision 124)
#include "codec/generated/rubicon/net_msg.h"
#include "conformance/machine/messages.h"
#include "conformance/machine/node.h"

namespace rubric::machine {
namespace {

// Returns the mote of the island that shows life by this frame; the NULL devid: none. A
// join_request shows none: a member asks no more, so the one that it lists has started anew.
std::uint16_t living(const State& state, const Frame& frame) {
  if (state.config.role == Role::kSink) {
    const bool counts = frame.link == Link::kRadio && frame.type != am::kJoin &&
                        find_member(state.sink, frame.src) != nullptr;
    return counts ? frame.src : kNullDevid;
  }
  if (frame.link != Link::kSerial || frame.type != am::kNet) return kNullDevid;
  const auto message = rubicon::NetMsgView::parse(frame.payload);
  if (!message) return kNullDevid;
  const Address src = address_of(message->src());
  const bool mote = src.pid == state.island && !is_reserved(src.devid) &&
                    src.devid != state.config.profile.sink_id;
  return mote ? src.devid : kNullDevid;
}

// Takes the mote off a sink's list. Not while its report waits for the line: that is owed.
bool forget(JoinSink& sink, std::uint16_t devid) {
  for (const Admission& owed : sink.unreported) {
    if (owed.devid == devid) return false;
  }
  for (std::size_t i = 0; i < sink.members.size(); ++i) {
    if (sink.members[i].devid != devid) continue;
    sink.members.erase(i);
    break;
  }
  return true;
}

}  // namespace

void note_presence(Node& node, const Frame& frame) {
  State& state = node.state;
  if (node.profile().gone_after_ticks == 0 || node.config().role == Role::kMote) return;
  const std::uint16_t devid = living(state, frame);
  if (devid == kNullDevid) return;
  for (std::size_t i = 0; i < state.present.size(); ++i) {
    if (state.present[i].devid != devid) continue;
    state.present[i].heard = node.now;
    return;
  }
  if (!state.present.full()) state.present.push({devid, node.now});
}

Ticks silence_due(const State& state) {
  Ticks oldest = state.present[0].heard;
  for (const Presence& one : state.present) {
    if (static_cast<std::int32_t>(one.heard - oldest) < 0) oldest = one.heard;
  }
  return oldest + state.config.profile.gone_after_ticks;
}

void end_silence(Node& node) {
  State& state = node.state;
  for (std::size_t i = 0; i < state.present.size();) {
    const Presence one = state.present[i];
    if (node.now - one.heard < node.profile().gone_after_ticks) {
      ++i;
      continue;
    }
    if (!forget(state.sink, one.devid)) {
      state.present[i++].heard = node.now;
      continue;
    }
    state.present.erase(i);
    node.actions.notify(MoteLeft{{state.island, one.devid}}, ReqId::kNone);
  }
}

}  // namespace rubric::machine
