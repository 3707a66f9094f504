// What a node does wrong once shows in many cases, in lines that name other rules: a mote that acks
// nothing fails where an ack only proves that it lives on. So each failure has several possible
// causes: the rules that its line names, that by which the reference machine does what the line
// asks for, and those of what the machine did before in this case and the node did not. Of all
// failures of a run together, the fewest rules that cause them are called broken.
#pragma once

#include "conformance/test/suite/result.h"

namespace rubric::suite {

/// Plays a case that failed with the machine, where the protocol has one, and notes the lines that
/// the machine breaks, too, as another profile has it, the rules of failures whose lines name none,
/// and what the machine did and the node did not.
void compare_with_machine(const trace::File& head, const trace::Case& one, CaseRun& out);

/// Calls failures implied which a rule explains that explains more of them than the one they blame.
/// It is a rule that failures blame in as many cases, and whose cases pass as seldom. Failures that
/// look alike may have one cause; of those that prove their rule by themselves, only where the node
/// answered messages of one kind: an ack of a broadcast is not explained by acks of what is
/// unreliable.
void find_causes(ImplementationRun& run);

}  // namespace rubric::suite
