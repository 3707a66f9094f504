// rubric: the command line. A subcommand is one file, which adds itself.
#include <CLI/CLI.hpp>
#include <csignal>
#include <exception>

#include "tools/cli/exit_codes.h"
#include "tools/cli/usage.h"
#if __has_include("tools/convert.h")
#include "tools/convert.h"
#define RUBRIC_HAS_CONVERT
#endif
#include "tools/decode.h"
#if __has_include("tools/encode.h")
#include "tools/encode.h"
#define RUBRIC_HAS_ENCODE
#endif
#if __has_include("tools/explain.h")
#include "tools/explain.h"
#define RUBRIC_HAS_EXPLAIN
#endif
#if __has_include("tools/messages.h")
#include "tools/messages.h"
#define RUBRIC_HAS_MESSAGES
#endif
#if __has_include("tools/stats.h")
#include "tools/stats.h"
#define RUBRIC_HAS_STATS
#endif

namespace {

constexpr const char* kFooter =
    "Exit codes: 0 clean, 1 something malformed was found, 2 usage, 3 input cannot be read or\n"
    "output cannot be written. 'rubric COMMAND --help' says more.";

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
#ifdef RUBRIC_HAS_ENCODE
  rubric::tools::add_encode(app);
#endif
#ifdef RUBRIC_HAS_CONVERT
  rubric::tools::add_convert(app);
#endif
#ifdef RUBRIC_HAS_STATS
  rubric::tools::add_stats(app);
#endif
#ifdef RUBRIC_HAS_EXPLAIN
  rubric::tools::add_explain(app);
#endif
#ifdef RUBRIC_HAS_MESSAGES
  rubric::tools::add_messages(app);
#endif
  return rubric::cli::parse_and_run(app, argc, argv);
}
