// Property: whatever happens to a node of the reference machine, it keeps the explorer's promises
// and its own bounds, names its rules, and does the same again.
//
// RUBRIC_FLAW names a flaw of conformance/machine/flaws that replaces the machine: this must be
// found.
#include <cstdlib>

#include "conformance/selftest/scripts/bytes.h"
#include "conformance/selftest/scripts/watch.h"
#include "fuzz/support/require.h"

namespace {

rubric::flaws::StepFunction chosen_step() {
  const char* name = std::getenv("RUBRIC_FLAW");
  if (name == nullptr || *name == '\0') return rubric::machine::step;
  const rubric::flaws::Flaw* flaw = rubric::flaws::find(name);
  rubric::fuzz::require(flaw != nullptr, "RUBRIC_FLAW names a flaw");
  return flaw->step;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rubric;
  static const flaws::StepFunction step = chosen_step();
  const auto broken = script::watch(script::decode(Bytes(data, size)), step);
  if (broken) fuzz::require(false, broken->text().c_str());
  return 0;
}
