#include "codec/containers/crc16_fast.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <random>
#include <vector>

#include "codec/containers/tests/testing.h"
#include "codec/runtime/crc16.h"
#include "codec/runtime/ieee802154_fcs.h"

namespace rubric {
namespace {

using testing::kPaths;

TEST(WireSerialCrc, EveryPathAtEveryLengthAndAlignment) {
  std::mt19937 random(31);
  std::vector<std::uint8_t> data(64 + 1200);
  for (std::uint8_t& byte : data) byte = static_cast<std::uint8_t>(random());
  int compared = 0;
  for (CpuPath path : kPaths) {
    if (!cpu_has(path)) continue;
    for (std::size_t size = 0; size <= 1200; ++size) {
      const Bytes bytes(data.data() + random() % 64, size);
      const auto start = static_cast<std::uint16_t>(random());
      ASSERT_EQ(crc16_fast(bytes, 0, path), crc16(bytes)) << size;
      ASSERT_EQ(crc16_fast(bytes, start, path), crc16(bytes, start)) << size;
      ASSERT_EQ(fcs_fast(bytes, path), fcs(bytes)) << size;
      ++compared;
    }
  }
  RecordProperty("lengths", compared);
}

// The input at the very end of a heap block: sanitizers see any byte read beyond it.
RC_GTEST_PROP(WireSerialCrc, ReadsNothingBeyondItsInput, (const std::vector<std::uint8_t>& data)) {
  const std::vector<std::uint8_t> exact(data.begin(), data.end());
  const Bytes bytes(exact.data(), exact.size());
  for (CpuPath path : kPaths) {
    if (!cpu_has(path)) continue;
    RC_ASSERT(crc16_fast(bytes, 0, path) == crc16(bytes));
    RC_ASSERT(fcs_fast(bytes, path) == fcs(bytes));
  }
}

RC_GTEST_PROP(WireSerialCrc, GoesOnFromAnyState,
              (const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b)) {
  std::vector<std::uint8_t> both = a;
  both.insert(both.end(), b.begin(), b.end());
  for (CpuPath path : kPaths) {
    if (!cpu_has(path)) continue;
    const std::uint16_t first = crc16_fast(Bytes(a.data(), a.size()), 0, path);
    RC_ASSERT(crc16_fast(Bytes(b.data(), b.size()), first, path) ==
              crc16(Bytes(both.data(), both.size())));
  }
}

}  // namespace
}  // namespace rubric
