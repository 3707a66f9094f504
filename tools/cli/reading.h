// How the bytes of an input are read: by its options, and where they leave it open by its content.
#pragma once

#include <string>
#include <string_view>

#include "codec/containers/reader.h"
#include "tools/cli/fcs.h"
#include "tools/cli/input.h"

namespace rubric::cli {

/// What was decided about an input.
struct Reading {
  InputFormat format = InputFormat::kUnknown;
  ReaderOptions options;
  FcsKind fcs = FcsKind::kCrc;
  std::string remark;  ///< Says what the content decided without an option; empty: nothing.
};

/// Returns whether its lines are the packets.
bool is_text(InputFormat format);

/// Returns whether it is a capture file, pcap or pcapng.
bool is_capture(InputFormat format);

/// Returns how an input that begins with these bytes is read.
Reading reading_of(const InputOptions& options, Bytes beginning);

/// Returns the name of a format, as for --input-format.
std::string_view format_name(InputFormat format);

}  // namespace rubric::cli
