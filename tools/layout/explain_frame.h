// A frame, field by field.
#pragma once

#include <string>

#include "codec/reflect/frame.h"

namespace rubric::layout {

/// Rows of offset, bytes, field, value and meaning; then notes, and for a malformed frame what is
/// wrong, where, and the rule. Offsets count from the frame's first byte: the kind byte, the
/// dispatch byte, the frame control field or the message.
std::string explain_frame(const reflect::Frame& frame);

}  // namespace rubric::layout
