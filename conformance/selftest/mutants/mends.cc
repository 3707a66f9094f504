// Ways to accept what a rule ignores. Each is a machine that does not know one of the rules.
#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "conformance/machine/join.h"
#include "conformance/selftest/mutants/fields.h"
#include "conformance/selftest/mutants/generated.h"

namespace rubric::mutants {
namespace {

using machine::Address;
using Phase = machine::JoinMote::Phase;

// Makes the node hear the frame with a change.
template <class Edit>
bool hear_changed(Moment& moment, std::uint8_t am_type, std::size_t least_bytes, Edit edit) {
  const Frame* const frame = moment.heard(am_type);
  if (frame == nullptr || frame->payload.size() < least_bytes) return false;
  Forged& forged = moment.forge(*frame);
  if (!edit(forged)) return false;
  moment.honest(machine::Heard{forged.frame});
  return true;
}

bool own_island(Moment& moment) {
  return hear_changed(moment, am::kNet, net::kBody, [&](Forged& forged) {
    put(forged, net::kDestPid, own(moment).pid);
    return true;
  });
}

bool own_devid(Moment& moment) {
  return hear_changed(moment, am::kNet, net::kBody, [&](Forged& forged) {
    put(forged, net::kDestDevid, own(moment).devid);
    return true;
  });
}

bool own_address(Moment& moment) {
  return hear_changed(moment, am::kNet, net::kBody, [&](Forged& forged) {
    put(forged, net::kDestPid, own(moment).pid);
    put(forged, net::kDestDevid, own(moment).devid);
    return true;
  });
}

bool own_source(Moment& moment) {
  return hear_changed(moment, am::kNet, net::kBody, [&](Forged& forged) {
    put(forged, net::kSrcPid, own(moment).pid);
    return true;
  });
}

bool for_the_base_station(Moment& moment) {
  return hear_changed(moment, am::kNet, net::kBody, [&](Forged& forged) {
    put(forged, net::kDestPid, own(moment).pid);
    put(forged, net::kDestDevid, machine::kNullDevid);
    return true;
  });
}

bool nbytes_that_came(Moment& moment) {
  return hear_changed(moment, am::kNet, net::kBody, [&](Forged& forged) {
    const std::size_t came = std::min<std::size_t>(forged.size() - 12, 102);
    forged.bytes[net::kNbytes] = static_cast<std::uint8_t>(came);
    return true;
  });
}

bool filled_up(Moment& moment) {
  return hear_changed(moment, am::kNet, 12, [&](Forged& forged) {
    const std::size_t nbytes = std::clamp<std::size_t>(forged.bytes[net::kNbytes], 2, 102);
    forged.bytes[net::kNbytes] = static_cast<std::uint8_t>(nbytes);
    const std::size_t size = std::max(forged.size(), 12 + nbytes);
    std::fill(forged.bytes.begin() + static_cast<std::ptrdiff_t>(forged.size()),
              forged.bytes.begin() + static_cast<std::ptrdiff_t>(size), std::uint8_t{5});
    forged.resize(size);
    return true;
  });
}

bool reliable_is_yes(Moment& moment) {
  return hear_changed(moment, am::kNet, net::kBody, [&](Forged& forged) {
    return std::exchange(forged.bytes[net::kReliable], std::uint8_t{1}) > 1;
  });
}

bool plain_transport(Moment& moment) {
  return hear_changed(moment, am::kNet, net::kBody, [&](Forged& forged) {
    forged.bytes[net::kTransId] = component::kConnless;
    return true;
  });
}

bool known_application(Moment& moment) {
  return hear_changed(moment, am::kNet, net::kBody, [&](Forged& forged) {
    forged.bytes[net::kAppId] = 5;  // MOCKUP.
    return true;
  });
}

bool ack_number_fits(Moment& moment) {
  return hear_changed(moment, am::kNet, net::kAckedSeq + 2, [&](Forged& forged) {
    if (!is_ack(forged.frame) || moment.state.awaited.empty()) return false;
    put(forged, net::kAckedSeq, moment.state.awaited[0].seq_num);
    return true;
  });
}

bool ack_sender_fits(Moment& moment) {
  return hear_changed(moment, am::kNet, net::kAckedSeq + 2, [&](Forged& forged) {
    if (!is_ack(forged.frame) || moment.state.awaited.empty()) return false;
    const machine::Awaited& awaited = moment.state.awaited[0];
    put(forged, net::kSrcPid, awaited.dest.pid);
    put(forged, net::kSrcDevid, awaited.dest.devid);
    forged.bytes[net::kAppId] = awaited.app_id;
    return true;
  });
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

bool reply_number_fits(Moment& moment) {
  return hear_changed(moment, am::kJoinReply, 10, [&](Forged& forged) {
    put(forged, join_reply::kSeqNum, moment.state.join.seq_num);
    return true;
  });
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

bool ack_join_number_fits(Moment& moment) {
  return hear_changed(moment, am::kAckJoin, 14, [&](Forged& forged) {
    const auto* asked = machine::find_pending(moment.state.sink, get(forged, ack_join::kSrcDevid));
    if (asked == nullptr) return false;
    put(forged, ack_join::kSeqNum, asked->seq_num);
    return true;
  });
}

bool ack_join_island_fits(Moment& moment) {
  return hear_changed(moment, am::kAckJoin, 14, [&](Forged& forged) {
    put(forged, ack_join::kDestPid, moment.state.island);
    return true;
  });
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

bool config_obeyed(Moment& moment) {
  return hear_changed(moment, am::kConfig, 3, [](Forged& forged) {
    forged.bytes[config::kType] = config::kSetIslandId;
    return true;
  });
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

constexpr std::array kMends{
    Mend{"own island", own_island},
    Mend{"own devid", own_devid},
    Mend{"own address", own_address},
    Mend{"source of own island", own_source},
    Mend{"for the base station", for_the_base_station},
    Mend{"island of the frame", island_of_the_frame},
    Mend{"nbytes that came", nbytes_that_came},
    Mend{"filled up to nbytes", filled_up},
    Mend{"reliable 1", reliable_is_yes},
    Mend{"TRANSID CONNLESS", plain_transport},
    Mend{"APPID MOCKUP", known_application},
    Mend{"number of an awaited ack", ack_number_fits},
    Mend{"sender and APPID of an awaited ack", ack_sender_fits},
    Mend{"ack awaited after all", ack_awaited_after_all},
    Mend{"number of the request", reply_number_fits},
    Mend{"reply expected", reply_expected},
    Mend{"member forgotten", member_forgotten},
    Mend{"place made in the list", place_made},
    Mend{"number of the open join", ack_join_number_fits},
    Mend{"island of the sink", ack_join_island_fits},
    Mend{"join open after all", ack_join_asked_for},
    Mend{"as a sink", as_a_sink},
    Mend{"as a mote", as_a_mote},
    Mend{"as a joining mote", as_a_joining_mote},
    Mend{"as a member", as_a_member},
    Mend{"switched on", switched_on},
    Mend{"oldest incoming gives way", oldest_gives_way},
    Mend{"oldest outgoing gives way", outgoing_oldest_gives_way},
    Mend{"config obeyed", config_obeyed},
    Mend{"taken for a net_msg", taken_for_net},
    Mend{"channels started", channels_started},
    Mend{"accepted just now", accepted_just_now},
};

}  // namespace

std::span<const Mend> mends() { return kMends; }

}  // namespace rubric::mutants
