#include "conformance/adapters/firmware/node/admissions.h"

#include <string.h>

namespace rubric {
namespace firmware {

Admission* Admissions::find(uint16_t devid) {
  for (uint8_t i = 0; i < count_; ++i) {
    if (entries_[i].devid == devid) return &entries_[i];
  }
  return nullptr;
}

void Admissions::erase(uint8_t i) {
  --count_;
  memmove(&entries_[i], &entries_[i] + 1, sizeof(Admission) * (count_ - i));
}

Admission& Admissions::add() {
  if (count_ == kAdmissionsRoom) {
    uint8_t oldest = 0;  // There is one: the table has more room than the list.
    while (entries_[oldest].state != Admission::State::kPending) ++oldest;
    erase(oldest);
  }
  return entries_[count_++];
}

bool Admissions::request(uint16_t devid, uint16_t seq_num, const Descriptor& descriptor) {
  Admission* entry = find(devid);
  //= J2-LISTED: A sink ignores a join_request of a mote that is already in its list.
  if (entry != nullptr && entry->state != Admission::State::kPending) return false;
  //= J3-FULL: A sink whose list is full does not answer a mote that it does not list.
  if (members_ == kMembersMax) return false;
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

Admission* Admissions::acknowledge(uint16_t devid, uint16_t seq_num) {
  Admission* const entry = find(devid);
  //= J6-SEQ: A sink ignores an ack_join whose sequence number is not the one it stored for that
  //= mote.
  if (entry == nullptr || entry->seq_num != seq_num) return nullptr;
  //= J6-REPEAT: A repeated ack_join changes nothing: one moteJoined and one serial_joined for each
  //= join.
  if (entry->state != Admission::State::kPending) return nullptr;
  //= J3-OVERWRITE: A new mote never takes the place of a listed member.
  if (members_ == kMembersMax) return nullptr;
  ++members_;
  entry->state = Admission::State::kOwed;
  return entry;
}

Admission* Admissions::owed() {
  for (uint8_t i = 0; i < count_; ++i) {
    if (entries_[i].state == Admission::State::kOwed) return &entries_[i];
  }
  return nullptr;
}

}  // namespace firmware
}  // namespace rubric
