// How frames reach messages: which numbers of a frame choose the message and which hold a length.
// The spec compiler emits a table of these (codec/generated/*/messages.h) for the structure-aware
// fuzzer and for whoever builds frames; what the message itself is made of stands in its Type.
#pragma once

#include "codec/reflect/schema.h"

namespace rubric {
namespace reflect {

/// A number that must have this value, so that the frame leads to the message.
struct RouteChoice {
  uint16_t offset;        ///< From the start of the frame.
  uint8_t width_bytes;
  bool little_endian;
  uint32_t value;
};
/// A number that counts the bytes of the frame from `from` on.
struct RouteLength {
  uint16_t offset;
  uint8_t width_bytes;
  bool little_endian;
  uint16_t from;
};
struct Route {
  const char* carrier;    ///< Whose frames: "serial", "radio_i", ...
  const Type* type;       ///< The message.
  uint16_t offset;        ///< Where it begins.
  uint32_t room;          ///< The most bytes that it can have there; UINT32_MAX if unbounded.
  const RouteChoice* choices;
  uint8_t choice_count;
  const RouteLength* lengths;
  uint8_t length_count;
};
struct RouteTable {
  const Route* routes;
  uint16_t count;
};

}  // namespace reflect
}  // namespace rubric
