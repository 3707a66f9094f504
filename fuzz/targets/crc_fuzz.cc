// Property: every way to sum a frame, from any state, whole or split anywhere, at any alignment,
// equals division by the polynomial bit by bit.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "codec/containers/crc16_fast.h"
#include "codec/runtime/crc16.h"
#include "codec/runtime/ieee802154_fcs.h"
#include "fuzz/support/input.h"
#include "fuzz/support/require.h"
#include "fuzz/support/sums.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rubric;
  using fuzz::require;
  fuzz::Input input(data, size);
  const std::size_t alignment = input.below(64);
  const std::uint16_t start = input.u16();
  const std::size_t cut = input.u16();
  const Bytes given = input.rest();
  // The frame ends where the block does: sanitizers see a byte read after it.
  std::vector<std::uint8_t> block(alignment);
  block.insert(block.end(), given.begin(), given.end());
  const std::vector<std::uint8_t> exact(block.begin(), block.end());
  const Bytes bytes = Bytes(exact.data(), exact.size()).from(alignment);
  const std::size_t split = bytes.empty() ? 0 : cut % (bytes.size() + 1);

  const std::uint16_t crc = fuzz::crc_by_definition(bytes, start);
  const std::uint16_t sum = fuzz::fcs_by_definition(bytes);
  require(crc16(bytes, start) == crc, "the mote's CRC is the polynomial's");
  require(fcs(bytes) == sum, "the mote's FCS is the polynomial's");
  require(fcs(bytes.from(split), fcs(bytes.first(split))) == sum, "an FCS goes on");
  for (const CpuPath path : {CpuPath::kPortable, CpuPath::kVector, CpuPath::kWide}) {
    if (!cpu_has(path)) continue;
    require(crc16_fast(bytes, start, path) == crc, "the host's CRC is the mote's");
    const std::uint16_t first = crc16_fast(bytes.first(split), start, path);
    require(crc16_fast(bytes.from(split), first, path) == crc, "a CRC goes on");
    require(fcs_fast(bytes, path) == sum, "the host's FCS is the mote's");
  }
  return 0;
}
