#include <cstdio>
#include <memory>
#include <string>

#include "codec/text/text.h"
#include "conformance/explore/counterexample.h"
#include "conformance/selftest/scripts/bytes.h"
#include "conformance/selftest/scripts/difference.h"
#include "conformance/selftest/scripts/rtr.h"
#include "conformance/selftest/scripts/walk.h"
#include "conformance/selftest/scripts/watch.h"
#include "conformance/test/runner/subject_target.h"
#include "conformance/trace/print.h"
#include "tools/cli/command.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/output.h"
#include "tools/cli/verdict.h"
#include "tools/commands/commands.h"

namespace rubric::tools {
namespace {

struct ReproOptions {
  std::string fuzzer;
  std::string input;
  std::string target = "machine";
  std::string out = "-";
  bool exact = false;
};

constexpr const char* kReproFooter =
    "The trace gives a node the stimuli of the input and expects what the reference machine does;\n"
    "for machine:FLAW it names the property that breaks. A trace from nodes_fuzz leaves every\n"
    "implementation its freedom, and says where the two nodes differ.\n"
    "Examples:\n"
    "  rubric repro machine crash-1f0c --out crash.rtr\n"
    "  rubric repro machine crash-22ab --target machine:no_fail --out no_fail.rtr\n"
    "  rubric test --target machine:no_fail no_fail.rtr\n"
    "  rubric repro network crash-07d1 --out network.rtr\n"
    "Exit codes: 0 nothing is broken, 1 something is, 64 usage, 74 the trace cannot be written,\n"
    "66 the input cannot be read.";

// The output, with the broken promise or nothing.
struct Repro {
  trace::File file;
  std::string found;
};

flaws::StepFunction step_of(const std::string& target) {
  if (target == "machine") return machine::step;
  for (const flaws::Flaw& one : flaws::all()) {
    if (target == std::string("machine:") + one.name) return one.step;
  }
  throw cli::UsageError("--target " + target +
                        ": expected machine or machine:FLAW, as rubric explore lists them");
}

Repro repro_machine(Bytes bytes, const ReproOptions& options) {
  const flaws::StepFunction step = step_of(options.target);
  const script::Script input = script::decode(bytes);
  const auto broken = script::watch(input, step);
  const script::Script script = options.exact ? input : script::without_guesses(input);
  runner::SubjectTarget reference(std::make_unique<runner::Machine>());
  const script::Played played = script::play(script, reference);
  script::Title title{"repro.run", {}, {}};
  if (broken) {
    title.case_name = "repro." + broken->name;
    title.comments = {"Broken by " + options.target + ": " + broken->text()};
    title.rules = broken->requirements;
  }
  return {options.exact ? script::to_file(script, played, title)
                        : script::lenient_file(script, played, title),
          broken ? broken->text() : ""};
}

Repro repro_nodes(Bytes bytes) {
  const script::Script script = script::decode(bytes);
  const script::Difference difference = script::difference(script);
  return {difference.file, difference.text};
}

Repro repro_network(Bytes bytes, const ReproOptions& options) {
  const explore::Options network =
      script::walk_options(script::walk_scope(bytes), step_of(options.target));
  const auto nodes = std::make_unique<explore::Nodes>(network);
  const explore::Path path = script::walk(*nodes, bytes);
  std::string found;
  std::string name = "repro.walk";
  for (const explore::PropertyInfo& property : explore::properties()) {
    if ((path.violated & explore::bit(property.property)) == 0) continue;
    if (found.empty()) name = std::string("repro.") + property.name;
    found += (found.empty() ? "" : "; ") + std::string(property.name) + ": " + property.sentence;
  }
  return {explore::counterexample(*nodes, path, {"paper", name, ""}), found};
}

void run_repro(const ReproOptions& options) {
  cli::keep_apart("--out", options.out, {options.input});
  const std::string text = cli::text_of_file(options.input);
  const Bytes bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  const Repro repro = options.fuzzer == "network" ? repro_network(bytes, options)
                      : options.fuzzer == "nodes" ? repro_nodes(bytes)
                                                  : repro_machine(bytes, options);
  if (!cli::write_file(options.out, trace::print(repro.file))) cli::exit_with(cli::kExitOutput);
  // A difference of two nodes has several lines.
  text::print_harmless(
      stderr, repro.found.empty() ? "nothing is broken\n" : "broken: " + repro.found + '\n');
  if (!repro.found.empty()) cli::exit_with(cli::kExitFindings);
}

}  // namespace

void add_repro(cli::Command& app) {
  auto options = std::make_shared<ReproOptions>();
  cli::Command& sub =
      app.add_subcommand("repro", "Write an input of a stateful fuzz target as a trace");
  sub.footer(kReproFooter);
  sub.add_option("FUZZER", options->fuzzer, "The fuzz target whose input it is")
      .required()
      .one_of({"machine", "nodes", "network"});
  sub.add_option("FILE", options->input, "The input; - is stdin").required();
  sub.add_option("--target", options->target, "Run machine, or machine:FLAW");
  sub.add_flag("--exact", options->exact,
               "Expect the machine's own numbers and bytes, not only what the rules ask for");
  sub.add_option("-o,--out", options->out, "Write the trace to this file; - is stdout");
  sub.callback([options] { run_repro(*options); });
}

}  // namespace rubric::tools
