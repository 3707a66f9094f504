#include "codec/frame_generator/framer.h"

#include <algorithm>

#include "codec/containers/crc16_fast.h"
#include "codec/containers/link_record.h"
#include "codec/containers/serial_frame.h"
#include "codec/containers/sf_reader.h"
#include "codec/frame_generator/values.h"
#include "codec/runtime/hdlc.h"

namespace rubric::generate {
namespace {

constexpr std::size_t kExcessMost = 40;

Bytes view(const std::vector<std::uint8_t>& bytes) { return Bytes(bytes.data(), bytes.size()); }

std::vector<std::uint8_t> content_of(const Framed& framed) {
  std::string text;
  append_serial_content(framed.view(), text);
  return std::vector<std::uint8_t>(text.begin(), text.end());
}

// Returns the number of bytes of a serial frame before those of the packet.
std::uint32_t head_of(const Packet& packet) {
  return (packet.kind != kAbsent ? 1u : 0u) + (packet.serial_seq != kAbsent ? 1u : 0u);
}

void set_crc(std::vector<std::uint8_t>& bytes, Packet& packet) {
  packet.crc = kAbsent;
  Packet whole = packet;
  whole.bytes = view(bytes);
  std::string content;
  append_serial_content(whole, content);
  const auto* const data = reinterpret_cast<const std::uint8_t*>(content.data());
  packet.crc = crc16_fast(Bytes(data, content.size()));
}

Framed taken(Generated made) {
  Framed out;
  out.packet.framing = made.framing;
  out.bytes = std::move(made.bytes);
  out.route = made.route;
  out.path = std::move(made.path);
  out.numbers = std::move(made.numbers);
  out.error = made.error;
  out.unfit = made.unfit;
  out.unfit_message = made.unfit_message;
  out.what = std::move(made.what);
  return out;
}

// Marks the framing as broken: no message is promised any more.
void set_fault(Fault fault, std::size_t at, ReqId requirement, const char* what, Framed& out) {
  out.error = fail(fault, at, requirement).error;
  out.packet.error = out.error;
  out.path.clear();
  out.numbers.clear();
  out.what = what;
}

}  // namespace

bool Framer::holds(const reflect::Route& route) const {
  if (is_bare(route)) return container_ == InputFormat::kHex || container_ == InputFormat::kJsonl;
  return !is_radio(route) || container_ == InputFormat::kPcapng ||
         container_ == InputFormat::kJsonl;
}

void Framer::around_serial(Framed& out) {
  const bool numbered = random_.chance(0.3);
  out.packet.framing = Framing::kHdlc;
  out.packet.kind = numbered ? kSerialPacketAck : kSerialPacketNoAck;
  out.packet.serial_seq = numbered ? any_byte(random_) : kAbsent;
  set_crc(out.bytes, out.packet);
}

void Framer::around_radio(Framed& out, bool fcs) {
  out.packet.link_type = fcs ? kLinkRadioFcs : kLinkRadioNoFcs;
  if (fcs) out.packet.fcs = fcs_fast(view(out.bytes));
}

Framed Framer::sound(Generated made) {
  Framed out = taken(std::move(made));
  const bool capture = container_ == InputFormat::kPcapng;
  if (out.packet.framing == Framing::kBare) return out;
  if (out.packet.framing == Framing::kRadio) {
    if (capture) around_radio(out, random_.chance(0.8));
  } else if (container_ == InputFormat::kHdlc || (capture && random_.chance(0.6))) {
    around_serial(out);
  } else if (capture) {
    out.packet.link_type = kLinkSf;
  }
  return out;
}

bool Framer::broken(Generated valid, bool last, Framed& out) {
  out = sound(std::move(valid));
  if (container_ == InputFormat::kHex || container_ == InputFormat::kJsonl) return false;
  switch (out.packet.framing) {
    case Framing::kHdlc: return break_hdlc(last && container_ == InputFormat::kHdlc, out);
    case Framing::kSf: return break_sf(last, out);
    case Framing::kRadio: return break_radio(out);
    case Framing::kBare: break;
  }
  return false;
}

// Makes `content` the frame between the flags. The error's offset counts from its first byte.
void Framer::serial_content(std::vector<std::uint8_t> content, Error error, const char* what,
                            Framed& out) {
  split_serial_content(view(content), out.packet);
  const Bytes bytes = out.packet.bytes;
  out.bytes.assign(bytes.begin(), bytes.end());
  out.packet.bytes = Bytes();
  set_fault(error.fault, error.offset_bytes, error.requirement, what, out);
  out.error.offset_bytes -= std::min(error.offset_bytes, head_of(out.packet));
}

void Framer::lengthen(std::size_t more_than, Framed& out) {
  const std::size_t size = more_than + 1 + random_.below(kExcessMost);
  while (out.bytes.size() < size) out.bytes.push_back(any_byte(random_));
}

bool Framer::break_hdlc(bool last, Framed& out) {
  const bool stream = container_ == InputFormat::kHdlc;
  std::vector<std::uint8_t> content = content_of(out);
  switch (last && random_.chance(0.5) ? 4 : random_.below(stream ? 4 : 3)) {
    case 0: {
      const std::size_t at = content.size() - 1 - random_.below(kSerialCrcBytes);
      content[at] ^= static_cast<std::uint8_t>(1u << random_.below(8));
      const std::size_t crc_at = content.size() - kSerialCrcBytes;
      serial_content(content, fail(Fault::kCrc, crc_at, "WIRE-SERIAL-CRC"_rule).error,
                     "the CRC is wrong", out);
      return true;
    }
    case 1:
      content.resize(1 + random_.below(kSerialContentMin - 1));
      serial_content(content, fail(Fault::kTooShort, content.size(), "WIRE-HDLC-SHORT"_rule).error,
                     "the frame is too short for a packet and its CRC", out);
      return true;
    case 2: {
      lengthen(kSerialAfterHeaderMax - kSerialCrcBytes, out);
      set_crc(out.bytes, out.packet);
      const std::size_t most = serial_content_max(out.packet.kind);
      serial_content(content_of(out), fail(Fault::kTooLong, most, "WIRE-HDLC-LONG"_rule).error,
                     "the frame is too long", out);
      return true;
    }
    case 3:
      content.resize(1 + random_.below(content.size()));
      serial_content(content, fail(Fault::kAborted, content.size(), "WIRE-HDLC-ESCAPE"_rule).error,
                     "the sender gave the frame up: an escape directly before the flag", out);
      return true;
    default:
      content.resize(1 + random_.below(content.size()));
      serial_content(content, fail(Fault::kCut, content.size(), "WIRE-HDLC-FLAG"_rule).error,
                     "the input ends without a flag", out);
      return true;
  }
}

bool Framer::break_sf(bool last, Framed& out) {
  const bool stream = container_ == InputFormat::kSf;
  if (stream && last) {
    // The length byte is one too large, or larger.
    const std::size_t size = out.bytes.size();
    const std::size_t most = std::min<std::size_t>(size, kSfPacketMax - size);
    const std::size_t lacks = random_.chance(0.5) ? 1 : 1 + random_.below(most);
    set_fault(Fault::kCut, size + 1, "WIRE-SF-LENGTH"_rule,
              "the length byte says more than there is", out);
    out.error.offset_bytes = static_cast<std::uint32_t>(size);
    out.packet.dropped_bytes = lacks;
    return true;
  }
  if (!stream && random_.chance(0.5)) {
    lengthen(kSfPacketMax, out);
    set_fault(Fault::kTooLong, kSfPacketMax, "WIRE-SF-LENGTH"_rule,
              "the packet is longer than a length byte can say", out);
    return true;
  }
  out.bytes.clear();
  set_fault(Fault::kEmpty, 0, "WIRE-SF-LENGTH"_rule, "the packet is empty: its length is 0", out);
  return true;
}

bool Framer::break_radio(Framed& out) {
  out.packet.fcs = kAbsent;
  around_radio(out, true);
  switch (random_.below(4)) {
    case 0:
      out.packet.fcs ^= 1 << random_.below(16);
      set_fault(Fault::kFcs, out.bytes.size(), "WIRE-RADIO-FCS"_rule, "the FCS is wrong", out);
      return true;
    case 1: {
      lengthen(kRadioFrameMax - kFcsBytes, out);
      around_radio(out, true);
      set_fault(Fault::kTooLong, kRadioFrameMax, "WIRE-RADIO-LENGTH"_rule, "the frame is too long",
                out);
      return true;
    }
    case 2:
      out.packet.fcs = kAbsent;
      out.bytes.resize(1);
      set_fault(Fault::kTooShort, 1, "WIRE-RADIO-FCS"_rule, "the frame is too short for its FCS",
                out);
      return true;
    default:
      out.packet.fcs = kAbsent;
      out.bytes.clear();
      set_fault(Fault::kEmpty, 0, "WIRE-RADIO-HEADER"_rule, "the frame is empty", out);
      return true;
  }
}

}  // namespace rubric::generate
