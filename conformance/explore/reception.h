// How a node handles what its radio brings, as a flowchart: the figures of the paper (Flowchart of
// the reception of a message), found by trying the machine instead of drawn by hand.
//
// Frames that differ in what a node may ask about them (which message, whose island, which device,
// what is in it) are given to nodes in each stage that matters. A question is drawn where its
// answers lead to different ends.
#pragma once

#include <span>
#include <string_view>

#include "conformance/explore/transitions.h"

namespace rubric::explore {

/// Returns the names of the flowcharts; they live as long as the program.
std::span<const PartName> reception_names();

/// Returns a flowchart as a diagram: questions and ends are its states, answers its triggers. The
/// witness of an answer is a frame that takes it. `name` is one of reception_names().
Diagram reception_of(std::string_view name, const machine::Profile& profile,
                     StepFunction step = machine::step);

}  // namespace rubric::explore
