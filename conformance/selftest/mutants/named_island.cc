// Mistakes of sinks and base stations: messages that they pass up, down and across, and island ids.
#include <algorithm>

#include "conformance/selftest/mutants/fields.h"
#include "conformance/selftest/mutants/mutant.h"

namespace rubric::mutants {
namespace {

using machine::Received;
using machine::Send;

bool from_radio(const Moment& moment, const Frame& frame) {
  return is_net(frame) && frame.link == Link::kRadio && moment.is(Role::kSink);
}
bool from_serial(const Moment& moment, const Frame& frame) {
  return is_net(frame) && frame.link == Link::kSerial && moment.is(Role::kSink);
}
bool up(const Moment& moment, const Transmit& frame) {
  return moment.is(Role::kSink) && frame.link == Link::kSerial && is_forward(moment, frame);
}
bool down(const Moment& moment, const Transmit& frame) {
  return moment.is(Role::kSink) && frame.link == Link::kRadio && is_forward(moment, frame);
}
bool handed_down(const Moment& moment, const Transmit& frame) {
  const Frame* const heard = moment.heard(am::kNet);
  return moment.is(Role::kBaseStation) && frame.link == Link::kSerial && heard != nullptr &&
         heard->link == Link::kPeis;
}

// Returns whether a sink that has members does not list this devid.
bool is_not_listed(const Moment& moment, std::uint16_t devid) {
  const auto& members = moment.state.sink.members;
  return !members.empty() && std::none_of(members.begin(), members.end(), [=](const auto& member) {
    return member.devid == devid;
  });
}

void add_sink_up(Mutants& out) {
  add(out, "sink_hears_members_only", "A sink that has members hears no net_msg of other motes.",
      {"N6-DELIVER"_rule, "N6-FORWARD"_rule, "N6-ROUTE"_rule},
      hear_only([](const Moment& moment, const Frame& frame) {
        return !from_radio(moment, frame) || !is_not_listed(moment, frame.src);
      }));
  add(out, "sink_hears_no_broadcast", "A sink does not deliver a broadcast of its island.",
      {"N6-DELIVER"_rule}, hear_only([](const Moment& moment, const Frame& frame) {
        return !from_radio(moment, frame) ||
               get(frame, net::kDestDevid) != machine::kBroadcastDevid;
      }));
  add(out, "sink_keeps_base_stations", "A sink takes what is for its base station.",
      {"N6-FORWARD"_rule}, edit_heard([](Moment& moment, Forged& forged) {
        if (from_radio(moment, forged.frame) &&
            get(forged, net::kDestDevid) == machine::kNullDevid) {
          put(forged, net::kDestDevid, own(moment).devid);
        }
      }));
  add(out, "sink_forwards_nothing_foreign", "A sink drops what leaves its island.",
      {"N6-ROUTE"_rule}, hear_only([](const Moment& moment, const Frame& frame) {
        return !from_radio(moment, frame) || get(frame, net::kDestPid) == own(moment).pid;
      }));
  add(out, "sink_forwards_foreign_source", "A sink forwards its neighbours' messages.",
      {"N6-COLLISION"_rule}, after_step([](Moment& moment) {
        moment.rewrite([&](const Action& action) {
          moment.keep(action);
          const bool collision =
              action.what == Action::What::kIgnored && action.requirement == "N6-COLLISION"_rule;
          const Frame* const frame = moment.heard();
          if (!collision || frame == nullptr) return;
          Transmit& sent =
              moment.send(Link::kSerial, am::kNet, machine::kAmBroadcast, "N6-COLLISION"_rule);
          sent.size_bytes = machine::kAmPayloadMax;
          std::copy(frame->payload.begin(), frame->payload.end(), sent.payload.begin());
        });
      }));
  add(out, "sink_delivers_foreign", "A sink takes what is for devid 1 of another island.",
      {"N6-COLLISION"_rule, "N6-ROUTE"_rule}, edit_heard([](Moment& moment, Forged& forged) {
        if (from_radio(moment, forged.frame) && get(forged, net::kDestDevid) == 1) {
          put(forged, net::kDestPid, own(moment).pid);
        }
      }));
  add(out, "forward_signed_by_the_sink", "What a sink hands up has the sink as its source.",
      {"N6-CONTENT"_rule, "N6-FORWARD"_rule, "N6-ROUTE"_rule}, sent_field(up, net::kSrcDevid, 1));
  add(out, "forward_unreliable", "A sink hands up with reliable 0.",
      {"N6-CONTENT"_rule, "N6-FORWARD"_rule, "N6-ROUTE"_rule}, sent_field(up, net::kReliable, 0));
  add(out, "forward_numbered_by_the_sink", "A sink hands up with a number of its own.",
      {"N6-CONTENT"_rule, "N6-FORWARD"_rule, "N6-ROUTE"_rule}, sent_field(up, net::kSeqNum, 4711));
  add(out, "forwarded_twice", "A sink hands each message up twice.", {"N6-ONCE"_rule},
      double_sent(up));
  add(out, "forwarded_and_acked", "A sink acks what it hands up, in its base station's place.",
      {"N6-FORWARD"_rule, "N6-ROUTE"_rule}, after_step([](Moment& moment) {
        const Frame* const heard = moment.heard();
        const bool reliable =
            heard != nullptr && from_radio(moment, *heard) && heard->payload[net::kReliable] == 1;
        const auto sent = moment.actions.transmits();
        if (!reliable || sent.empty() || sent[0].link != Link::kSerial) return;
        Transmit& ack = moment.send(Link::kRadio, am::kNet, heard->src, "T2-ACK"_rule);
        ack.size_bytes = net::kBody + rubicon::RubiconAckView::kMaxSizeBytes;
        ack.payload[net::kTransId] = component::kRubiconAck;
      }));
  add(out, "sink_delivers_others", "A sink delivers what is for one of its motes.",
      {"N6-OTHER"_rule}, edit_heard([](Moment& moment, Forged& forged) {
        const std::uint16_t devid = get(forged, net::kDestDevid);
        if (from_radio(moment, forged.frame) && devid < machine::kNullDevid &&
            get(forged, net::kDestPid) == own(moment).pid) {
          put(forged, net::kDestDevid, own(moment).devid);
        }
      }));
  add(out, "sink_radiates_its_own", "What a sink sends to others' islands goes by radio.",
      {"N6-OWN"_rule, "N1-SEQ"_rule, "N1-SRC"_rule, "N2-QUEUE"_rule},
      edit_sent([](Moment& moment, Transmit& frame) {
        const bool mine = is_send(moment, frame) && moment.is(Role::kSink);
        if (!mine || frame.link != Link::kSerial) return;
        frame.link = Link::kRadio;
        frame.dest = get(frame, net::kDestDevid);
        frame.src = 1;
      }));
}

void add_sink_down(Mutants& out) {
  add(out, "serial_not_delivered", "A sink radiates all that comes by serial, and reads none.",
      {"N7-DELIVER"_rule, "N2-IN-ORDER"_rule}, on_told_of<Received>([](Moment& moment, Received&) {
        const Frame* const frame = moment.heard();
        const bool serial = frame != nullptr && from_serial(moment, *frame);
        return serial ? Fate::kDrop : Fate::kKeep;
      }));
  add(out, "serial_not_radiated", "A sink sends nothing on.", {"N7-RADIO"_rule}, drop_sent(down));
  add(out, "radiated_to_all", "A sink sends a mote's message on to everybody.",
      {"N7-RADIO"_rule, "N7-CONTENT"_rule},
      edit_sent(down, [](Moment&, Transmit& frame) { frame.dest = machine::kAmBroadcast; }));
  add(out, "radiated_signed_by_the_sink", "What a sink sends on has the sink as its source.",
      {"N7-CONTENT"_rule, "N7-RADIO"_rule}, sent_field(down, net::kSrcDevid, 1));
  add(out, "radiated_with_stale_bytes", "A sink radiates the bytes after the payload.",
      {"N7-CONTENT"_rule}, edit_sent([](Moment& moment, Transmit& frame) {
        const Frame* const heard = moment.heard();
        if (heard == nullptr || !down(moment, frame)) return;
        std::copy(heard->payload.begin(), heard->payload.end(), frame.payload.begin());
        frame.size_bytes = static_cast<std::uint8_t>(heard->payload.size());
      }));
  add(out, "radiated_with_full_length", "A sink radiates with nbytes 102.",
      {"N7-CONTENT"_rule, "N7-RADIO"_rule}, edit_sent(down, [](Moment&, Transmit& frame) {
        const auto end = frame.payload.begin() + frame.size_bytes;
        std::fill(end, frame.payload.end(), std::uint8_t{0});
        frame.payload[net::kNbytes] = net::kNbytes.kMax;
        frame.size_bytes = machine::kAmPayloadMax;
      }));
  add(out, "foreign_radiated", "A sink radiates by the devid alone.", {"N7-FOREIGN"_rule},
      always([](Moment& moment) {
        const Frame* const frame = moment.heard();
        const bool serial = frame != nullptr && from_serial(moment, *frame);
        const bool foreign = serial && get(*frame, net::kDestPid) != own(moment).pid;
        const std::uint16_t island = moment.state.island;
        if (foreign) moment.state.island = get(*frame, net::kDestPid);
        moment.honest();
        if (foreign) moment.state.island = island;
      }));
  add(out, "foreign_sent_back_up", "A sink hands a foreign message back to its base station.",
      {"N6-ONCE"_rule}, after_step([](Moment& moment) {
        const Frame* const frame = moment.heard();
        const bool serial = frame != nullptr && from_serial(moment, *frame);
        if (!serial || get(*frame, net::kDestPid) == own(moment).pid) return;
        Transmit& sent =
            moment.send(Link::kSerial, am::kNet, machine::kAmBroadcast, "N6-ONCE"_rule);
        sent.size_bytes = machine::kAmPayloadMax;
        std::copy(frame->payload.begin(), frame->payload.end(), sent.payload.begin());
      }));
}

void add_base_station(Mutants& out) {
  add(out, "own_island_not_sent", "A base station sends nothing to its sink.",
      {"N8-SERIAL"_rule, "N1-SEQ"_rule}, drop_sent([](const Moment& moment, const Transmit& frame) {
        return moment.is(Role::kBaseStation) && frame.link == Link::kSerial &&
               moment.called<Send>() != nullptr;
      }));
  add(out, "inter_island_dropped", "A base station drops what leaves its island (release 1.0).",
      {"N8-PEIS"_rule},
      drop_sent([](const Moment&, const Transmit& frame) { return frame.link == Link::kPeis; }));
  add(out, "peis_to_the_wrong_island",
      "A base station sends everything to an island that was not meant.", {"N8-PEIS"_rule},
      edit_sent([](Moment& moment, Transmit& frame) {
        if (frame.link == Link::kPeis) frame.dest = static_cast<std::uint16_t>(own(moment).pid + 2);
      }));
  add(out, "incoming_reliable_0_and_seq_5",
      "A base station hands down with reliable 0 and number 5 (release 1.0).", {"N8-INCOMING"_rule},
      edit_sent(handed_down, [](Moment&, Transmit& frame) {
        frame.payload[net::kReliable] = 0;
        put(frame, net::kSeqNum, 5);
      }));
  add(out, "incoming_not_handed_down", "A base station hands down nothing from PEIS.",
      {"N8-INCOMING"_rule}, drop_sent(handed_down));
  add(out, "incoming_signed", "A base station signs what it hands down.", {"N8-INCOMING"_rule},
      edit_sent(handed_down, [](Moment& moment, Transmit& frame) {
        put(frame, net::kSrcPid, own(moment).pid);
        put(frame, net::kSrcDevid, machine::kNullDevid);
      }));
  add(out, "null_not_delivered", "A base station delivers nothing.", {"N8-DELIVER"_rule},
      on_told_of<Received>([](Moment& moment, Received&) {
        return moment.is(Role::kBaseStation) ? Fate::kDrop : Fate::kKeep;
      }));
  add(out, "foreign_to_own_sink", "A base station hands a third island's message to its sink.",
      {"N8-LOOP"_rule, "N8-PEIS"_rule}, edit_sent([](Moment& moment, Transmit& frame) {
        const bool mine = is_send(moment, frame) && frame.link == Link::kPeis;
        if (!mine) return;
        frame.link = Link::kSerial;
        frame.dest = 1;
        frame.src = 0;
      }));
}

void add_island_id(Mutants& out) {
  add(out, "no_island_0", "SET_ISLAND_ID with 0 changes nothing.", {"N9-SET"_rule},
      hear_only([](const Moment&, const Frame& frame) {
        return frame.type != am::kConfig || frame.payload.size() < config::kValue.kEnd ||
               get(frame, config::kValue) != 0;
      }));
  add(out, "local_island_not_replaced", "SET_ISLAND_ID changes nothing.", {"N9-SET"_rule},
      hear_only([](const Moment&, const Frame& frame) { return frame.type != am::kConfig; }));
  add(out, "island_id_swapped", "SET_ISLAND_ID is read in the wrong byte order.", {"N9-SET"_rule},
      edit_heard(am::kConfig, [](Moment&, Forged& forged) {
        std::swap(forged.bytes[config::kValue], forged.bytes[config::kValue.kEnd - 1]);
      }));
  add(out, "island_id_in_replies_only", "After SET_ISLAND_ID only join_replies have the new id.",
      {"N9-SET"_rule, "N1-SRC"_rule}, always([](Moment& moment) {
        const bool joining =
            moment.heard(am::kJoin) != nullptr || moment.heard(am::kConfig) != nullptr;
        const std::uint16_t island = moment.state.island;
        if (!joining && moment.is(Role::kSink)) moment.state.island = moment.state.config.island;
        moment.honest();
        if (!joining && moment.is(Role::kSink)) moment.state.island = island;
      }));
  add(out, "sends_from_the_island_before",
      "A sink that starts again sends from the island that it was told before.",
      {"N3-LOCAL"_rule, "N1-SRC"_rule},
      remembering<std::uint16_t>([](Moment& moment, std::uint16_t& before) {
        if (!moment.is(Role::kSink)) return moment.honest();
        if (std::holds_alternative<machine::Reboot>(moment.event)) before = moment.state.island;
        const bool sends = before != 0 && moment.called<Send>() != nullptr;
        const std::uint16_t island = moment.state.island;
        if (sends) moment.state.island = before;
        moment.honest();
        if (sends) moment.state.island = island;
      }));
  add(out, "island_outlives_a_reboot", "A sink that starts again has the island that it was told.",
      {"J3-ADDRESS"_rule}, always([](Moment& moment) {
        const std::uint16_t island = moment.state.island;
        moment.honest();
        const bool anew = std::holds_alternative<machine::Reboot>(moment.event);
        if (anew && moment.is(Role::kSink)) moment.state.island = island;
      }));
  add(out, "config_of_another_type_obeyed", "Any config message sets the island id.",
      {"N9-OTHER"_rule}, edit_heard(am::kConfig, [](Moment&, Forged& forged) {
        forged.bytes[config::kType] = config::kSetIslandId;
      }));
  add(out, "members_of_the_old_island_kept", "A sink with a new id keeps its members.",
      {"N9-MEMBERS"_rule}, always([](Moment& moment) {
        const machine::JoinSink before = moment.state.sink;
        moment.honest();
        if (moment.heard(am::kConfig) != nullptr) moment.state.sink.members = before.members;
      }));
}

}  // namespace

void island_mutants(Mutants& out) {
  add_sink_up(out);
  add_sink_down(out);
  add_base_station(out);
  add_island_id(out);
}

}  // namespace rubric::mutants
