// Chooses the mutant of a program when it starts.
#include <cstdlib>

namespace {

int chosen() {
  const char* const number = std::getenv("RUBRIC_SOURCE_MUTANT");
  return number == nullptr ? 0 : std::atoi(number);
}

}  // namespace

extern "C" int rubric_source_mutant;
int rubric_source_mutant = chosen();
