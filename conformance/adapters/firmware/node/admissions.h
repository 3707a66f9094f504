// A sink's list of motes: its members, and those whose join it has answered.
// (paper: Component Management)
#pragma once

#include "conformance/adapters/firmware/node/limits.h"
#include "conformance/adapters/firmware/node/types.h"

namespace rubric {
namespace firmware {

struct Admission {
  enum class State : uint8_t {
    kPending,  ///< Answered, not acknowledged.
    kOwed,     ///< A member whose report waits for the serial line.
    kMember,
  };
  uint16_t devid;
  uint16_t seq_num;  ///< Of the request answered last.
  Descriptor descriptor;
  State state;
};

class Admissions {
 public:
  void clear() { count_ = members_ = 0; }
  /// A join_request; true: answer it.
  bool request(uint16_t devid, uint16_t seq_num, const Descriptor& descriptor);
  /// An ack_join for this island; the new member, whose report is owed, or null.
  Admission* acknowledge(uint16_t devid, uint16_t seq_num);
  /// The member whose report has waited longest, or null.
  Admission* owed();

 private:
  Admission* find(uint16_t devid);
  void erase(uint8_t i);
  /// A place for one more, if need be that of the oldest join which was not acknowledged.
  Admission& add();

  Admission entries_[kAdmissionsRoom];
  uint8_t count_ = 0;
  uint8_t members_ = 0;
};

}  // namespace firmware
}  // namespace rubric
