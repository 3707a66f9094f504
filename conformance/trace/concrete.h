// Messages whose every field is known: decoded frames, and application messages.
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

/// A message that cannot be made, and which of its parts is why.
class TraceError : public std::runtime_error {
 public:
  TraceError(Place place, const std::string& text) : std::runtime_error(text), place_(place) {}
  Place place() const { return place_; }

 private:
  Place place_;
};

/// What `$q` and its like stand for in a case. Values are numbers, reals, bytes, and addresses,
/// channels and lists of these.
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
  std::string alias;        ///< Another path to it, of opaque bytes; mostly empty.
  Domain domain;
  std::int64_t number = 0;  ///< Numbers; a real as its 32 bits.
  std::string bytes;
  /// The number, real or bytes, without names.
  Value value() const;
  /// The same with names.
  Value show() const;
};

/// Leaves that belong together: an address, a channel, a list, a structure.
struct Part {
  std::string path;
  std::string alias;
  Slot::Kind kind = Slot::Kind::kStruct;
  std::size_t first = 0;    ///< Of its leaves.
  std::size_t end = 0;
  std::string bytes;        ///< Of structures of the wire.
};

struct Concrete {
  std::string name;
  std::optional<AmFrame> frame;  ///< Where it is one.
  std::vector<Leaf> leaves;      ///< In their order.
  std::vector<Part> parts;       ///< Outer ones first.
  Message message;               ///< As a log shows it: addresses, lists and names.

  /// By its whole path; null if it has none.
  const Leaf* leaf(std::string_view path) const;
  const Part* part(std::string_view path) const;
  std::optional<std::int64_t> number(std::string_view path) const;
  /// pid and devid, or source and destination of a channel.
  std::optional<std::pair<std::uint16_t, std::uint16_t>> pair(std::string_view path) const;
};

/// Whatever the frame is: what the link makes of its AM type, or `am(type payload)` where it is
/// unknown there or malformed.
Concrete decode(const AmFrame& frame, LinkKind link);
/// As `am(type payload)` in any case.
Concrete decode_raw(const AmFrame& frame);

/// A call, an event or another message of app_messages.h. Variables take what they are bound to;
/// `...` leaves zeros; `!x` becomes another value. Throws TraceError where a field is missing or
/// says more than one thing.
Concrete concrete(const Message& message, const Bindings& bindings = {});

// Lines of a log.

/// With AM addresses, all fields and the exact bytes.
Line frame_line(std::int64_t ticks, std::string_view node, Op op, std::string_view link,
                LinkKind kind, const AmFrame& frame);
/// The link lost or doubled this frame; `op` is kLost or kDup.
Line fault_line(std::int64_t ticks, Op op, std::string_view link, LinkKind kind,
                const AmFrame& frame);
/// On app, power, or the state of a link.
Line app_line(std::int64_t ticks, std::string_view node, Op op, std::string_view link,
              Message message);

}  // namespace rubric::trace
