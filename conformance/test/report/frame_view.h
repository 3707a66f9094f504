// A frame of a log for people: its bytes, and the meaning of each.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "conformance/trace/trace.h"

namespace rubric::suite {

struct FrameField {
  std::uint32_t offset_bytes;
  std::uint32_t size_bytes;
  std::string path;   ///< "payload.body.seq_num"
  std::string value;  ///< "3 (telosb_demo)"; empty for opaque bytes that are no text.
};

struct FrameView {
  std::string hex;
  std::vector<FrameField> fields;  ///< In the order of their bytes.
};

/// Describes a serial forwarder packet, as logs have them on every link. Bytes that no field
/// describes are shown as such, so that each byte has its place.
FrameView view_frame(std::string_view packet, trace::LinkKind link);

}  // namespace rubric::suite
