// Runs the golden traces on mutants of an implementation, one by one in a process of its own, each
// until the first trace that it does not pass.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "conformance/selftest/source_mutants/machine.h"
#include "conformance/test/runner/case_files.h"
#include "conformance/test/runner/run_case.h"
#include "conformance/test/runner/subject_target.h"
#include "conformance/test/targets/attachment.h"

namespace rubric::source_mutants {
namespace {

using runner::CaseVerdict;

constexpr rlim_t kCpuSeconds = 10;  // For all traces, in this process.
constexpr unsigned kWallSeconds = 120;
constexpr std::chrono::seconds kStepTimeout{5};
constexpr int kKilled = 1;
constexpr int kBroken = 2;

struct Case {
  const trace::Parsed* file;
  const trace::Case* one;
};

// The machine of the shared library.
class MutatedMachine : public runner::Subject {
 public:
  explicit MutatedMachine(const MachineFunctions& functions) : functions_(functions) {}
  void start(const machine::Config& config) override { state_ = functions_.start(config); }
  void step(machine::Ticks now, const machine::Event& event, machine::Actions& actions) override {
    functions_.step(state_, now, event, actions);
  }
  runner::DueTimers timers() const override { return functions_.timers(state_); }

 private:
  const MachineFunctions& functions_;
  machine::State state_;
};

const MachineFunctions& load_machine(const std::string& library) {
  void* const handle = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* const get = handle == nullptr ? nullptr : dlsym(handle, "rubric_mutated_machine");
  if (get == nullptr) throw std::runtime_error(dlerror());
  return *reinterpret_cast<GetMachine>(get)();
}

struct Wanted {
  std::string machine;
  std::string target;
  std::string cases;
  std::vector<std::string> mutants;
};

// Opens the implementation with this mutant, and hands what makes its nodes to `use`.
template <class Use>
void with_mutant(const Wanted& wanted, int mutant, Use use) {
  if (!wanted.machine.empty()) {
    const MachineFunctions& functions = load_machine(wanted.machine);
    functions.choose(mutant);
    return use([&](const trace::NodeHeader&) {
      return std::make_unique<runner::SubjectTarget>(std::make_unique<MutatedMachine>(functions));
    });
  }
  setenv("RUBRIC_SOURCE_MUTANT", std::to_string(mutant).c_str(), 1);
  targets::Options options{.step_timeout = kStepTimeout};
  const auto attachment = targets::attach(wanted.target, options);
  use([&](const trace::NodeHeader&) { return attachment->target(); });
}

// Returns the cases that it passes without a mutant: no other can tell a mutant from it. Those with
// other roles it skips.
std::vector<Case> passed_cases(const Wanted& wanted, const std::vector<trace::Parsed>& files) {
  std::vector<Case> out;
  with_mutant(wanted, 0, [&](const runner::TargetFactory& make) {
    for (const trace::Parsed& file : files) {
      for (const trace::Case& one : file.file.cases) {
        const runner::CaseResult result = runner::run_case(file.file, one, make);
        if (result.verdict == CaseVerdict::kPass) {
          out.push_back({&file, &one});
        } else if (result.verdict != CaseVerdict::kSkip) {
          throw std::runtime_error("without a mutant it does not pass\n" +
                                   runner::explain(result, file.file_name) + result.reason);
        }
      }
    }
  });
  if (out.empty()) throw std::runtime_error("without a mutant it passes no case");
  return out;
}

// In a process of its own: writes the number of each case that it begins, and ends with kKilled
// after the first that the mutant does not pass.
[[noreturn]] void try_mutant(const Wanted& wanted, int mutant, const std::vector<Case>& cases,
                             int out) {
  const rlimit limit{kCpuSeconds, kCpuSeconds};
  setrlimit(RLIMIT_CPU, &limit);
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  alarm(kWallSeconds);
  std::freopen("/dev/null", "w", stderr);  // What an assertion says.
  int code = 0;
  try {
    with_mutant(wanted, mutant, [&](const runner::TargetFactory& make) {
      for (std::size_t i = 0; i < cases.size() && code == 0; ++i) {
        if (write(out, &i, sizeof i) != sizeof i) _exit(kBroken);
        const auto result = runner::run_case(cases[i].file->file, *cases[i].one, make);
        if (result.verdict != CaseVerdict::kPass) code = kKilled;
      }
    });
  } catch (const std::exception&) {
    code = kKilled;
  }
  _exit(code);
}

// Returns the number of the case that a process began last; it has ended then.
std::size_t last_begun(int in) {
  std::size_t last = 0;
  for (std::size_t i = 0; read(in, &i, sizeof i) == sizeof i;) last = i;
  return last;
}

std::string verdict_of(int status) {
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return "survived";
  if (WIFEXITED(status) && WEXITSTATUS(status) == kKilled) return "killed";
  if (!WIFSIGNALED(status)) throw std::runtime_error("a trial broke");
  const int signal = WTERMSIG(status);
  return signal == SIGALRM || signal == SIGXCPU || signal == SIGKILL ? "hung" : "crashed";
}

int run(const Wanted& wanted) {
  const std::vector<trace::Parsed> files = runner::load_cases(wanted.cases);
  std::vector<Case> cases = passed_cases(wanted, files);
  std::printf("cases %zu\n", cases.size());
  for (const std::string& number : wanted.mutants) {
    const int mutant = std::stoi(number);
    std::fflush(stdout);
    int ends[2];
    if (pipe(ends) != 0) throw std::runtime_error("no pipe");
    const pid_t child = fork();
    if (child < 0) throw std::runtime_error("no process");
    if (child == 0) {
      close(ends[0]);
      fcntl(ends[1], F_SETFD, FD_CLOEXEC);
      try_mutant(wanted, mutant, cases, ends[1]);
    }
    close(ends[1]);
    const std::size_t last = last_begun(ends[0]);
    close(ends[0]);
    int status = 0;
    waitpid(child, &status, 0);
    const std::string verdict = verdict_of(status);
    const auto killer = cases.begin() + static_cast<std::ptrdiff_t>(last);
    std::printf("%d %s %s\n", mutant, verdict.c_str(),
                verdict == "survived" ? "-" : killer->one->name.c_str());
    // It is likely to find the next one, too.
    if (verdict != "survived") std::rotate(cases.begin(), killer, killer + 1);
  }
  return 0;
}

}  // namespace
}  // namespace rubric::source_mutants

// Usage: source_mutants_run TARGET CASES NUMBER ...
// TARGET is the shared library with the machine's mutants, machine:FILE, or a command that uses
// rct/1 and reads RUBRIC_SOURCE_MUTANT. Prints the number of cases, and for each mutant whether it
// survived, or was killed, crashed or hung, and in which case.
int main(int argc, char** argv) {
  using rubric::source_mutants::Wanted;
  if (argc < 3) return 64;
  const std::string target = argv[1];
  const std::string machine = "machine:";
  const bool here = target.starts_with(machine);
  const Wanted wanted{here ? target.substr(machine.size()) : "",
                      here ? "" : target,
                      argv[2],
                      {argv + 3, argv + argc}};
  try {
    return rubric::source_mutants::run(wanted);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "source_mutants_run: %s\n", error.what());
    return 2;
  }
}
