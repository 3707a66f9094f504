// The deframer's rules as a plain program, one byte after the other, to check the fast one.
#pragma once

#include <vector>

#include "codec/containers/test/testing.h"

namespace rubric::fuzz {

/// Returns the required result of a HdlcReader for the whole of `stream`. Written from TEP 113,
/// section 3.1, and the rules in hdlc_reader.h and serial_frame.h; shares no code with the reader.
std::vector<testing::Kept> plain_deframe(Bytes stream);

}  // namespace rubric::fuzz
