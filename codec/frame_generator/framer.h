// Puts generated frames into their carriers: serial line, serial forwarder, radio. Also makes the
// containers' own faults (check sums, frames too short or given up).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "codec/containers/packet.h"
#include "codec/containers/reader.h"
#include "codec/frame_generator/frame_generator.h"
#include "codec/frame_generator/random.h"

namespace rubric::generate {

/// A frame with its surroundings, for a Writer of the container.
struct Framed {
  Packet packet;  ///< Without its bytes; with the framing's own fault, as a reader reports it.
  std::vector<std::uint8_t> bytes;
  const reflect::Route* route = nullptr;
  std::vector<const reflect::Type*> path;      ///< Like Generated::path.
  std::vector<NumberAt> numbers;               ///< Like Generated::numbers.
  Error error{Fault::kNone, 0, ReqId::kNone};  ///< The required reflect::Frame::error.
  Error unfit{Fault::kNone, 0, ReqId::kNone};  ///< Like Generated::unfit.
  const reflect::Type* unfit_message = nullptr;
  std::string what;

  bool valid() const { return error.fault == Fault::kNone; }
  /// Returns the packet with its bytes; valid until this object changes.
  Packet view() const {
    Packet whole = packet;
    whole.bytes = Bytes(bytes.data(), bytes.size());
    return whole;
  }
};

/// Carries frames in one container: kHdlc, kSf, kPcapng (any of them, a record each), or kHex and
/// kJsonl (without any framing).
class Framer {
 public:
  Framer(InputFormat container, Random& random) : container_(container), random_(random) {}

  /// Returns whether the container can hold a frame of that carrier.
  bool holds(const reflect::Route& route) const;

  /// Returns the frame in sound framing.
  Framed sound(Generated made);
  /// Makes a valid frame with broken framing; returns false if the container has no framing to
  /// break. `last`: nothing follows it, so that a stream may end in the middle of it.
  bool broken(Generated valid, bool last, Framed& out);

 private:
  void around_serial(Framed& out);
  void around_radio(Framed& out, bool fcs);
  bool break_hdlc(bool last, Framed& out);
  bool break_sf(bool last, Framed& out);
  bool break_radio(Framed& out);
  void serial_content(std::vector<std::uint8_t> content, Error error, const char* what,
                      Framed& out);
  void lengthen(std::size_t more_than, Framed& out);

  InputFormat container_;
  Random& random_;
};

}  // namespace rubric::generate
