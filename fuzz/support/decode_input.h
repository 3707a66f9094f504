// The form of decode_fuzz's input, shared with its mutator.
#pragma once

#include <cstddef>
#include <cstdint>

#include "codec/containers/reader.h"

namespace rubric::fuzz {

/// Two bytes with the options of `rubric decode`, then its input.
struct DecodeInput {
  static constexpr std::size_t kHeadBytes = 2;

  InputFormat format = InputFormat::kHdlc;
  bool hex_radio = false;  ///< Lines of hex text are radio frames.
  bool hex = false;
  bool color = false;
  bool units = false;
  Bytes first;  ///< For the first read,
  Bytes rest;   ///< and in the second.
};

/// Reads the head; `size` is at least kHeadBytes. A format byte of 6 means detecting the format.
inline DecodeInput read_decode_input(const std::uint8_t* data, std::size_t size) {
  constexpr InputFormat kFormats[] = {InputFormat::kHdlc,    InputFormat::kSf,  InputFormat::kPcap,
                                      InputFormat::kPcapng,  InputFormat::kHex, InputFormat::kHex,
                                      InputFormat::kUnknown, InputFormat::kHdlc};
  DecodeInput out;
  const Bytes input(data + DecodeInput::kHeadBytes, size - DecodeInput::kHeadBytes);
  const unsigned options = data[0];
  out.format = kFormats[options & 7u];
  if (out.format == InputFormat::kUnknown) out.format = detect(input);
  out.hex_radio = (options & 7u) == 5;
  out.hex = (options & 8u) != 0;
  out.color = (options & 16u) != 0;
  out.units = (options & 32u) != 0;
  const std::size_t split = input.size() * data[1] / 255;
  out.first = input.first(split);
  out.rest = input.from(split);
  return out;
}

}  // namespace rubric::fuzz
