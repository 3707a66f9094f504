// What a message says of its own size. Bytes that are no content: left over in the sender's buffer.
// Lawful on a serial line (N6-CONTENT); a note shows where they are, since readers take them for
// content.
#pragma once

#include <cstdint>

#include "conformance/check/judge/context.h"

namespace rubric::check {

/// The frames of one node with such bytes.
struct Stale {
  Place first;
  Place last;
  std::uint64_t frames = 0;
  std::size_t content_bytes = 0;  ///< In the first frame: after its header.
  std::size_t stated_bytes = 0;   ///< By its nbytes, or the length of the frame.

  void add(const Place& at, std::size_t content, std::size_t stated) {
    last = at;
    if (frames++ > 0) return;
    first = at;
    content_bytes = content;
    stated_bytes = stated;
  }
};

/// Adds one note about the first frame, with the number of all.
inline void note_stale(Context& context, std::uint16_t node, ReqId requirement, const Stale& stale,
                       const char* what) {
  if (stale.frames == 0) return;
  std::string text = std::string(what) + number(stale.stated_bytes) + " bytes where " +
                     number(stale.content_bytes) + " are content; what follows is stale";
  if (stale.frames > 1) {
    text += ", here and in " + number(stale.frames - 1) + " more up to frame " +
            number(stale.last.frame);
  }
  context.report(requirement, Severity::kNote, stale.first, node,
                 {text + ".", "No byte after the content.", {}});
}

/// Reports a message that is malformed, as its nbytes lies (decision 113).
inline void report_nbytes(Context& context, std::uint16_t node, const Place& at, const Net& net) {
  const bool range = !NetAt::NbytesAt::allows(net.nbytes);
  context.report(range ? "WIRE-NET-NBYTES"_rule : "WIRE-NET-PAYLOAD"_rule, Severity::kFail, at,
                 node,
                 {"nbytes is " + number(net.nbytes) + " in a message of " +
                      number(net.payload.size()) + " bytes.",
                  "2 to 102, and no more than the message has.",
                  {}});
}

}  // namespace rubric::check
