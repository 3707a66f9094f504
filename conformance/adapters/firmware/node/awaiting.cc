#include "conformance/adapters/firmware/node/awaiting.h"

namespace rubric {
namespace firmware {

Awaiting::Entry* Awaiting::find(uint16_t seq_num) {
  for (uint8_t i = 0; i < count_; ++i) {
    if (entries_[i].seq_num == seq_num) return &entries_[i];
  }
  return nullptr;
}

void Awaiting::erase(Entry* entry) { *entry = entries_[--count_]; }

uint16_t Awaiting::next_seq_num() {
  //= N12-REUSE: A sequence number is not used again while its ack is awaited.
  //= N12-ERROR: 0xFFFF, the error value of send, is not used as a sequence number.
  do {
    ++last_;
  } while (last_ == kNoSeq || find(last_) != nullptr);
  return last_;
}

void Awaiting::add(uint16_t seq_num, uint8_t app_id, Address dest) {
  Entry& entry = entries_[count_++];
  entry.seq_num = seq_num;
  entry.dest = dest;
  entry.app_id = app_id;
  entry.running = false;
}

void Awaiting::left(uint16_t seq_num, Ticks now) {
  Entry* const entry = find(seq_num);
  if (entry == nullptr) return;
  entry->running = true;
  entry->due = now + kAckTimeoutTicks + 1;  // The present tick has partly gone.
}

void Awaiting::hear(Address from, uint8_t app_id, uint16_t seq_num, Application& application) {
  Entry* const entry = find(seq_num);
  //= T3-MATCH: An ack whose sequence number is that of no message awaiting its ack changes nothing.
  if (entry == nullptr) return;
  //= T3-SENDER: An ack counts only if it comes from the message's destination and carries its
  //= APPID.
  // No node may ack a broadcast.
  if (is_broadcast(entry->dest) || entry->dest != from || entry->app_id != app_id) return;
  //= T3-ONCE: Each reliable message ends in exactly one receive_ack; late and duplicate acks change
  //= nothing.
  erase(entry);
  application.ack_received(app_id, seq_num, true);
}

void Awaiting::run(Ticks now, Application& application) {
  for (uint8_t i = 0; i < count_;) {
    const Entry entry = entries_[i];
    if (!entry.running || !is_reached(entry.due, now)) {
      ++i;
      continue;
    }
    //= T3-TIMEOUT: A reliable message without its ack is signalled as receive_ack(failure) when its
    //= timeout expires, not before.
    erase(&entries_[i]);
    application.ack_received(entry.app_id, entry.seq_num, false);
  }
}

bool Awaiting::next_due(Ticks& due) const {
  bool any = false;
  for (uint8_t i = 0; i < count_; ++i) {
    if (!entries_[i].running) continue;
    if (!any || is_reached(entries_[i].due, due)) due = entries_[i].due;
    any = true;
  }
  return any;
}

}  // namespace firmware
}  // namespace rubric
