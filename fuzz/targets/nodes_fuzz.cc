// Property: on the same inputs the reference machine and the independent C++ node do the same,
// except where the rules leave a choice (conformance/selftest/scripts/README.md).
#include <cstddef>
#include <cstdint>

#include "conformance/selftest/scripts/bytes.h"
#include "conformance/selftest/scripts/difference.h"
#include "conformance/trace/check.h"
#include "fuzz/support/require.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rubric;
  const script::Difference difference = script::difference(script::decode(Bytes(data, size)));
  fuzz::require(difference.text.empty(), difference.text.c_str());
  const bool made = !difference.file.cases.empty();  // They did not do the very same.
  fuzz::require(!made || trace::check(difference.file).empty(), "the expectation is a good trace");
  return 0;
}
