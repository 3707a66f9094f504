// Puts generated frames into what carries them: serial line, serial forwarder, radio. Where a
// container has faults of its own (check sums, frames too short or given up), it makes those, too.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "codec/containers/packet.h"
#include "codec/containers/reader.h"
#include "codec/generate/frame_generator.h"
#include "codec/generate/random.h"

namespace rubric::generate {

/// A frame with what stands around it, for a Writer of the container.
struct Framed {
  Packet
      packet;  ///< Without its bytes; with what the framing itself breaks, as a reader reports it.
  std::vector<std::uint8_t> bytes;
  const reflect::Route* route = nullptr;
  std::vector<const reflect::Type*> path;      ///< As Generated::path.
  std::vector<NumberAt> numbers;               ///< As Generated::numbers.
  Error error{Fault::kNone, 0, ReqId::kNone};  ///< What reflect::Frame::error must be.
  Error unfit{Fault::kNone, 0, ReqId::kNone};  ///< As Generated::unfit.
  const reflect::Type* unfit_message = nullptr;
  std::string what;

  bool valid() const { return error.fault == Fault::kNone; }
  /// The packet with its bytes; valid until this object changes.
  Packet view() const {
    Packet whole = packet;
    whole.bytes = Bytes(bytes.data(), bytes.size());
    return whole;
  }
};

/// How frames are carried in one container: kHdlc, kSf, kPcapng (any of them, a record each), or
/// kHex and kJsonl (bare of any framing).
class Framer {
 public:
  Framer(InputFormat container, Random& random) : container_(container), random_(random) {}

  /// Whether the container can hold a frame of that carrier.
  bool holds(const reflect::Route& route) const;

  /// The frame in sound framing.
  Framed sound(Generated made);
  /// A valid frame whose framing is broken; false if the container has no framing to be broken.
  /// `last`: nothing follows it, so that a stream may end in the middle of it.
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
