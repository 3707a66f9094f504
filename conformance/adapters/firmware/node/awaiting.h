// Sequence numbers, and reliable messages whose acks are awaited. (paper: Rubicon ACK)
#pragma once

#include "conformance/adapters/firmware/node/limits.h"
#include "conformance/adapters/firmware/node/ports.h"

namespace rubric {
namespace firmware {

class Awaiting {
 public:
  void reset(uint16_t last_seq_num) {
    last_ = last_seq_num;
    count_ = 0;
  }
  bool full() const { return count_ == kAwaitedRoom; }
  /// Returns the next number; never kNoSeq, never one that is awaited.
  uint16_t next_seq_num();
  uint16_t last_seq_num() const { return last_; }

  /// Adds a reliable message that is accepted; not when full().
  void add(uint16_t seq_num, uint8_t app_id, Address dest);
  /// Starts its time, since the line has it. (decision 110)
  void left(uint16_t seq_num, Ticks now);
  void hear(Address from, uint8_t app_id, uint16_t seq_num, Application& application);
  void run(Ticks now, Application& application);
  /// Sets `due` to the first timeout; returns false if none runs.
  bool next_due(Ticks& due) const;

 private:
  struct Entry {
    uint16_t seq_num;
    Address dest;
    uint8_t app_id;
    bool running;
    Ticks due;
  };
  Entry* find(uint16_t seq_num);
  void erase(Entry* entry);

  Entry entries_[kAwaitedRoom];
  uint16_t last_;
  uint8_t count_;
};

}  // namespace firmware
}  // namespace rubric
