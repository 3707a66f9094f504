// A sink's list of motes: its members, and those whose join it has answered.
// (paper: Component Management)
#pragma once

#include <string.h>

#include "conformance/node/sizes.h"
#include "conformance/node/types.h"

namespace rubric {
namespace node {

struct Admission {
  enum class State : uint8_t {
    kPending,  ///< Answered, not acknowledged.
    kOwed,     ///< A member whose report waits for the serial line.
    kMember,
  };
  uint16_t devid;
  uint16_t seq_num;  ///< In the request answered last.
  Descriptor descriptor;
  State state;
};

class Admissions {
 public:
  /// Borrows places for `room` members and kOpenJoinsMax more.
  Admissions(Admission* places, uint8_t room) : entries_(places), room_(room) {}
  void clear() { count_ = members_ = 0; }
  /// Clears the list, for so many members, if there is room.
  void reset(uint8_t members) {
    members_max_ = members < room_ ? members : room_;
    clear();
  }
  /// Handles a join_request; returns true if it is to be answered.
  bool request(uint16_t devid, uint16_t seq_num, const Descriptor& descriptor);
  /// Handles an ack_join for this island; returns the new member, whose report is owed, or null.
  Admission* acknowledge(uint16_t devid, uint16_t seq_num);
  /// Returns the member whose report has waited longest, or null.
  Admission* owed();
  bool lists(uint16_t devid);
  uint8_t members() const { return members_; }
  bool is_full() const { return members_ == members_max_; }
  /// Takes a mote off the list; returns false while its report is owed.
  bool forget(uint16_t devid);

 private:
  Admission* find(uint16_t devid);
  void erase(uint8_t i);
  /// Returns a place for one more, if needed that of the oldest join which was not acknowledged.
  Admission& add();

  Admission* entries_;
  uint8_t room_;
  uint8_t members_max_ = 0;
  uint8_t count_ = 0;
  uint8_t members_ = 0;
};

inline Admission* Admissions::find(uint16_t devid) {
  for (uint8_t i = 0; i < count_; ++i) {
    if (entries_[i].devid == devid) return &entries_[i];
  }
  return nullptr;
}

inline bool Admissions::lists(uint16_t devid) {
  const Admission* const entry = find(devid);
  return entry != nullptr && entry->state != Admission::State::kPending;
}

inline bool Admissions::forget(uint16_t devid) {
  if (!lists(devid)) return true;
  Admission* const entry = find(devid);
  if (entry->state == Admission::State::kOwed) return false;
  --members_;
  erase(static_cast<uint8_t>(entry - entries_));
  return true;
}

inline void Admissions::erase(uint8_t i) {
  --count_;
  memmove(&entries_[i], &entries_[i] + 1, sizeof(Admission) * (count_ - i));
}

inline Admission& Admissions::add() {
  if (count_ == members_max_ + kOpenJoinsMax) {
    uint8_t oldest = 0;  // There is one: the table has more room than the list.
    while (entries_[oldest].state != Admission::State::kPending) ++oldest;
    erase(oldest);
  }
  return entries_[count_++];
}

inline bool Admissions::request(uint16_t devid, uint16_t seq_num, const Descriptor& descriptor) {
  Admission* entry = find(devid);
  //= J2-LISTED: A sink ignores a join_request of a mote that is already in its list.
  if (entry != nullptr && entry->state != Admission::State::kPending) return false;
  //= J3-FULL: A sink whose list is full does not answer a mote that it does not list.
  if (is_full()) return false;
  //= J9-INTERLEAVE: Joins of several motes may interleave at a sink; each keeps its own sequence
  //= number and descriptor.
  if (entry != nullptr) erase(static_cast<uint8_t>(entry - entries_));
  entry = &add();
  entry->devid = devid;
  entry->seq_num = seq_num;
  entry->descriptor = descriptor;
  entry->state = Admission::State::kPending;
  return true;
}

inline Admission* Admissions::acknowledge(uint16_t devid, uint16_t seq_num) {
  Admission* const entry = find(devid);
  //= J6-SEQ: A sink ignores an ack_join whose sequence number is not the one it stored for that
  //= mote.
  if (entry == nullptr || entry->seq_num != seq_num) return nullptr;
  //= J6-REPEAT: A repeated ack_join changes nothing: one moteJoined and one serial_joined for each
  //= join.
  if (entry->state != Admission::State::kPending) return nullptr;
  //= J3-OVERWRITE: A new mote never takes the place of a listed member.
  if (is_full()) return nullptr;
  ++members_;
  // Behind the others, so that reports wait in the order of the joins, not of the requests.
  Admission member = *entry;
  member.state = Admission::State::kOwed;
  erase(static_cast<uint8_t>(entry - entries_));
  entries_[count_] = member;
  return &entries_[count_++];
}

inline Admission* Admissions::owed() {
  for (uint8_t i = 0; i < count_; ++i) {
    if (entries_[i].state == Admission::State::kOwed) return &entries_[i];
  }
  return nullptr;
}

}  // namespace node
}  // namespace rubric
