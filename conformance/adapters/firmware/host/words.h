// Converts calls and events between rct/1's text and the records of the bench (bench/records.h).
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "codec/runtime/bytes.h"

namespace rubric::firmware {

using ByteVector = std::vector<std::uint8_t>;

/// A word of a command that makes no sense, and why.
class BadWord : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Converts `NAME(ARGUMENTS)` to code and arguments of a kCall record. Throws BadWord.
ByteVector call_record(std::string_view text);
/// Converts the body of a kEvent record to `NAME(ARGUMENTS)`. Throws BadWord if it is none.
std::string event_text(Bytes body);

/// Parses whole hex bytes. Throws BadWord.
ByteVector bytes_of_hex(std::string_view hex);
std::string hex_of_bytes(Bytes bytes);
/// Parses a decimal number from 0 to `max`. Throws BadWord.
std::uint32_t number_of(std::string_view word, std::uint32_t max);
/// Splits at blanks.
std::vector<std::string_view> split(std::string_view text, char at = ' ');

}  // namespace rubric::firmware
