#include "conformance/machine/transport.h"

#include "codec/generated/rubicon/enums.h"
#include "codec/generated/rubicon/rubicon_ack.h"
#include "codec/generated/rubicon/rubicon_ack_seq_only.h"

namespace rubric::machine {
namespace {

using rubicon::AmType;
using rubicon::Component;

bool is_broadcast(Address dest) {
  return dest.pid == kBroadcastPid || dest.devid == kBroadcastDevid;
}

// A 16-bit xorshift with the full period of 65535; 0 is its one fixed point, so it is left first.
std::uint16_t xorshift(std::uint16_t x) {
  if (x == 0) x = 0xACE1;
  x = static_cast<std::uint16_t>(x ^ (x << 7));
  x = static_cast<std::uint16_t>(x ^ (x >> 9));
  return static_cast<std::uint16_t>(x ^ (x << 8));
}

}  // namespace

void await_ack(AwaitedList& list, std::uint16_t seq_num, std::uint8_t app_id, Address dest) {
  if (!list.full()) list.push({seq_num, app_id, dest, 0});
}

void start_ack_timer(AwaitedList& list, const Profile& profile, Ticks now, std::uint16_t seq_num) {
  // Without a timeout the ack is awaited for ever, as release 1.0 does: due 0 is no timer.
  if (profile.ack_timeout_ticks == 0) return;
  for (Awaited& awaited : list) {
    if (awaited.seq_num == seq_num) awaited.due = now + profile.ack_timeout_ticks;
  }
}

void hear_ack(AwaitedList& list, Address from, std::uint8_t app_id, std::uint16_t seq_num,
              Actions& actions) {
  for (std::size_t i = 0; i < list.size(); ++i) {
    const Awaited& awaited = list[i];
    //= T4-SEVERAL: Several reliable messages may await their acks at once; each ack ends the
    //= message it names.
    if (awaited.seq_num != seq_num) continue;
    //= T3-SENDER: An ack counts only if it comes from the message's destination and carries its
    //= APPID.
    // Nobody acks a broadcast (T2-BROADCAST), so no claimed source is its destination either.
    if (is_broadcast(awaited.dest) || awaited.dest != from || awaited.app_id != app_id) {
      return actions.ignored("T3-SENDER"_rule);
    }
    actions.notify(AckReceived{app_id, seq_num, true}, "T3-SUCCESS"_rule);
    return list.erase(i);  // A later ack with this number finds nothing: T3-ONCE.
  }
  //= T3-MATCH: An ack whose sequence number is that of no message awaiting its ack changes nothing.
  actions.ignored("T3-MATCH"_rule);
}

void ack_timeout(AwaitedList& list, std::size_t index, Actions& actions) {
  //= T3-TIMEOUT: A reliable message without its ack is signalled as receive_ack(failure) when its
  //= timeout expires, not before.
  if (index >= list.size() || list[index].due == 0) return actions.ignored("T3-ONCE"_rule);
  const Awaited awaited = list[index];
  list.erase(index);
  //= T3-RESEND: Connectionless never sends a message again by itself; that is the application's
  //= decision.
  actions.notify(AckReceived{awaited.app_id, awaited.seq_num, false}, "T3-TIMEOUT"_rule);
}

bool is_awaited(const AwaitedList& list, std::uint16_t seq_num) {
  for (const Awaited& awaited : list) {
    if (awaited.seq_num == seq_num) return true;
  }
  return false;
}

std::uint16_t next_seq_num(Sequence& sequence, const AwaitedList& list) {
  // Ends: at most kAwaitedMax numbers and kNoSeq are skipped, of 65535 or more.
  do {
    sequence.last =
        sequence.random ? xorshift(sequence.last) : static_cast<std::uint16_t>(sequence.last + 1);
    //= N12-REUSE: A sequence number is not used again while its ack is awaited.
    //= N12-ERROR: 0xFFFF, the error value of send, is not used as a sequence number.
  } while (sequence.last == kNoSeq || is_awaited(list, sequence.last));
  return sequence.last;
}

bool is_known_app(std::uint8_t app_id) {
  // TRANSID and APPID share one numbering. An application is a component above the transport level:
  // those whose bodies the wire spec knows under CONNLESS (MOCKUP, LEARNING, CONTROL_LAYER), the
  // learning networks' data (ESN_DATA) and the dispatcher of applications (APPLICATION_MD). The
  // rest belongs to transport and network, which Connectionless does not reach.
  switch (static_cast<Component>(app_id)) {
    case Component::kMockup:
    case Component::kLearning:
    case Component::kApplicationMd:
    case Component::kControlLayer:
    case Component::kEsnData: return true;
    case Component::kSynChannel:
    case Component::kStream:
    case Component::kConnless:
    case Component::kCompMngmnt:
    case Component::kTransportMd:
    case Component::kRubiconAck: break;
  }
  return false;
}

bool must_ack(bool reliable, Address dest, std::uint8_t trans_id, std::uint8_t app_id) {
  //= T2-UNRELIABLE: A message with reliable 0 is never acked.
  if (!reliable) return false;
  //= T2-LOOP: An ack is never acked.
  // Neither is synaptic data: acks are Connectionless's.
  if (trans_id != static_cast<std::uint8_t>(Component::kConnless)) return false;
  //= T2-BROADCAST: A broadcast is not acked.
  if (is_broadcast(dest)) return false;
  return is_known_app(app_id);  // Else dropped; both acking and not are lawful (decision 111).
}

std::int32_t acked_seq_num(Bytes body) {
  using Paper = rubicon::RubiconAckSeqOnlyLayout::SeqNumAt;
  using Deployed = rubicon::RubiconAckLayout;
  if (body.size() == Paper::kEnd) return Paper::load(body.data());
  // The deployed form, maybe with stale bytes after it where a sink has set nbytes to 102.
  const bool deployed = body.size() >= rubicon::RubiconAckView::kMinSizeBytes &&
                        Deployed::TypeAt::load(body.data()) == AmType::kLearningNotification;
  if (deployed) return Deployed::SeqNumAt::load(body.data());
  // The paper's form after such a sink. (One whose number begins with 23 looks deployed; that is
  // the price of two forms without a mark.)
  if (body.size() == kAppDataMax) return Paper::load(body.data());
  return -1;
}

}  // namespace rubric::machine
