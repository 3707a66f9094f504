// Compiled, never linked: shows that the runtime needs neither heap, exceptions nor a C++ library.
#include "codec/runtime/bytes.h"
#include "codec/runtime/crc16.h"
#include "codec/runtime/hdlc.h"
#include "codec/runtime/ieee802154_fcs.h"
#include "codec/runtime/result.h"

namespace rubric {

constexpr uint8_t kCheck[] = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};
static_assert(crc16(kCheck) == 0x31C3, "CRC-16/XMODEM check value");
static_assert(fcs(kCheck) == 0x2189, "ITU-T CRC-16 check value");

uint16_t use_framer(Bytes packet, MutableBytes out) {
  const Result<size_t> size = write_serial_packet(packet, out);
  return size.has_value() ? static_cast<uint16_t>(*size) : 0;
}

bool use_deframer(HdlcDeframer& deframer, uint8_t byte) {
  return deframer.push(byte) == HdlcEvent::kFrame && !deframer.content().empty();
}

}  // namespace rubric
