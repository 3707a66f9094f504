// From a line that says what is given to a node to the frame that travels.
#pragma once

#include "conformance/trace/concrete.h"
#include "conformance/trace/trace.h"

namespace rubric::trace {

/// Makes the AM payload and type of a message of the wire spec, or of `am(type payload)`. Variables
/// take what they are bound to, `!x` becomes another value; with `...` fields that are not given
/// take the value that the spec implies, else the least one, and lists and bodies are empty.
/// dest and src stay 0. Throws TraceError.
AmFrame encode(const Message& message, const Bindings& bindings = {});

/// The frame of a line: its exact bytes if it has any, else its message with the addresses that
/// `am=` says. Without `am=` a frame is for the node that it is given to, a join_request for all;
/// its source is the devid of `src` if a node has that, else the one id that nodes of the other
/// role have. Over PEIS islands stand in place of ids. Throws TraceError, also where no source can
/// be told.
AmFrame frame_of(const Line& line, const Scope& scope, const Bindings& bindings = {});

/// Whether a message can be made of this pattern at all: variables, wildcards and ranges stand for
/// any value that fits. Throws TraceError if not.
void check_possible(const Message& message);

}  // namespace rubric::trace
