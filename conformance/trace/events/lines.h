// What is given to a node of the machine, and what it does, as lines of a trace.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "conformance/machine/actions.h"
#include "conformance/trace/concrete.h"

namespace rubric::events {

/// What a trace calls a node and its lines.
struct NodeNames {
  std::string node;
  std::string radio;
  std::string serial;
  std::string peis = "peis";
  std::uint8_t radio_group = 0;  ///< Of the AM packets that stand for its radio frames.

  const std::string& link(machine::Link link) const;
};

trace::LinkKind kind_of(machine::Link link);
trace::AmFrame frame_of(const NodeNames& names, const machine::Frame& frame);
/// Returns the packet that stands for the frame in rct/1 and on serial lines.
std::vector<std::uint8_t> packet_of(const machine::Frame& frame);

/// Nothing for timers, which no line shows.
std::optional<trace::Line> given_line(std::int64_t now, const NodeNames& names,
                                      const machine::Event& event);
/// With the rule that the node followed, if it names one.
trace::Line emitted_line(std::int64_t now, const NodeNames& names, const machine::Frame& frame,
                         ReqId rule);
trace::Line emitted_line(std::int64_t now, const NodeNames& names, const machine::Notice& notice,
                         ReqId rule);
/// The lines of all frames and notices, in order.
std::vector<trace::Line> emitted_lines(std::int64_t now, const NodeNames& names,
                                       const machine::Actions& actions);

}  // namespace rubric::events
