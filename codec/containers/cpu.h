// Which of the implementations of the hot loops runs.
#pragma once

#include <cstdint>

namespace rubric {

enum class CpuPath : std::uint8_t {
  kPortable,  ///< Plain C++ (SSE2 where the target always has it).
  kVector,    ///< AVX2 and PCLMULQDQ.
  kWide,      ///< AVX-512 and VPCLMULQDQ.
};

/// Whether this processor can run it.
bool cpu_has(CpuPath path);

/// The fastest path of this processor, found out once.
CpuPath best_cpu_path();

}  // namespace rubric
