// Makes frames of a protocol's messages from its tables: valid ones, and ones with a single known
// fault. For fuzzers.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "codec/containers/packet.h"
#include "codec/frame_generator/draft.h"
#include "codec/frame_generator/random.h"
#include "codec/reflect/schema.h"
#include "codec/runtime/result.h"

namespace rubric::generate {

inline constexpr std::size_t kFcsBytes = 2;  ///< In a frame on the air. (IEEE 802.15.4, 7.2.1.9)

/// Returns whether the route's frames go over the air, not along a serial line.
bool is_radio(const reflect::Route& route);

/// Returns whether the route's message comes alone, without a frame.
bool is_bare(const reflect::Route& route);

/// A number of a frame; elements of arrays of numbers do not count.
struct NumberAt {
  const reflect::Type* message;  ///< The structure that it belongs to.
  const reflect::Field* field;
  std::uint32_t offset_bytes;  ///< From the start of the frame.
  std::int64_t value;          ///< A float as its 32 bits.
};

/// A frame, and the result that a decoder must give.
struct Generated {
  Framing framing = Framing::kSf;         ///< kSf for the serial line, kRadio for the air.
  std::vector<std::uint8_t> bytes;        ///< Like Packet::bytes.
  const reflect::Route* route = nullptr;  ///< To which message it leads, or nearly leads.
  /// For a valid frame: its messages, from the outermost in. Messages that the route's message
  /// always holds follow it.
  std::vector<const reflect::Type*> path;
  /// The fault by construction, without asking a decoder: Fault::kNone if the frame is valid. The
  /// offset counts from bytes[0].
  Error error{Fault::kNone, 0, ReqId::kNone};
  /// For a valid frame: its numbers, in ascending order of offset.
  std::vector<NumberAt> numbers;
  /// For a valid frame whose innermost bytes break a rule of the meant message: which rule, and
  /// where. A decoder leaves these bytes opaque; `path` ends before that message.
  Error unfit{Fault::kNone, 0, ReqId::kNone};
  const reflect::Type* unfit_message = nullptr;
  std::string what;  ///< "valid", or what is wrong: "join_request.type is 7, allowed are 1 to 5".
  bool valid() const { return error.fault == Fault::kNone; }
  bool fits() const { return unfit.fault == Fault::kNone; }
};

/// Generates frames of one protocol. The same seed gives the same frames, whatever the machine.
/// Throws std::logic_error for a route that no frame of the protocol can take.
class FrameGenerator {
 public:
  FrameGenerator(const reflect::Protocol& protocol, const reflect::RouteTable& routes,
                 std::uint64_t seed)
      : protocol_(protocol), routes_(routes), random_(seed) {}

  const reflect::RouteTable& routes() const { return routes_; }
  Random& random() { return random_; }

  /// Returns a valid frame that leads to the message of that route: every field within its rule,
  /// bounds and reserved values more often than by chance; sizes and counts agree.
  Generated valid(const reflect::Route& route);
  /// Returns the same with one rule broken: a field just outside its range, a count that lies,
  /// bytes missing at the end, a length byte off by one, ... For a message that applications put
  /// into opaque bytes, it may be that message's rule, and the frame is valid but does not fit
  /// (`unfit`). Returns a valid frame only for a message that no single change makes invalid.
  Generated near_valid(const reflect::Route& route);
  /// Returns the valid frame with the meaning of each byte.
  Draft draft(const reflect::Route& route);

 private:
  const reflect::Protocol& protocol_;
  const reflect::RouteTable& routes_;
  Random random_;
};

/// Changes a field of `bytes`, a frame of that framing, in place, by its type: another allowed
/// value, a bound, a neighbour, a bit, an element more or less of an array; repairs lengths and
/// counts around it, so that a valid frame mostly stays valid. Returns false, with nothing changed,
/// if nothing of the frame can be read. `max_size` in bytes.
bool change_field(const reflect::Protocol& protocol, Framing framing,
                  std::vector<std::uint8_t>& bytes, std::size_t max_size, Random& random);

}  // namespace rubric::generate
