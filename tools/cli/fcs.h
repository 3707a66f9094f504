// The two bytes that end a captured radio frame: its FCS, or what a sniffer put in their place.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "codec/containers/packet.h"

namespace rubric::cli {

enum class FcsKind : std::uint8_t {
  kCrc,
  kCc24xx,   ///< RSSI (signed), then the CRC bit (0x80) and seven bits of correlation.
  kNone,     ///< The frame's own bytes.
  kLeftOut,  ///< Not captured: each record is two bytes shorter than its frame was.
  kExtra,    ///< There, though the link type (230) says that frames have none.
};

/// Returns the kind of a --fcs value; kCrc for auto.
FcsKind fcs_kind(std::string_view name);

/// Recognises the trailers of TI's CC24xx chips. Needs eight different frames whose check sums
/// fail, while nearly all have the CRC bit and a correlation that the chip gives sound frames
/// (CC2420 data sheet, section "Link quality indication": about 50 to 110). Random bytes pass as
/// one such frame in four cases, so that eight damaged frames are taken for sound ones in fewer
/// than 1 of 50,000. One frame in 50 may have an FCS that holds by chance.
class FcsGuess {
 public:
  void take(const Packet& packet);
  bool is_cc24xx() const;
  /// Returns whether they are too few to know, or too many are damaged, but most are alike.
  bool may_be_cc24xx() const;
  /// Returns whether no FCS of several frames fits.
  bool fits_nowhere() const;
  /// Returns whether records lack their FCS and nothing else, as Cooja of Contiki writes them.
  bool is_left_out() const;
  /// Returns whether frames of link type 230 end with their FCS: two different ones at least, and
  /// 50 for each that does not.
  bool is_extra() const;

 private:
  bool is_again(Bytes bytes);

  std::uint64_t sound_ = 0;
  std::uint64_t alike_ = 0;
  std::uint64_t other_ = 0;
  std::uint64_t left_out_ = 0;
  std::uint64_t cut_ = 0;  // Of which more is missing, or less.
  std::uint64_t extra_ = 0;
  std::uint64_t without_ = 0;  // Of link type 230, and rightly so.
  std::vector<std::uint8_t> last_;
};

/// Reads the end of a packet of link type 195 anew, and by kExtra of 230; leaves others as they
/// are, and cut ones, unless it is by kNone or kLeftOut and the FCS alone is missing: then the
/// frame is whole. A CC24xx trailer stays in `fcs`, RSSI and link quality go into `radio`; the
/// fault is kFcs if its CRC bit is clear.
void reread_fcs(FcsKind kind, Packet& packet);

}  // namespace rubric::cli
