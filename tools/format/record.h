// Input and interface of formatters.
#pragma once

#include <cstdint>
#include <string_view>

#include "codec/reflect/frame.h"
#include "tools/format/buffer.h"

namespace rubric::format {

/// A decoded frame with the facts that only the run has. Borrowed: valid during the call.
struct Record {
  std::uint64_t index = 0;          ///< Counts the frames of all inputs from 0.
  std::uint64_t number = 1;         ///< The frame in its file, from 1, as in `rubric check`.
  std::string_view interface_name;  ///< Empty: the input names none.
  std::int64_t time_ns = kNoTime;   ///< In the form of --time; kNoTime: not shown.
  std::string_view time_text;       ///< In place of time_ns, where --time asks for a date.
  const reflect::Frame* frame = nullptr;

  const Packet& packet() const { return *frame->packet; }
  const reflect::Decoded& decoded() const { return frame->decoded; }
};

/// Prints records in one format.
class Formatter {
 public:
  virtual ~Formatter() = default;
  /// Prints the text before the first record.
  virtual void begin(Buffer&) {}
  virtual void print(const Record& record, Buffer& out) = 0;
};

/// Returns "hdlc", "sf", "radio", "bare".
std::string_view framing_name(Framing framing);
/// Returns "inbound", "outbound", or an empty text.
std::string_view direction_name(Direction direction);
/// Returns the name of a serial packet kind, or an empty text.
std::string_view serial_kind_name(std::int32_t kind);
/// Returns the dispatch byte of serial packets, or kAbsent.
std::int32_t dispatch_of(const Packet& packet);
/// Returns the network byte of radio frames, or kAbsent.
std::int32_t network_of(const reflect::Frame& frame);

}  // namespace rubric::format
