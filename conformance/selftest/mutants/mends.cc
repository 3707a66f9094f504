// Ways to accept what a rule ignores. Each is a machine that does not know one of the rules.
#include <algorithm>
#include <concepts>
#include <functional>
#include <utility>
#include <vector>

#include "conformance/machine/join.h"
#include "conformance/selftest/mutants/fields.h"
#include "conformance/selftest/mutants/hunt.h"

namespace rubric::mutants {
namespace {

using machine::Address;
using Phase = machine::JoinMote::Phase;

// Makes the node hear the frame with a change; the edit may return that it makes none.
template <class Edit>  // (Moment&, Forged&).
std::function<bool(Moment&)> hears(std::uint8_t am_type, std::size_t least_bytes, Edit edit) {
  return [=](Moment& moment) {
    const Frame* const frame = moment.heard(am_type);
    if (frame == nullptr || frame->payload.size() < least_bytes) return false;
    Forged& forged = moment.forge(*frame);
    if constexpr (std::predicate<Edit, Moment&, Forged&>) {
      if (!edit(moment, forged)) return false;
    } else {
      edit(moment, forged);
    }
    moment.honest(machine::Heard{forged.frame});
    return true;
  };
}

bool ack_awaited_after_all(Moment& moment) {
  const Frame* const frame = moment.heard(am::kNet);
  if (frame == nullptr || !is_ack(*frame) || moment.state.awaited.full()) return false;
  moment.state.awaited.push({get(*frame, net::kAckedSeq), frame->payload[net::kAppId],
                             Address{get(*frame, net::kSrcPid), get(*frame, net::kSrcDevid)},
                             moment.now + 1000});
  moment.honest();
  return true;
}

bool reply_expected(Moment& moment) {
  const Frame* const frame = moment.heard(am::kJoinReply);
  if (frame == nullptr || frame->payload.size() != 10) return false;
  moment.state.join.phase = Phase::kJoining;
  moment.state.join.seq_num = get(*frame, join_reply::kSeqNum);
  moment.honest();
  return true;
}

bool member_forgotten(Moment& moment) {
  const Frame* const frame = moment.heard();
  auto& members = moment.state.sink.members;
  if (frame == nullptr || members.empty()) return false;
  for (std::size_t i = 0; i < members.size(); ++i) {
    if (members[i].devid == frame->src) members.erase(i);
  }
  moment.honest();
  return true;
}

bool place_made(Moment& moment) {
  auto& members = moment.state.sink.members;
  if (moment.heard() == nullptr || members.empty()) return false;
  members.erase(0);
  moment.honest();
  return true;
}

bool ack_join_asked_for(Moment& moment) {
  const Frame* const frame = moment.heard(am::kAckJoin);
  auto& pending = moment.state.sink.pending;
  if (frame == nullptr || frame->payload.size() != 14 || pending.full()) return false;
  pending.push({get(*frame, ack_join::kSrcDevid), get(*frame, ack_join::kSeqNum), {}});
  moment.honest();
  return true;
}

bool as_role(Moment& moment, Role role) {
  if (moment.heard() == nullptr || moment.is(role)) return false;
  const Role honest = std::exchange(moment.state.config.role, role);
  moment.honest();
  moment.state.config.role = honest;
  return true;
}
bool as_a_sink(Moment& moment) { return as_role(moment, Role::kSink); }
bool as_a_mote(Moment& moment) { return as_role(moment, Role::kMote); }

bool as_a_joining_mote(Moment& moment) {
  const Frame* const frame = moment.heard(am::kJoinReply);
  if (frame == nullptr || frame->payload.size() != 10) return false;
  moment.state.join.phase = Phase::kJoining;
  moment.state.join.seq_num = get(*frame, join_reply::kSeqNum);
  return as_role(moment, Role::kMote);
}

bool as_a_member(Moment& moment) {
  const Frame* const frame = moment.heard(am::kNet);
  if (frame == nullptr || frame->payload.size() < net::kBody || is_member(moment)) return false;
  const machine::JoinMote honest = moment.state.join;
  moment.state.join.phase = Phase::kMember;
  moment.state.join.address = {get(*frame, net::kDestPid), moment.state.config.id};
  moment.honest();
  moment.state.join = honest;
  return true;
}

bool switched_on(Moment& moment) {
  const bool radio = std::exchange(moment.state.radio.on, true);
  const bool serial = std::exchange(moment.state.serial.on, true);
  if (radio && serial) return false;
  moment.honest();
  moment.state.radio.on = radio;
  moment.state.serial.on = serial;
  return true;
}

// Incoming buffers lose their oldest frame.
bool oldest_gives_way(Moment& moment) {
  const Frame* const frame = moment.heard();
  if (frame == nullptr || moment.state.waiting.empty()) return false;
  State& state = moment.state;
  if (state.waiting.front() != frame->link) return false;
  state.waiting.pop();
  if (frame->link == Link::kRadio) {
    state.radio.in.pop();
  } else {
    state.serial.in.pop();
  }
  moment.honest();
  return true;
}

bool outgoing_oldest_gives_way(Moment& moment) {
  State& state = moment.state;
  const bool radio = state.radio.out.full();
  const bool serial = state.serial.out.full();
  if (radio) state.radio.out.pop();
  if (serial) state.serial.out.pop();
  if (!radio && !serial) return false;
  moment.honest();
  return true;
}

bool taken_for_net(Moment& moment) {
  const Frame* const frame = moment.heard();
  if (frame == nullptr || frame->type == am::kNet) return false;
  Forged& forged = moment.forge(*frame);
  forged.frame.type = am::kNet;
  moment.honest(machine::Heard{forged.frame});
  return true;
}

bool channels_started(Moment& moment) {
  auto& inputs = moment.state.synaptic.in;
  std::vector<bool> honest;
  for (machine::Channel& channel : inputs) {
    honest.push_back(channel.started);
    channel.started = true;
  }
  if (std::find(honest.begin(), honest.end(), false) == honest.end()) return false;
  moment.honest();
  for (std::size_t i = 0; i < honest.size(); ++i) inputs[i].started = honest[i];
  return true;
}

bool accepted_just_now(Moment& moment) {
  if (!is_member(moment)) return false;
  moment.state.join.accepted = moment.now;
  moment.honest();
  return true;
}

// A frame for another island is sent on all the same, as it is.
bool island_of_the_frame(Moment& moment) {
  const Frame* const frame = moment.heard(am::kNet);
  if (frame == nullptr || !is_net(*frame) || moment.is(Role::kMote)) return false;
  const std::uint16_t honest = std::exchange(moment.state.island, get(*frame, net::kDestPid));
  moment.honest();
  moment.state.island = honest;
  return true;
}

void add(std::vector<Mend>& out, const char* name, std::function<bool(Moment&)> step) {
  out.push_back({name, std::move(step)});
}

std::vector<Mend> make_mends() {
  std::vector<Mend> out;
  add(out, "own island", hears(am::kNet, net::kBody, [](Moment& moment, Forged& forged) {
        put(forged, net::kDestPid, own(moment).pid);
      }));
  add(out, "own devid", hears(am::kNet, net::kBody, [](Moment& moment, Forged& forged) {
        put(forged, net::kDestDevid, own(moment).devid);
      }));
  add(out, "own address", hears(am::kNet, net::kBody, [](Moment& moment, Forged& forged) {
        put(forged, net::kDestPid, own(moment).pid);
        put(forged, net::kDestDevid, own(moment).devid);
      }));
  add(out, "source of own island", hears(am::kNet, net::kBody, [](Moment& moment, Forged& forged) {
        put(forged, net::kSrcPid, own(moment).pid);
      }));
  add(out, "for the base station", hears(am::kNet, net::kBody, [](Moment& moment, Forged& forged) {
        put(forged, net::kDestPid, own(moment).pid);
        put(forged, net::kDestDevid, machine::kNullDevid);
      }));
  add(out, "island of the frame", island_of_the_frame);
  add(out, "nbytes that came", hears(am::kNet, net::kBody, [](Moment&, Forged& forged) {
        const std::size_t came = std::min<std::size_t>(forged.size() - 12, 102);
        forged.bytes[net::kNbytes] = static_cast<std::uint8_t>(came);
      }));
  add(out, "filled up to nbytes", hears(am::kNet, 12, [](Moment&, Forged& forged) {
        const std::size_t nbytes = std::clamp<std::size_t>(forged.bytes[net::kNbytes], 2, 102);
        forged.bytes[net::kNbytes] = static_cast<std::uint8_t>(nbytes);
        const std::size_t size = std::max(forged.size(), 12 + nbytes);
        std::fill(forged.bytes.begin() + static_cast<std::ptrdiff_t>(forged.size()),
                  forged.bytes.begin() + static_cast<std::ptrdiff_t>(size), std::uint8_t{5});
        forged.resize(size);
      }));
  add(out, "reliable 1", hears(am::kNet, net::kBody, [](Moment&, Forged& forged) {
        return std::exchange(forged.bytes[net::kReliable], std::uint8_t{1}) > 1;
      }));
  add(out, "TRANSID CONNLESS", hears(am::kNet, net::kBody, [](Moment&, Forged& forged) {
        forged.bytes[net::kTransId] = component::kConnless;
      }));
  add(out, "APPID MOCKUP", hears(am::kNet, net::kBody, [](Moment&, Forged& forged) {
        forged.bytes[net::kAppId] = 5;  // MOCKUP.
      }));
  add(out, "number of an awaited ack",
      hears(am::kNet, net::kAckedSeq + 2, [](Moment& moment, Forged& forged) {
        if (!is_ack(forged.frame) || moment.state.awaited.empty()) return false;
        put(forged, net::kAckedSeq, moment.state.awaited[0].seq_num);
        return true;
      }));
  add(out, "sender and APPID of an awaited ack",
      hears(am::kNet, net::kAckedSeq + 2, [](Moment& moment, Forged& forged) {
        if (!is_ack(forged.frame) || moment.state.awaited.empty()) return false;
        const machine::Awaited& awaited = moment.state.awaited[0];
        put(forged, net::kSrcPid, awaited.dest.pid);
        put(forged, net::kSrcDevid, awaited.dest.devid);
        forged.bytes[net::kAppId] = awaited.app_id;
        return true;
      }));
  add(out, "ack awaited after all", ack_awaited_after_all);
  add(out, "number of the request", hears(am::kJoinReply, 10, [](Moment& moment, Forged& forged) {
        put(forged, join_reply::kSeqNum, moment.state.join.seq_num);
      }));
  add(out, "reply expected", reply_expected);
  add(out, "member forgotten", member_forgotten);
  add(out, "place made in the list", place_made);
  add(out, "number of the open join", hears(am::kAckJoin, 14, [](Moment& moment, Forged& forged) {
        const auto* asked =
            machine::find_pending(moment.state.sink, get(forged, ack_join::kSrcDevid));
        if (asked == nullptr) return false;
        put(forged, ack_join::kSeqNum, asked->seq_num);
        return true;
      }));
  add(out, "island of the sink", hears(am::kAckJoin, 14, [](Moment& moment, Forged& forged) {
        put(forged, ack_join::kDestPid, moment.state.island);
      }));
  add(out, "join open after all", ack_join_asked_for);
  add(out, "as a sink", as_a_sink);
  add(out, "as a mote", as_a_mote);
  add(out, "as a joining mote", as_a_joining_mote);
  add(out, "as a member", as_a_member);
  add(out, "switched on", switched_on);
  add(out, "oldest incoming gives way", oldest_gives_way);
  add(out, "oldest outgoing gives way", outgoing_oldest_gives_way);
  add(out, "config obeyed", hears(am::kConfig, 3, [](Moment&, Forged& forged) {
        forged.bytes[config::kType] = config::kSetIslandId;
      }));
  add(out, "taken for a net_msg", taken_for_net);
  add(out, "channels started", channels_started);
  add(out, "accepted just now", accepted_just_now);
  return out;
}

}  // namespace

std::span<const Mend> mends() {
  static const std::vector<Mend> kMends = make_mends();
  return kMends;
}

}  // namespace rubric::mutants
