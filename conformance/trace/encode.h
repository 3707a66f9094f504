// Turns a line's stimulus for a node into the frame that travels.
#pragma once

#include "conformance/trace/concrete.h"
#include "conformance/trace/trace.h"

namespace rubric::trace {

/// Makes the AM payload and type of a message of the wire spec, or of `am(type payload)`. Variables
/// take their values, `!x` becomes another value; with `...` missing fields take the value that the
/// spec implies, else the least one, and lists and bodies are empty. dest and src stay 0. Throws
/// TraceError.
AmFrame encode(const Message& message, const Bindings& bindings = {});

/// Returns the frame of a line: its exact bytes if it has any, else its message with the addresses
/// of `am=`. Without `am=` a frame is for the node that receives it, or for all where the protocol
/// says so of its message; its source is the devid of `src` if a node has that, else the one id
/// that nodes of the other role have. Over PEIS islands replace ids. On a serial line the messages
/// of which the protocol says so have 114 bytes, zeros at the end. Throws TraceError, also if the
/// source is ambiguous.
AmFrame frame_of(const Line& line, const Scope& scope, const Bindings& bindings = {});

/// Checks that this pattern allows a message: variables, wildcards and ranges match any value that
/// fits. Throws TraceError if not.
void check_possible(const Message& message);

}  // namespace rubric::trace
