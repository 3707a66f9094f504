// Mistakes in Rubicon ACK: which messages are acked, how, and what their sender does then; and in
// Connectionless: how applications' messages are wrapped, and which applications get them.

#include <algorithm>
#include <utility>

#include "conformance/machine/transport.h"
#include "conformance/selftest/mutants/fields.h"
#include "conformance/selftest/mutants/mutant.h"

namespace rubric::mutants {
namespace {

using machine::AckReceived;
using machine::Received;
using machine::Send;
using machine::TimerKind;

bool is_ack_sent(const Moment& moment, const Transmit& frame) {
  return is_ack(frame) && moment.heard(am::kNet) != nullptr;
}

// Returns whether it is a net_msg for this very node, of that kind.
bool is_for_us(const Moment& moment, const Frame& frame) {
  return is_net(frame) && get(frame, net::kDestPid) == own(moment).pid &&
         get(frame, net::kDestDevid) == own(moment).devid;
}

void add_message_acks(Mutants& out) {
  add(out, "no_ack", "A node never acks.", {"T2-ACK"_rule}, drop_sent(is_ack_sent));
  add(out, "ack_twice", "A node sends each ack twice.", {"T2-ONCE"_rule}, double_sent(is_ack_sent));
  add(out, "ack_late", "An ack comes after the sender's timeout.",
      {"T2-PROMPT"_rule, "T2-ACK"_rule}, after_step([](Moment& moment) {
        moment.rewrite([&](const Action& action) {
          const bool sent = action.what == Action::What::kTransmit;
          if (!sent || !is_ack_sent(moment, moment.sent(action))) return moment.keep(action);
          moment.hold(action, 1200);
        });
      }));
  add(out, "ack_other_number", "An ack names the number plus one.",
      {"T2-CONTENT"_rule, "T2-ACK"_rule}, edit_sent(is_ack, [](Moment&, Transmit& frame) {
        put(frame, net::kPaperSeq, get(frame, net::kPaperSeq) + 1U);
      }));
  add(out, "ack_number_swapped", "The number in an ack has the wrong byte order.",
      {"T2-CONTENT"_rule, "T2-ACK"_rule}, edit_sent(is_ack, [](Moment&, Transmit& frame) {
        std::reverse(frame.payload.begin() + net::kPaperSeq,
                     frame.payload.begin() + net::kPaperSeq.kEnd);
      }));
  add(out, "ack_of_another_kind", "An ack is four bytes that do not begin with 23.",
      {"T2-CONTENT"_rule, "T2-ACK"_rule}, edit_sent([](Moment&, Transmit& frame) {
        if (!is_ack(frame) || frame.payload[net::kNbytes] != net::kPaperAckNbytes) return;
        put(frame, net::kAckedSeq, get(frame, net::kPaperSeq));
        frame.payload[net::kBody] = net::kAck + 1;
        frame.payload[net::kNbytes] = net::kAckNbytes;
        if (frame.link != Link::kSerial)
          frame.size_bytes = net::kBody + rubicon::RubiconAckView::kMaxSizeBytes;
      }));
  add(out, "ack_reliable", "An ack asks to be acked.", {"T2-CONTENT"_rule},
      sent_field(is_ack, net::kReliable, 1));
  add(out, "ack_as_plain_message", "An ack has TRANSID CONNLESS.",
      {"T2-CONTENT"_rule, "T2-ACK"_rule}, sent_field(is_ack, net::kTransId, component::kConnless));
  add(out, "ack_without_app", "An ack has APPID RUBICON_ACK.", {"T2-CONTENT"_rule},
      sent_field(is_ack, net::kAppId, component::kRubiconAck));
  add(out, "ack_to_the_sink", "An ack goes to the sink, whoever sent the message.",
      {"T2-CONTENT"_rule, "T2-ACK"_rule}, sent_field(is_ack, net::kDestDevid, 1));
  add(out, "acked_not_delivered", "A reliable message is acked and lost.", {"T2-DELIVER"_rule},
      on_told([](Moment&, const Action& action, Notice&) {
        return action.requirement == "T2-DELIVER"_rule ? Fate::kDrop : Fate::kKeep;
      }));
  add(out, "acks_the_first_only", "A number that was acked before is not acked again.",
      {"T2-ACK"_rule},
      remembering<std::vector<std::uint16_t>>(
          [](Moment& moment, std::vector<std::uint16_t>& acked) {
            moment.honest();
            moment.rewrite([&](const Action& action) {
              const bool sent = action.what == Action::What::kTransmit;
              if (!sent || !is_ack(moment.sent(action))) return moment.keep(action);
              const std::uint16_t number = get(moment.sent(action), net::kPaperSeq);
              const bool before = std::find(acked.begin(), acked.end(), number) != acked.end();
              acked.push_back(number);
              if (!before) moment.keep(action);
            });
          }));
}

// Adds mutants that ack what must not be acked: as if it were reliable, plain, or for this node
// alone.
void add_needless_acks(Mutants& out) {
  add(out, "unreliable_acked", "An unreliable message is acked.", {"T2-UNRELIABLE"_rule},
      edit_heard([](Moment& moment, Forged& forged) {
        if (is_for_us(moment, forged.frame) && !is_ack(forged.frame)) {
          forged.bytes[net::kReliable] = 1;
        }
      }));
  add(out, "ack_acked", "A node acks acks.", {"T2-LOOP"_rule}, after_step([](Moment& moment) {
        const Frame* const frame = moment.heard(am::kNet);
        if (frame == nullptr || !is_ack(*frame) || !is_for_us(moment, *frame)) return;
        Transmit& ack = moment.send(Link::kRadio, am::kNet, frame->src, "T2-LOOP"_rule);
        ack.size_bytes = net::kBody + rubicon::RubiconAckView::kMaxSizeBytes;
        copy_address(*frame, net::kDestPid, ack, net::kSrcPid);
        copy_address(*frame, net::kSrcPid, ack, net::kDestPid);
        ack.payload[net::kNbytes] = net::kAckNbytes;
        ack.payload[net::kTransId] = component::kRubiconAck;
        ack.payload[net::kAppId] = frame->payload[net::kAppId];
        ack.payload[net::kBody] = net::kAck;
        put(ack, net::kAckedSeq, get(*frame, net::kSeqNum));
      }));
  add(out, "broadcast_acked", "A reliable broadcast is acked by each who hears it.",
      {"T2-BROADCAST"_rule}, edit_heard([](Moment& moment, Forged& forged) {
        const bool broadcast =
            is_net(forged.frame) && get(forged, net::kDestDevid) == machine::kBroadcastDevid;
        if (broadcast && forged.bytes[net::kReliable] == 1 && moment.is(Role::kMote)) {
          put(forged, net::kDestDevid, own(moment).devid);
        }
      }));
  add(out, "every_flag_but_0_acked", "Any value of reliable but 0 is taken for true.",
      {"T2-TWO"_rule}, edit_heard([](Moment& moment, Forged& forged) {
        const bool ours = is_for_us(moment, forged.frame);
        if (ours && forged.bytes[net::kReliable] > 1) forged.bytes[net::kReliable] = 1;
      }));
  add(out, "synaptic_data_acked", "Synaptic data that say reliable are acked.",
      {"T2-LOOP"_rule, "T2-ACK"_rule}, after_step([](Moment& moment) {
        const Frame* const frame = moment.heard(am::kNet);
        const bool asked = frame != nullptr && is_net(*frame) &&
                           frame->payload[net::kTransId] == component::kSynChannel &&
                           frame->payload[net::kReliable] == 1;
        if (!asked || !is_for_us(moment, *frame)) return;
        Transmit& ack = moment.send(Link::kRadio, am::kNet, frame->src, "T2-LOOP"_rule);
        ack.size_bytes = net::kBody + rubicon::RubiconAckView::kMaxSizeBytes;
        ack.payload[net::kTransId] = component::kRubiconAck;
      }));
}

// The sender.

void sends_again(Moment& moment, Transmit& last) {
  const bool timeout = moment.timer(TimerKind::kAck);
  moment.honest();
  for (const Transmit& frame : moment.actions.transmits()) {
    if (is_send(moment, frame) && frame.payload[net::kReliable] == 1) last = frame;
  }
  if (timeout && last.size_bytes != 0) moment.actions.transmit("T3-RESEND"_rule) = last;
}

void one_awaited(Moment& moment) {
  const std::size_t before = moment.state.awaited.size();
  moment.honest();
  auto& awaited = moment.state.awaited;
  if (moment.called<Send>() != nullptr && awaited.size() > before) {
    while (awaited.size() > 1) awaited.erase(0);
  }
}

void keeps_awaiting(Moment& moment) {
  const machine::AwaitedList before = moment.state.awaited;
  const Frame* const frame = moment.heard(am::kNet);
  moment.honest();
  if (frame != nullptr && is_ack(*frame)) moment.state.awaited = before;
}

void add_sender(Mutants& out) {
  add(out, "ack_of_any_number_counts", "Any ack ends the oldest message.", {"T3-MATCH"_rule},
      edit_heard([](Moment& moment, Forged& forged) {
        const auto& awaited = moment.state.awaited;
        if (is_ack(forged.frame) && is_for_us(moment, forged.frame) && !awaited.empty()) {
          put(forged, net::kAckedSeq, awaited[0].seq_num);
        }
      }));
  add(out, "late_ack_counts", "An ack that nobody awaits is signalled all the same.",
      {"T3-ONCE"_rule, "T3-MATCH"_rule}, after_step([](Moment& moment) {
        moment.rewrite([&](const Action& action) {
          moment.keep(action);
          const bool unmatched =
              action.what == Action::What::kIgnored && action.requirement == "T3-MATCH"_rule;
          const Frame* const frame = moment.heard(am::kNet);
          if (!unmatched || frame == nullptr) return;
          moment.actions.notify(
              AckReceived{frame->payload[net::kAppId], get(*frame, net::kAckedSeq), true},
              "T3-MATCH"_rule);
        });
      }));
  add(out, "ack_of_another_sender_counts", "The sender of an ack is not looked at.",
      {"T3-SENDER"_rule}, edit_heard(is_ack, [](Moment& moment, Forged& forged) {
        for (const auto& awaited : moment.state.awaited) {
          if (awaited.seq_num != get(forged, net::kAckedSeq)) continue;
          put(forged, net::kSrcPid, awaited.dest.pid);
          put(forged, net::kSrcDevid, awaited.dest.devid);
        }
      }));
  add(out, "ack_of_another_app_counts", "The APPID of an ack is not looked at.", {"T3-SENDER"_rule},
      edit_heard(is_ack, [](Moment& moment, Forged& forged) {
        for (const auto& awaited : moment.state.awaited) {
          if (awaited.seq_num == get(forged, net::kAckedSeq)) {
            forged.bytes[net::kAppId] = awaited.app_id;
          }
        }
      }));
  add(out, "success_silent", "A good ack is not signalled.", {"T3-SUCCESS"_rule},
      on_told_of<AckReceived>(
          [](Moment&, AckReceived& ack) { return ack.success ? Fate::kDrop : Fate::kKeep; }));
  add(out, "success_as_failure", "A good ack is signalled as failure.", {"T3-SUCCESS"_rule},
      edit_told<AckReceived>([](Moment&, AckReceived& ack) { ack.success = false; }));
  add(out, "knows_one_body_of_acks", "An ack in the paper's form is not understood.",
      {"T3-SUCCESS"_rule}, hear_only([](const Moment&, const Frame& frame) {
        return !is_net(frame) || frame.payload[net::kNbytes] != net::kPaperAckNbytes ||
               frame.payload[net::kTransId] != component::kRubiconAck;
      }));
  add(out, "knows_the_papers_acks_only", "An ack in the deployed form is not understood.",
      {"T3-SUCCESS"_rule}, hear_only([](const Moment&, const Frame& frame) {
        return !is_net(frame) || frame.payload[net::kNbytes] != net::kAckNbytes ||
               frame.payload[net::kTransId] != component::kRubiconAck;
      }));
  add(out, "ack_timeout_short", "A message is given up after 200 ticks.", {"T3-TIMEOUT"_rule},
      with_profile(&machine::Profile::ack_timeout_ticks, 200));
  add(out, "ack_timeout_long", "A message is given up after 2000 ticks.", {"T3-TIMEOUT"_rule},
      with_profile(&machine::Profile::ack_timeout_ticks, 2000));
  add(out, "timeout_silent", "A message without its ack ends in silence.",
      {"T3-TIMEOUT"_rule, "T3-ONCE"_rule}, on_told_of<AckReceived>([](Moment&, AckReceived& ack) {
        return ack.success ? Fate::kKeep : Fate::kDrop;
      }));
  add(out, "timeout_twice", "A failure is signalled twice.", {"T3-ONCE"_rule, "T3-TIMEOUT"_rule},
      on_told_of<AckReceived>(
          [](Moment&, AckReceived& ack) { return ack.success ? Fate::kKeep : Fate::kTwice; }));
  add(out, "timeout_after_success", "The timeout runs on after the ack.", {"T3-ONCE"_rule},
      always(keeps_awaiting));
  add(out, "sends_again", "A message without its ack is sent again.", {"T3-RESEND"_rule},
      remembering<Transmit>(sends_again));
  add(out, "second_outstanding_message_lost", "The second reliable message replaces the first.",
      {"T4-SEVERAL"_rule, "T3-TIMEOUT"_rule}, always(one_awaited));
  add(out, "one_outstanding_at_a_time", "A second reliable message is refused.",
      {"T4-SEVERAL"_rule, "N1-ROOM"_rule}, always([](Moment& moment) {
        const Send* const send = moment.called<Send>();
        const bool second = send != nullptr && send->reliable && !moment.state.awaited.empty();
        if (!second) return moment.honest();
        moment.answer(machine::SendResult{machine::kNoSeq}, "T4-SEVERAL"_rule);
      }));
}

void add_delivery(Mutants& out) {
  add(out, "no_trans_id", "A message of an application has TRANSID 0.",
      {"T1-WRAP"_rule, "N1-SEQ"_rule}, sent_field(is_send, net::kTransId, 0));
  add(out, "app_id_of_another", "A message of an application has APPID APPLICATION_MD.",
      {"T1-WRAP"_rule}, sent_field(is_send, net::kAppId, 8));
  add(out, "ids_swapped", "TRANSID and APPID are in the wrong order.", {"T1-WRAP"_rule},
      edit_sent(is_send, [](Moment&, Transmit& frame) {
        std::swap(frame.payload[net::kTransId], frame.payload[net::kAppId]);
      }));
  add(out, "delivered_with_ids", "What is delivered begins with TRANSID and APPID.",
      {"T1-DELIVER"_rule, "N5-DELIVER"_rule, "N6-DELIVER"_rule},
      edit_told<Received>([](Moment& moment, Received& received) {
        const Frame* const frame = moment.heard(am::kNet);
        const bool whole = frame != nullptr && is_net(*frame);
        if (whole) received.data = frame->payload.from(net::kTransId);
      }));
  add(out, "delivered_without_last_byte", "The last byte of a delivered message is lost.",
      {"T1-DELIVER"_rule, "N5-DELIVER"_rule}, edit_told<Received>([](Moment&, Received& received) {
        if (!received.data.empty()) received.data = received.data.first(received.data.size() - 1);
      }));
  add(out, "delivered_to_one_application", "Everything is delivered to MOCKUP.",
      {"T1-DELIVER"_rule},
      edit_told<Received>([](Moment&, Received& received) { received.app_id = 5; }));
  add(out, "delivered_from_the_sink", "Every message seems to come from the sink.",
      {"T1-DELIVER"_rule, "N5-DELIVER"_rule, "N6-DELIVER"_rule},
      edit_told<Received>([](Moment& moment, Received& received) {
        received.src = {own(moment).pid, 1};
      }));
  add(out, "delivered_twice", "Every message is delivered twice.",
      {"T1-DELIVER"_rule, "T2-DELIVER"_rule, "N5-DELIVER"_rule, "N2-IN-ORDER"_rule},
      on_told_of<Received>([](Moment&, Received&) { return Fate::kTwice; }));
  add(out, "unknown_app_delivered", "A message for an unknown APPID is delivered to MOCKUP.",
      {"T1-UNKNOWN"_rule}, edit_heard([](Moment&, Forged& forged) {
        const bool connless =
            is_net(forged.frame) && forged.bytes[net::kTransId] == component::kConnless;
        std::uint8_t& app_id = forged.bytes[net::kAppId];
        if (connless && !machine::is_known_app(app_id)) app_id = 5;
      }));
  add(out, "unknown_trans_delivered", "An unknown TRANSID is taken for CONNLESS.",
      {"T1-UNKNOWN"_rule}, edit_heard([](Moment&, Forged& forged) {
        if (is_net(forged.frame) && forged.bytes[net::kTransId] > 13) {
          forged.bytes[net::kTransId] = component::kConnless;
        }
      }));
  add(out, "unknown_kills", "After an unknown TRANSID or APPID a node hears no more.",
      {"T1-UNKNOWN"_rule}, remembering<bool>([](Moment& moment, bool& dead) {
        if (dead && moment.heard(am::kNet) != nullptr) return moment.nothing();
        moment.honest();
        for (const Action& action : moment.actions.all()) {
          dead = dead ||
                 (action.what == Action::What::kIgnored && action.requirement == "T1-UNKNOWN"_rule);
        }
      }));
}

}  // namespace

void transport_mutants(Mutants& out) {
  add_message_acks(out);
  add_needless_acks(out);
  add_sender(out);
}

void delivery_mutants(Mutants& out) { add_delivery(out); }

}  // namespace rubric::mutants
