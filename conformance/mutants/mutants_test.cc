// The golden traces find every broken machine.
#include <gtest/gtest.h>

#include <set>
#include <thread>

#include "conformance/mutants/hunt.h"

namespace rubric::mutants {
namespace {

const Golden& golden() {
  static const Golden cases("conformance/cases");
  return cases;
}

unsigned threads() { return std::max(1U, std::min(4U, std::thread::hardware_concurrency())); }

TEST(Mutants, NamedOnesAreFoundByTheirRule) {
  const Mutants mutants = named_mutants();
  const std::vector<Found> found = hunt_all(golden(), mutants, threads());
  std::size_t killed = 0;
  for (std::size_t i = 0; i < mutants.size(); ++i) {
    killed += found[i].killed;
    EXPECT_TRUE(found[i].killed) << mutants[i].name << ": " << mutants[i].breaks;
    EXPECT_TRUE(!found[i].killed || found[i].named)
        << mutants[i].name << " is found, but not by a rule of its own:\n" << found[i].lines;
  }
  std::printf("%zu of %zu\n", killed, mutants.size());
}

}  // namespace
}  // namespace rubric::mutants
