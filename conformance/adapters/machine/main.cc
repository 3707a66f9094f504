// The reference machine behind rct/1, or a broken or unusual one: a first implementation to attach,
// and a subject to try a suite on.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>

#include "conformance/selftest/mutants/hunt.h"
#include "conformance/test/runner/subject_target.h"
#include "conformance/test/targets/serve.h"
#include "tools/cli/command.h"

namespace rubric {
namespace {

struct Which {
  std::string mutant;
  std::string lawful;
  std::string cases;
};

template <class All>
mutants::StepMaker find(const All& all, const std::string& name) {
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.name == name; });
  return found == all.end() ? mutants::StepMaker() : found->step;
}

std::unique_ptr<runner::Subject> make_subject(const Which& which) {
  if (which.mutant.empty() && which.lawful.empty()) return std::make_unique<runner::Machine>();
  mutants::StepMaker step = which.mutant.empty() ? find(mutants::lawful_variants(), which.lawful)
                                                 : find(mutants::named_mutants(), which.mutant);
  if (!step && !which.mutant.empty() && !which.cases.empty()) {
    step = find(mutants::generated_mutants(mutants::Golden(which.cases)), which.mutant);
  }
  if (!step) throw std::runtime_error("no machine is called " + which.mutant + which.lawful);
  return std::make_unique<mutants::Wrapped>(step);
}

int run(const Which& which) {
  targets::Identity identity = targets::machine_identity();
  if (!which.mutant.empty() || !which.lawful.empty()) {
    identity.name = "broken_or_unusual";
    identity.version = which.mutant + which.lawful;
    std::replace(identity.version.begin(), identity.version.end(), ' ', '_');
  }
  runner::SubjectTarget target(make_subject(which));
  return targets::serve(target, identity, stdin, stdout);
}

}  // namespace
}  // namespace rubric

int main(int argc, char** argv) {
  rubric::cli::Command program(
      "rubric_machine_adapter",
      "Run the reference machine as an adapter: rct/1 on standard input and output.");
  rubric::Which which;
  const auto mutant =
      program.add_option("--mutant", which.mutant, "Run the broken machine of this name");
  program.add_option("--lawful", which.lawful, "Run the unusual but lawful machine of this name")
      .excludes(mutant);
  program.add_option("--cases", which.cases,
                     "Read these golden traces, so that --mutant can name a mutant made from them");
  program.exit_code_of([&] {
    try {
      return rubric::run(which);
    } catch (const std::exception& error) {
      std::fprintf(stderr, "rubric_machine_adapter: %s\n", error.what());
      return 64;
    }
  });
  return program.parse_and_run(argc, argv);
}
