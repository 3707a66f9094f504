// Explains a frame, field by field.
#pragma once

#include <string>

#include "codec/reflect/frame.h"

namespace rubric::explain {

/// Returns rows of offset, bytes, field, value and meaning; then notes, and for a malformed frame
/// its fault, place, and rule. Offsets count from the frame's first byte: the kind byte, the
/// dispatch byte, the frame control field or the message.
std::string explain_frame(const reflect::Frame& frame);

}  // namespace rubric::explain
