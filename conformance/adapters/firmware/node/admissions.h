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
  uint16_t seq_num;  ///< In the request answered last.
  Descriptor descriptor;
  State state;
};

class Admissions {
 public:
  void clear() { count_ = members_ = 0; }
  /// Handles a join_request; returns true if it is to be answered.
  bool request(uint16_t devid, uint16_t seq_num, const Descriptor& descriptor);
  /// Handles an ack_join for this island; returns the new member, whose report is owed, or null.
  Admission* acknowledge(uint16_t devid, uint16_t seq_num);
  /// Returns the member whose report has waited longest, or null.
  Admission* owed();

 private:
  Admission* find(uint16_t devid);
  void erase(uint8_t i);
  /// Returns a place for one more, if needed that of the oldest join which was not acknowledged.
  Admission& add();

  Admission entries_[kAdmissionsRoom];
  uint8_t count_ = 0;
  uint8_t members_ = 0;
};

}  // namespace firmware
}  // namespace rubric
