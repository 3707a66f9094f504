// Numbers of the pcapng format that reader and writer share. Source: draft-ietf-opsawg-pcapng.
#pragma once

#include <cstddef>
#include <cstdint>

#include "codec/runtime/bytes.h"

namespace rubric::pcapng {

// Block types.
inline constexpr std::uint32_t kSectionHeader = 0x0A0D0D0A;  // The same in both byte orders.
inline constexpr std::uint32_t kInterfaceDescription = 1;
inline constexpr std::uint32_t kObsoletePacket = 2;
inline constexpr std::uint32_t kSimplePacket = 3;
inline constexpr std::uint32_t kInterfaceStatistics = 5;
inline constexpr std::uint32_t kEnhancedPacket = 6;

inline constexpr std::uint32_t kByteOrderMagic = 0x1A2B3C4D;
inline constexpr std::uint16_t kMajorVersion = 1;

// Sizes in bytes, type and both lengths included unless noted.
inline constexpr std::size_t kBlockMin = 12;
inline constexpr std::size_t kBlockTrailerBytes = 4;
inline constexpr std::size_t kSectionHeaderMin = 28;
inline constexpr std::size_t kInterfaceMin = 20;
inline constexpr std::size_t kSimplePacketFixed = 12;    // Before the data.
inline constexpr std::size_t kEnhancedPacketFixed = 28;  // Before the data; obsolete ones alike.

// Option codes.
inline constexpr std::uint16_t kOptEnd = 0;
inline constexpr std::uint16_t kOptComment = 1;
inline constexpr std::uint16_t kOptPacketFlags = 2;
inline constexpr std::uint16_t kOptIfName = 2;
inline constexpr std::uint16_t kOptIfTsresol = 9;
inline constexpr std::uint16_t kOptIfTsoffset = 14;
inline constexpr std::uint16_t kOptShbUserAppl = 4;
inline constexpr std::uint16_t kOptIsbStartTime = 2;
inline constexpr std::uint16_t kOptIsbEndTime = 3;
inline constexpr std::uint16_t kOptIsbIfRecv = 4;

inline constexpr std::uint32_t kDirectionMask = 3;
inline constexpr std::uint32_t kDirectionInbound = 1;
inline constexpr std::uint32_t kDirectionOutbound = 2;

/// Where the data of the last packet begins in a file that was just written, little-endian as here.
inline std::size_t last_data_at(Bytes file) {
  return file.size() - load_le32(file.end() - kBlockTrailerBytes) + kEnhancedPacketFixed;
}

}  // namespace rubric::pcapng
