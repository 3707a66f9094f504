// Sequence numbers, and reliable messages whose acks are awaited. (paper: Rubicon ACK)
#pragma once

#include "conformance/node/driver.h"
#include "conformance/node/sizes.h"

namespace rubric {
namespace node {

/// A reliable message whose ack is awaited.
struct AwaitedAck {
  uint16_t seq_num;
  Address dest;
  uint8_t app_id;
  bool running;
  Ticks due;
};

class Awaiting {
 public:
  Awaiting(AwaitedAck* places, uint8_t room) : entries_(places), room_(room) {}
  void reset(uint16_t last_seq_num) {
    last_ = last_seq_num;
    count_ = 0;
  }
  bool full() const { return count_ == room_; }
  /// Returns the next number; never kNoSeq, never one that is awaited.
  uint16_t next_seq_num();
  uint16_t last_seq_num() const { return last_; }

  /// Adds a reliable message that is accepted; not when full().
  void add(uint16_t seq_num, uint8_t app_id, Address dest);
  /// Starts its time, which ends at `due`, since the line has it. (decision 110) It runs once,
  /// though a broadcast may come back and be forwarded (decision 150).
  void left(uint16_t seq_num, Ticks due);
  void hear(Address from, uint8_t app_id, uint16_t seq_num, Application& application);
  void run(Ticks now, Application& application);
  /// Sets `due` to the first timeout; returns false if none runs.
  bool next_due(Ticks& due) const;

 private:
  AwaitedAck* find(uint16_t seq_num);
  void erase(AwaitedAck* entry);

  AwaitedAck* entries_;
  uint16_t last_ = 0;
  uint8_t room_;
  uint8_t count_ = 0;
};

inline AwaitedAck* Awaiting::find(uint16_t seq_num) {
  for (uint8_t i = 0; i < count_; ++i) {
    if (entries_[i].seq_num == seq_num) return &entries_[i];
  }
  return nullptr;
}

inline void Awaiting::erase(AwaitedAck* entry) { *entry = entries_[--count_]; }

inline uint16_t Awaiting::next_seq_num() {
  //= N12-REUSE: A sequence number is not used again while its ack is awaited.
  //= N12-ERROR: 0xFFFF, the error value of send, is not used as a sequence number.
  do {
    ++last_;
  } while (last_ == kNoSeq || find(last_) != nullptr);
  return last_;
}

inline void Awaiting::add(uint16_t seq_num, uint8_t app_id, Address dest) {
  AwaitedAck& entry = entries_[count_++];
  entry.seq_num = seq_num;
  entry.dest = dest;
  entry.app_id = app_id;
  entry.running = false;
}

inline void Awaiting::left(uint16_t seq_num, Ticks due) {
  AwaitedAck* const entry = find(seq_num);
  if (entry == nullptr || entry->running) return;
  entry->running = true;
  entry->due = due;
}

inline void Awaiting::hear(Address from, uint8_t app_id, uint16_t seq_num,
                           Application& application) {
  AwaitedAck* const entry = find(seq_num);
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

inline void Awaiting::run(Ticks now, Application& application) {
  for (uint8_t i = 0; i < count_;) {
    const AwaitedAck entry = entries_[i];
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

inline bool Awaiting::next_due(Ticks& due) const {
  bool any = false;
  for (uint8_t i = 0; i < count_; ++i) {
    if (!entries_[i].running) continue;
    if (!any || is_reached(entries_[i].due, due)) due = entries_[i].due;
    any = true;
  }
  return any;
}

}  // namespace node
}  // namespace rubric
