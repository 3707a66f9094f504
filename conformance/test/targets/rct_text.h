// The words of rct/1 (PORTING.md), as runner and adapter both write and read them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "conformance/machine/actions.h"
#include "conformance/test/runner/target.h"
#include "conformance/trace/concrete.h"

namespace rubric::targets {

using runner::Output;
using runner::Ticks;

constexpr int kRctVersion = 1;
constexpr Ticks kTicksMax = 0x7FFFFFFF;  ///< The last T; 24 days.

/// Takes words off a line, with one blank after each.
class Words {
 public:
  explicit Words(std::string_view line) : rest_(line) {}
  /// Returns the text up to the next blank; empty at the end, and between two blanks.
  std::string_view next();
  std::string_view rest() const { return rest_; }
  bool at_end() const { return rest_.empty(); }

 private:
  std::string_view rest_;
};

/// Parses a number from 0 to `max` in decimal digits; returns nothing if it is none.
std::optional<std::uint32_t> number_of(std::string_view text, std::uint32_t max);

std::string_view link_word(machine::Link link);
std::optional<machine::Link> link_of(std::string_view word);
std::string_view role_word(machine::Role role);
std::optional<machine::Role> role_of(std::string_view word);
/// Returns the links of a `links=` word, "app,peis".
std::string links_text(const runner::Reach& links);
/// Reads them; returns nothing if one is not known.
std::optional<runner::Reach> links_of(std::string_view text);

/// Returns what makes a text no line of the protocol: "byte 0xff at column 3 is not printable
/// ASCII"; empty if nothing does.
std::string unprintable(std::string_view line);

/// Returns the serial forwarder packet in hex digits.
std::string hex_of(const machine::Frame& frame);
/// Fills `frame` and the bytes that it refers to; returns what is wrong, or nothing.
std::string frame_of(std::string_view hex, machine::Frame& frame, std::vector<std::uint8_t>& bytes);

/// Returns "join(type=1 transducers=7 actuators=1)": all fields in order, with numbers instead of
/// names.
std::string plain(const trace::Message& message);
/// Reads a message without wildcards, variables and the like, with all its fields; returns what is
/// wrong, or nothing.
std::string read_plain(std::string_view text, trace::Concrete& out);

/// Returns the line of an output, without its end.
std::string output_line(const Output& output);

}  // namespace rubric::targets
