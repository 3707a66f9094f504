// Mistakes of the network level: sending, buffers, addressing, messages that motes and sinks
// accept.
#include <algorithm>

#include "conformance/selftest/mutants/fields.h"
#include "conformance/selftest/mutants/mutant.h"

namespace rubric::mutants {
namespace {

using machine::Send;
using machine::SendResult;

const Send* send_on_busy_radio(const Moment& moment) {
  const bool busy = moment.state.radio.taken || moment.state.radio.sending;
  return busy && !moment.is(Role::kBaseStation) ? moment.called<Send>() : nullptr;
}

// The refused message leaves when all others have left.
void sends_refused(Moment& moment, Transmit& refused) {
  const Send* const send = send_on_busy_radio(moment);
  auto& queue = moment.state.radio.out;
  if (send != nullptr && queue.full() && send->data.size() <= 8) {
    const machine::Buffered& last = queue[queue.size() - 1];
    refused = Transmit{};
    refused.type = last.type;
    refused.dest = last.dest;
    refused.src = last.src;
    std::copy_n(last.payload.begin(), net::kBody, refused.payload.begin());
    std::copy(send->data.begin(), send->data.end(), refused.payload.begin() + net::kBody);
    put(refused, net::kSeqNum, get(refused, net::kSeqNum) + 1U);
    refused.payload[net::kNbytes] = static_cast<std::uint8_t>(2 + send->data.size());
    refused.size_bytes = static_cast<std::uint8_t>(net::kBody + send->data.size());
  }
  const bool last_left = std::holds_alternative<machine::SendDone>(moment.event) && queue.empty();
  moment.honest();
  if (!last_left || refused.size_bytes == 0) return;
  moment.actions.transmit("N1-FULL"_rule) = refused;
  refused.size_bytes = 0;
}

template <class Queue>
void reverse(Queue& queue) {
  for (std::size_t i = 0; i + 1 < queue.size() - i; ++i) {
    std::swap(queue[i], queue[queue.size() - 1 - i]);
  }
}

void add_sending(Mutants& out) {
  add(out, "signed_by_the_sink", "What a mote sends has its sink as the source.", {"N1-SRC"_rule},
      sent_field(is_send, net::kSrcDevid, 1));
  add(out, "signed_without_island", "What a node sends has source island 0.", {"N1-SRC"_rule},
      sent_field(is_send, net::kSrcPid, 0));
  add(out, "base_station_is_device_0", "A base station signs with devid 0.", {"N1-SRC"_rule},
      edit_sent([](Moment& moment, Transmit& frame) {
        if (is_send(moment, frame) && moment.is(Role::kBaseStation)) put(frame, net::kSrcDevid, 0);
      }));
  add(out, "send_returns_another_number", "send returns the number of the next message.",
      {"N1-SEQ"_rule}, edit_told<SendResult>([](Moment&, SendResult& result) {
        if (result.seq_num != machine::kNoSeq) ++result.seq_num;
      }));
  add(out, "no_outgoing_buffer", "send refuses while the radio is busy.",
      {"N1-ROOM"_rule, "N1-SEQ"_rule, "N2-QUEUE"_rule}, always([](Moment& moment) {
        if (send_on_busy_radio(moment) == nullptr) return moment.honest();
        moment.answer(SendResult{machine::kNoSeq}, "N1-ROOM"_rule);
      }));
  add(out, "buffer_of_two", "The outgoing radio buffer has two places.",
      {"N1-ROOM"_rule, "N1-SEQ"_rule, "N2-QUEUE"_rule}, always([](Moment& moment) {
        const bool refuse =
            send_on_busy_radio(moment) != nullptr && moment.state.radio.out.size() >= 2;
        if (!refuse) return moment.honest();
        moment.answer(SendResult{machine::kNoSeq}, "N1-ROOM"_rule);
      }));
  add(out, "full_buffer_loses_the_oldest", "A full outgoing buffer loses its oldest message.",
      {"N1-FULL"_rule, "N1-SEQ"_rule, "N2-QUEUE"_rule, "N2-ONCE"_rule},
      before_step([](Moment& moment) {
        auto& queue = moment.state.radio.out;
        if (moment.called<Send>() != nullptr && queue.full()) queue.pop();
      }));
  add(out, "refused_and_sent", "A message that send refuses is sent all the same.",
      {"N1-FULL"_rule}, remembering<Transmit>(sends_refused));
}

// Queues are changed before the machine empties them.
bool line_frees(const Moment& moment) {
  const auto* busy = std::get_if<machine::LinkBusy>(&moment.event);
  return busy != nullptr && !busy->busy;
}
bool application_frees(const Moment& moment) {
  const auto* busy = std::get_if<machine::AppBusy>(&moment.event);
  return busy != nullptr && !busy->busy;
}

void add_buffers(Mutants& out) {
  add(out, "queued_lost", "What was queued for the radio is lost.", {"N2-QUEUE"_rule},
      before_step([](Moment& moment) {
        if (line_frees(moment)) moment.state.radio.out.clear();
      }));
  add(out, "serial_queue_lost", "What was queued for the serial line is lost.", {"N2-QUEUE"_rule},
      before_step([](Moment& moment) {
        if (line_frees(moment)) moment.state.serial.out.clear();
      }));
  add(out, "buffer_order_broken", "The outgoing buffer is a stack.",
      {"N2-ORDER"_rule, "N2-QUEUE"_rule}, before_step([](Moment& moment) {
        auto& queue = moment.state.radio.out;
        if (line_frees(moment) && !queue.empty()) reverse(queue);
      }));
  add(out, "queued_twice", "What was queued is sent twice.", {"N2-ONCE"_rule, "N2-ORDER"_rule},
      before_step([](Moment& moment) {
        auto& queue = moment.state.radio.out;
        const bool room = !queue.empty() && !queue.full();
        if (line_frees(moment) && room) queue.push() = queue[queue.size() - 1];
      }));
  add(out, "queued_cut", "A message loses its last byte in the outgoing buffer.",
      {"N2-ONCE"_rule, "N2-QUEUE"_rule}, before_step([](Moment& moment) {
        auto& queue = moment.state.radio.out;
        if (line_frees(moment) && !queue.empty()) --queue.front().size_bytes;
      }));
  add(out, "busy_radio_sends", "A node sends although the radio is busy.",
      {"N2-BUSY"_rule, "N2-QUEUE"_rule, "N2-ORDER"_rule}, always([](Moment& moment) {
        const bool taken = moment.state.radio.taken;
        if (moment.called<Send>() != nullptr) moment.state.radio.taken = false;
        moment.honest();
        if (moment.called<Send>() != nullptr) moment.state.radio.taken = taken;
      }));
  add(out, "incoming_order_broken", "What came while the application was busy is a stack.",
      {"N2-IN-ORDER"_rule}, before_step([](Moment& moment) {
        auto& queue = moment.state.radio.in;
        if (application_frees(moment) && !queue.empty()) reverse(queue);
      }));
  add(out, "incoming_lost", "What came while the application was busy is lost.",
      {"N2-IN-ORDER"_rule, "N2-IN-FULL"_rule}, before_step([](Moment& moment) {
        if (application_frees(moment)) {
          moment.state.radio.in.clear();
          moment.state.serial.in.clear();
          moment.state.waiting.clear();
        }
      }));
  add(out, "incoming_twice", "What waited longest is handled twice.", {"N2-IN-ORDER"_rule},
      before_step([](Moment& moment) {
        auto& queue = moment.state.radio.in;
        const bool room = !queue.empty() && !queue.full();
        if (application_frees(moment) && room) {
          queue.push() = queue.front();
          moment.state.waiting.push() = Link::kRadio;
        }
      }));
  add(out, "incoming_overwritten", "A full incoming buffer loses its oldest message.",
      {"N2-IN-FULL"_rule}, before_step([](Moment& moment) {
        const Frame* const frame = moment.heard();
        auto& queue = moment.state.radio.in;
        if (frame != nullptr && moment.state.app_busy && queue.full()) {
          queue.pop();
          moment.state.waiting.pop();
        }
      }));
  add(out, "incoming_full_for_good", "A node whose incoming buffer was full hears no more.",
      {"N2-IN-FULL"_rule}, remembering<bool>([](Moment& moment, bool& full) {
        if (full && moment.heard() != nullptr) return moment.nothing();
        moment.honest();
        full = full || moment.state.radio.in.full();
      }));
}

// To a neighbour of that name.
void radiates_to_itself(Moment& moment) {
  const Send* const send = moment.called<Send>();
  if (send == nullptr || send->dest != own(moment) || moment.is(Role::kBaseStation)) {
    return moment.honest();
  }
  Send other = *send;
  other.dest.devid = 0x0777;
  moment.honest(machine::Called{other});
  moment.rewrite([&](const Action& action) {
    if (action.what != Action::What::kTransmit) return moment.keep(action);
    Transmit frame = moment.sent(action);
    frame.dest = own(moment).devid;
    put(frame, net::kDestDevid, own(moment).devid);
    moment.keep(action, frame);
  });
}

void add_addressing(Mutants& out) {
  add(out, "sends_to_itself", "A node radiates what it sends to itself.", {"N4-SELF"_rule},
      always(radiates_to_itself));
  add(out, "long_data_cut", "send cuts more than 100 bytes and sends the rest.", {"N1-SIZE"_rule},
      always([](Moment& moment) {
        const Send* const send = moment.called<Send>();
        if (send == nullptr || send->data.size() <= 100) return moment.honest();
        Send cut = *send;
        cut.data = cut.data.first(100);
        moment.honest(machine::Called{cut});
      }));
  add(out, "local_island_left", "dest.pid 0xFFFE goes on the air as it is.", {"N3-LOCAL"_rule},
      edit_sent([](Moment& moment, Transmit& frame) {
        const Send* const send = moment.called<Send>();
        const bool local = send != nullptr && send->dest.pid == machine::kLocalPid;
        if (local && is_net(frame)) put(frame, net::kDestPid, machine::kLocalPid);
      }));
  add(out, "local_island_is_0", "dest.pid 0xFFFE becomes island 0.", {"N3-LOCAL"_rule},
      edit_sent([](Moment& moment, Transmit& frame) {
        const Send* const send = moment.called<Send>();
        const bool local = send != nullptr && send->dest.pid == machine::kLocalPid;
        if (local && is_net(frame)) put(frame, net::kDestPid, 0);
      }));
  add(out, "all_by_the_sink", "A mote sends everything to its sink.", {"N4-MOTE"_rule},
      edit_sent([](Moment& moment, Transmit& frame) {
        if (moment.is(Role::kMote) && is_net(frame)) frame.dest = 1;
      }));
  add(out, "all_broadcast", "Every net_msg goes on the air as a broadcast.",
      {"N4-MOTE"_rule, "N4-SINK"_rule}, edit_sent([](Moment&, Transmit& frame) {
        const bool radio = frame.link == Link::kRadio && is_net(frame);
        if (radio) frame.dest = machine::kAmBroadcast;
      }));
  add(out, "broadcast_by_the_sink", "A mote's broadcast goes to its sink.",
      {"N4-MOTE"_rule, "N2-QUEUE"_rule}, edit_sent([](Moment& moment, Transmit& frame) {
        const bool all = is_net(frame) && frame.dest == machine::kAmBroadcast;
        if (all && moment.is(Role::kMote)) frame.dest = 1;
      }));
  add(out, "devid_is_am_address", "A mote sends to the devid, whatever the island.",
      {"N4-SINK"_rule}, edit_sent([](Moment& moment, Transmit& frame) {
        if (moment.is(Role::kMote) && is_net(frame)) frame.dest = get(frame, net::kDestDevid);
      }));
}

bool delivers(const Moment& moment, const Frame& frame) {
  return is_net(frame) && frame.link == Link::kRadio && moment.is(Role::kMote) && is_member(moment);
}

void add_motes(Mutants& out) {
  add(out, "no_broadcast_heard", "A mote takes no broadcast.", {"N5-DELIVER"_rule},
      hear_only([](const Moment& moment, const Frame& frame) {
        return !delivers(moment, frame) || get(frame, net::kDestDevid) != machine::kBroadcastDevid;
      }));
  add(out, "source_island_filtered", "A mote ignores what comes from another island.",
      {"N5-DELIVER"_rule}, hear_only([](const Moment& moment, const Frame& frame) {
        return !delivers(moment, frame) || get(frame, net::kSrcPid) == own(moment).pid;
      }));
  add(out, "sink_only_heard", "A mote takes only what its sink sends.", {"N5-DELIVER"_rule},
      hear_only([](const Moment& moment, const Frame& frame) {
        return !delivers(moment, frame) || frame.src == 1;
      }));
  add(out, "foreign_island_delivered", "A mote compares the devid alone.", {"N5-FOREIGN"_rule},
      edit_heard(delivers, [](Moment& moment, Forged& forged) {
        put(forged, net::kDestPid, own(moment).pid);
      }));
  add(out, "others_messages_delivered", "A mote takes what is for another mote.", {"N5-OTHER"_rule},
      edit_heard([](Moment& moment, Forged& forged) {
        const bool other =
            delivers(moment, forged.frame) && get(forged, net::kDestDevid) < machine::kNullDevid;
        if (other) put(forged, net::kDestDevid, own(moment).devid);
      }));
  add(out, "null_devid_delivered", "A mote takes what is for the base station.", {"N5-OTHER"_rule},
      edit_heard([](Moment& moment, Forged& forged) {
        const bool null =
            delivers(moment, forged.frame) && get(forged, net::kDestDevid) == machine::kNullDevid;
        if (null) put(forged, net::kDestDevid, own(moment).devid);
      }));
}

}  // namespace

void network_mutants(Mutants& out) {
  add_sending(out);
  add_buffers(out);
  add_addressing(out);
  add_motes(out);
}

}  // namespace rubric::mutants
