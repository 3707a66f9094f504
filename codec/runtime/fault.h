// The fault codes of every reader and writer.
#pragma once

#include <stdint.h>

namespace rubric {

/// The kind of a fault. Its place and rule travel beside it, see Error.
enum class Fault : uint8_t {
  kNone = 0,
  kTruncated,    ///< The bytes end before the field does, or hold less than a length says.
  kTrailing,     ///< More bytes than the length says.
  kUnexpected,   ///< A value that is not one of the allowed ones.
  kOutOfRange,   ///< A value below its minimum or above its maximum.
  kNoRoom,       ///< Writing: the output is too small.
  kCrc,          ///< The check sum of the serial frame does not match.
  kFcs,          ///< The check sum of the 802.15.4 frame does not match.
  kTooShort,     ///< A frame below the smallest possible size.
  kTooLong,      ///< A frame beyond the largest possible size; the excess was dropped.
  kAborted,      ///< A frame that its sender gave up: an escape directly before a flag.
  kCut,          ///< The input ends in the middle of a frame, packet or block.
  kEmpty,        ///< A packet of zero bytes.
  kHandshake,    ///< A stream that does not begin as it must.
  kContainer,    ///< A capture file's block or record is damaged.
  kUnsupported,  ///< Well formed, but of a kind that this reader does not take.
};

}  // namespace rubric
