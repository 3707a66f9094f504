// rubric: the command line. A subcommand is one file, which adds itself.
#include <CLI/CLI.hpp>
#include <csignal>

#include "tools/chart.h"
#include "tools/check.h"
#include "tools/cli/usage.h"
#include "tools/completion.h"
#include "tools/convert.h"
#include "tools/coverage.h"
#include "tools/decode.h"
#include "tools/diff.h"
#include "tools/encode.h"
#include "tools/explain.h"
#include "tools/explore.h"
#include "tools/forward.h"
#include "tools/generate.h"
#include "tools/install_wireshark.h"
#include "tools/messages.h"
#include "tools/new_adapter.h"
#include "tools/repro.h"
#include "tools/send.h"
#include "tools/shrink.h"
#include "tools/simulate.h"
#include "tools/stats.h"
#include "tools/test.h"

namespace {

constexpr const char* kFooter =
    "Exit codes: 0 clean, 1 something malformed was found, 2 usage, 3 input cannot be read or\n"
    "output cannot be written, 4 not sent; check, test, chart, explore and coverage have others.\n"
    "'rubric COMMAND --help' says more.";

}  // namespace

int main(int argc, char** argv) {
  // A closed pipe shows as a failed write, which ends the output quietly.
  std::signal(SIGPIPE, SIG_IGN);
  CLI::App app{"Codec and conformance test kit for the RUBICON Communication Layer."};
  app.name("rubric");
  app.set_version_flag("--version", RUBRIC_VERSION);
  app.require_subcommand(1);
  app.footer(kFooter);
  rubric::tools::add_decode(app);
  rubric::tools::add_encode(app);
  rubric::tools::add_convert(app);
  rubric::tools::add_stats(app);
  rubric::tools::add_explain(app);
  rubric::tools::add_messages(app);
  rubric::tools::add_send(app);
  rubric::tools::add_forward(app);
  rubric::tools::add_install_wireshark(app);
  rubric::tools::add_check(app);
  rubric::tools::add_test(app);
  rubric::tools::add_new_adapter(app);
  rubric::tools::add_shrink(app);
  rubric::tools::add_diff(app);
  rubric::tools::add_chart(app);
  rubric::tools::add_simulate(app);
  rubric::tools::add_explore(app);
  rubric::tools::add_coverage(app);
  rubric::tools::add_generate(app);
  rubric::tools::add_repro(app);
  rubric::tools::add_completion(app);
  return rubric::cli::parse_and_run(app, argc, argv);
}
