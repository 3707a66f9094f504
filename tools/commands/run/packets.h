// Packets of a station's lines as frames of the machine, which logs and targets take.
#pragma once

#include "codec/generated/tinyos/am_header.h"
#include "conformance/machine/event.h"
#include "conformance/node/types.h"

namespace rubric::run {

/// Returns what borrows the packet's bytes.
inline machine::Frame frame_of(node::Line line, Bytes packet) {
  machine::Frame frame{.link = static_cast<machine::Link>(line)};
  const auto header = tinyos::AmHeaderView::parse(packet);
  if (!header) {
    frame.packet = packet;
    return frame;
  }
  frame.dest = header->dest();
  frame.src = header->src();
  frame.type = header->type();
  frame.payload = header->stale();
  return frame;
}

}  // namespace rubric::run
