#include "tools/format/record.h"

#include "codec/generated/tinyos/am_header.h"
#include "codec/generated/tinyos/tables.h"
#include "codec/reflect/decode.h"

namespace rubric::format {
namespace {

const reflect::EnumTable* find_enum(const reflect::Protocol& protocol, std::string_view name) {
  for (int i = 0; i < protocol.enum_count; ++i) {
    if (name == protocol.enums[i]->name) return protocol.enums[i];
  }
  return nullptr;
}

}  // namespace

std::string_view framing_name(Framing framing) {
  switch (framing) {
    case Framing::kHdlc: return "hdlc";
    case Framing::kSf: return "sf";
    case Framing::kRadio: return "radio";
    case Framing::kBare: break;
  }
  return "bare";
}

std::string_view direction_name(Direction direction) {
  switch (direction) {
    case Direction::kInbound: return "inbound";
    case Direction::kOutbound: return "outbound";
    case Direction::kUnknown: break;
  }
  return {};
}

std::string_view serial_kind_name(std::int32_t kind) {
  static const reflect::EnumTable* const kKinds =
      find_enum(tinyos::tables::kProtocol, "serial_kind");
  const char* name = kKinds ? reflect::enum_name(*kKinds, kind) : nullptr;
  return name ? name : std::string_view{};
}

std::int32_t dispatch_of(const Packet& packet) {
  const bool serial = packet.framing == Framing::kHdlc || packet.framing == Framing::kSf;
  using At = tinyos::AmHeaderLayout::DispatchAt;
  return serial && packet.bytes.size() >= At::kEnd ? packet.bytes[At::kAt] : kAbsent;
}

std::int32_t network_of(const reflect::Frame& frame) {
  return frame.mac.has_network ? frame.mac.network : kAbsent;
}

}  // namespace rubric::format
