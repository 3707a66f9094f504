// Bytes of a message that are no content: what was in the sender's buffer before. Legal on a serial
// line (N6-CONTENT); a note says where they are, since readers take them for content.
#pragma once

#include <cstdint>

#include "conformance/oracle/context.h"

namespace rubric::oracle {

/// The frames of one node with such bytes.
struct Stale {
  Place first;
  Place last;
  std::uint64_t frames = 0;
  std::size_t content_bytes = 0;  ///< Of the first: behind its header.
  std::size_t stated_bytes = 0;   ///< What its nbytes says, or the frame has.

  void add(const Place& at, std::size_t content, std::size_t stated) {
    last = at;
    if (frames++ > 0) return;
    first = at;
    content_bytes = content;
    stated_bytes = stated;
  }
};

/// One note of the first, with how many there are.
inline void note_stale(Context& context, std::uint16_t node, ReqId requirement,
                       const Stale& stale, const char* what) {
  if (stale.frames == 0) return;
  std::string text = std::string(what) + number(stale.stated_bytes) + " bytes where " +
                     number(stale.content_bytes) +
                     " are content; what lies behind them is stale";
  if (stale.frames > 1) {
    text += ", here and in " + number(stale.frames - 1) + " more up to frame " +
            number(stale.last.frame);
  }
  context.report(requirement, Severity::kNote, stale.first, node,
                 {text + ".", "No byte behind the content.", {}});
}

}  // namespace rubric::oracle
