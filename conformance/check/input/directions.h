// Finds which way the frames of a serial line went.
//
// A packet that asks for confirmation is a host's, and the confirmation is the mote's (FACTS: TEP
// 113). Where the capture has direction flags but most such frames contradict them, the flags are
// those of the capturing host, to which a mote's frames are inbound: all are turned. Where it has
// none, and some packets on the line ask for confirmation, those that do not are the mote's. Else
// the message decides: what a base station sends, and what comes to the island of the line from
// another, goes down it.
#pragma once

#include "conformance/check/observation.h"

namespace rubric::check {

/// Counts what a frame of the tap says of its direction; `stated`: by the capture.
void count_direction(const Observation& seen, bool stated, Tap& tap);

/// Sets the direction of each frame on a serial line, and says in `facts` which flags were turned.
void find_directions(Run& run);

/// Returns whether a frame on a serial line goes to the sink, if nothing else says so: a sink's
/// frames have AM source 0 and destination 0xFFFF just as a host's may, so the message decides.
bool looks_towards_sink(const machine::Frame& frame);

}  // namespace rubric::check
