// CRC-16 of the serial line and FCS of the radio for hosts, many bytes a step. Motes use
// codec/runtime/crc16.h, which gives the same results.
#pragma once

#include <cstdint>

#include "codec/containers/cpu.h"
#include "codec/runtime/bytes.h"

namespace rubric {

/// Returns the CRC-16/XMODEM of `bytes`, continued from `crc`, in plain C++.
std::uint16_t crc16_portable(Bytes bytes, std::uint16_t crc = 0);
/// Does the same by carry-less multiplication, 16 or 64 bytes at a time; only if cpu_has() the
/// path.
std::uint16_t crc16_vector(Bytes bytes, std::uint16_t crc = 0);
std::uint16_t crc16_wide(Bytes bytes, std::uint16_t crc = 0);
/// Does the same by the given `path`.
std::uint16_t crc16_fast(Bytes bytes, std::uint16_t crc = 0, CpuPath path = best_cpu_path());

/// Return the FCS of 802.15.4 (CRC-16 of ITU-T, reflected, initial value 0) in the same ways.
std::uint16_t fcs_portable(Bytes bytes);
std::uint16_t fcs_vector(Bytes bytes);
std::uint16_t fcs_fast(Bytes bytes, CpuPath path = best_cpu_path());

}  // namespace rubric
