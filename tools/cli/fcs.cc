#include "tools/cli/fcs.h"

#include <algorithm>

#include "codec/containers/link_record.h"

namespace rubric::cli {
namespace {

constexpr std::int32_t kCrcBit = 0x8000;
constexpr std::int32_t kCorrelationMin = 40;
constexpr std::int32_t kCorrelationMax = 115;
constexpr std::uint64_t kAlikeMin = 8;
constexpr std::uint64_t kAlikeToSay = 3;
constexpr std::uint64_t kFcsBytes = 2;
constexpr std::uint64_t kExtraMin = 2;

bool has_fcs(const Packet& packet) {
  return packet.link_type == kLinkRadioFcs && packet.fcs != kAbsent &&
         (packet.error.fault == Fault::kNone || packet.error.fault == Fault::kFcs);
}

bool lacks_fcs_alone(const Packet& packet) {
  return packet.cut_by_capture() && packet.dropped_bytes == kFcsBytes && !packet.bytes.empty();
}

bool is_whole_without_fcs(const Packet& packet) {
  return packet.link_type == kLinkRadioNoFcs && packet.error.fault == Fault::kNone;
}

}  // namespace

FcsKind fcs_kind(std::string_view name) {
  if (name == "cc24xx") return FcsKind::kCc24xx;
  return name == "none" ? FcsKind::kNone : FcsKind::kCrc;
}

void FcsGuess::take(const Packet& packet) {
  if (packet.link_type == kLinkRadioFcs && packet.cut_by_capture()) {
    ++(lacks_fcs_alone(packet) ? left_out_ : cut_);
  }
  if (is_whole_without_fcs(packet) && !is_again(packet.bytes)) {
    ++(ends_with_fcs(packet.bytes) ? extra_ : without_);
  }
  if (!has_fcs(packet)) return;
  if (packet.error.fault == Fault::kNone) {
    ++sound_;
    return;
  }
  if (is_again(packet.bytes)) return;
  const std::int32_t correlation = packet.fcs >> 8 & 0x7F;
  const bool alike = (packet.fcs & kCrcBit) != 0 && correlation >= kCorrelationMin &&
                     correlation <= kCorrelationMax;
  ++(alike ? alike_ : other_);
}

// A frame that is sent again shows nothing new.
bool FcsGuess::is_again(Bytes bytes) {
  if (std::equal(bytes.begin(), bytes.end(), last_.begin(), last_.end())) return true;
  last_.assign(bytes.begin(), bytes.end());
  return false;
}

bool FcsGuess::is_extra() const { return extra_ >= kExtraMin && without_ * 50 <= extra_; }

bool FcsGuess::is_cc24xx() const {
  return alike_ >= kAlikeMin && sound_ * 50 <= alike_ && other_ * 9 <= alike_;
}

bool FcsGuess::may_be_cc24xx() const {
  return alike_ >= kAlikeToSay && sound_ == 0 && other_ * 2 <= alike_ && !is_cc24xx();
}

bool FcsGuess::fits_nowhere() const { return alike_ + other_ >= kAlikeMin && sound_ == 0; }

bool FcsGuess::is_left_out() const {
  return left_out_ != 0 && cut_ == 0 && sound_ == 0 && alike_ + other_ == 0;
}

void reread_fcs(FcsKind kind, Packet& packet) {
  if (kind == FcsKind::kExtra && is_whole_without_fcs(packet)) {
    packet.link_type = kLinkRadioFcs;
    return decode_radio_record(packet.bytes, kLinkRadioFcs, packet);
  }
  if (packet.link_type != kLinkRadioFcs) return;
  const bool may_lack_it = kind == FcsKind::kNone || kind == FcsKind::kLeftOut;
  if (may_lack_it && lacks_fcs_alone(packet)) {
    packet.link_type = kLinkRadioNoFcs;
    packet.dropped_bytes = 0;
    return decode_radio_record(packet.bytes, kLinkRadioNoFcs, packet);
  }
  if (packet.error.fault == Fault::kCut) return;
  if (kind == FcsKind::kCc24xx && has_fcs(packet)) {
    packet.radio.rssi = static_cast<std::int8_t>(packet.fcs & 0xFF);
    packet.radio.lqi = static_cast<std::int16_t>(packet.fcs >> 8 & 0x7F);
    const bool sound = (packet.fcs & kCrcBit) != 0;
    packet.error = sound ? Error{Fault::kNone, 0, ReqId::kNone}
                         : fail(Fault::kFcs, packet.bytes.size(), "WIRE-RADIO-FCS"_rule).error;
  }
  if (kind == FcsKind::kNone) {
    const std::size_t after = packet.fcs == kAbsent ? 0 : 2;
    packet.link_type = kLinkRadioNoFcs;
    decode_radio_record(Bytes(packet.bytes.data(), packet.bytes.size() + after), kLinkRadioNoFcs,
                        packet);
  }
}

}  // namespace rubric::cli
