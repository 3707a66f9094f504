// Selects the implementation of the hot loops.
#pragma once

#include <cstdint>

namespace rubric {

enum class CpuPath : std::uint8_t {
  kPortable,  ///< Plain C++ (SSE2 where the target always has it).
  kVector,    ///< AVX2 and PCLMULQDQ.
  kWide,      ///< AVX-512 and VPCLMULQDQ.
};

/// Returns whether this processor can run it.
bool cpu_has(CpuPath path);

/// Returns the fastest path of this processor, determined once.
CpuPath best_cpu_path();

}  // namespace rubric
