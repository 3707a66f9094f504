// Messages with known values in every field: decoded frames, and application messages.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "conformance/trace/schema.h"
#include "conformance/trace/trace.h"

namespace rubric::trace {

/// A message that cannot be made, with the part that is to blame.
class TraceError : public std::runtime_error {
 public:
  TraceError(Place place, const std::string& text) : std::runtime_error(text), place_(place) {}
  Place place() const { return place_; }

 private:
  Place place_;
};

/// The variable that is bound from the start, to a number of 16 bits that the seed chooses.
inline constexpr const char* kSeeded = "seeded";

/// The values of `$q` and other variables in a case: numbers, reals, bytes, and addresses, channels
/// and lists of these.
class Bindings {
 public:
  const Value* find(std::string_view name) const;
  void set(std::string_view name, Value value);
  const std::map<std::string, Value, std::less<>>& all() const { return values_; }

 private:
  std::map<std::string, Value, std::less<>> values_;
};

/// A field with its value.
struct Leaf {
  std::string path;
  std::string alias;  ///< Another path to it, of opaque bytes; mostly empty.
  Domain domain;
  std::int64_t number = 0;  ///< Numbers; a real as its 32 bits.
  std::string bytes;
  /// Of characters, as UTF-8: what comes before their terminator and padding. Absent where a byte
  /// is not of their encoding.
  std::optional<std::string> text;
  /// Returns the number, real, text or bytes, without names.
  Value value() const;
  /// Returns the same with names.
  Value show() const;
};

/// Leaves that belong together: an address, a channel, a list, a structure.
struct Part {
  std::string path;
  std::string alias;
  Slot::Kind kind = Slot::Kind::kStruct;
  std::size_t first = 0;  ///< Index of its first leaf.
  std::size_t end = 0;
  std::string bytes;  ///< For structures of the wire.
};

struct Concrete {
  std::string name;
  std::optional<AmFrame> frame;  ///< If it is one.
  std::vector<Leaf> leaves;      ///< In their order.
  std::vector<Part> parts;       ///< Outer ones first.
  Message message;               ///< As a log shows it: addresses, lists and names.
  /// Bytes after the content of a message that has one size only, and the rule that gives it.
  std::size_t excess = 0;
  ReqId size_rule = ReqId::kNone;

  /// Returns the leaf with this whole path, or null.
  const Leaf* leaf(std::string_view path) const;
  const Part* part(std::string_view path) const;
  std::optional<std::int64_t> number(std::string_view path) const;
  /// Returns pid and devid, or source and destination of a channel.
  std::optional<std::pair<std::uint16_t, std::uint16_t>> pair(std::string_view path) const;
};

/// Decodes a frame: as the message that its AM type has on the link, or as `am(type payload)` if it
/// is unknown there or malformed.
Concrete decode(const AmFrame& frame, LinkKind link);
/// Decodes as `am(type payload)` in any case.
Concrete decode_raw(const AmFrame& frame);

/// Makes a call, an event or another message that is no frame. Variables take their values; `...`
/// leaves zeros; `!x` becomes another value. Throws TraceError if a field is missing or ambiguous.
Concrete concrete(const Message& message, const Bindings& bindings = {});

// Lines of a log.

/// Returns a line with AM addresses, all fields and the exact bytes.
Line frame_line(std::int64_t ticks, std::string_view node, Op op, std::string_view link,
                LinkKind kind, const AmFrame& frame);
/// Returns the line of a frame that the link lost or doubled; `op` is kLost or kDup.
Line fault_line(std::int64_t ticks, Op op, std::string_view link, LinkKind kind,
                const AmFrame& frame);
/// Returns a line on app, power, or about the state of a link.
Line app_line(std::int64_t ticks, std::string_view node, Op op, std::string_view link,
              Message message);

}  // namespace rubric::trace
