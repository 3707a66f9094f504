// rubric-extcap: called by Wireshark, which captures with it. extcap(4) says how.
#include <fmt/format.h>

#include <csignal>
#include <cstdio>
#include <string>
#include <vector>

#include "codec/lines/line.h"
#include "tools/cli/command.h"
#include "tools/cli/exit_codes.h"
#include "tools/wireshark/extcap/capture.h"
#include "tools/wireshark/extcap/command_line.h"
#include "tools/wireshark/extcap/sentences.h"

namespace rubric::extcap {
namespace {

int answer(const std::string& text) {
  fmt::print("{}", text);
  return std::fflush(stdout) == 0 ? cli::kExitClean : cli::kExitInput;
}

int complain(const std::string& what) {
  fmt::print(stderr, "rubric-extcap: {}\nTry 'rubric-extcap --help'.\n", what);
  return cli::kExitUsage;
}

/// Returns whether `--listen-only` or `--listen-only=true` is given.
bool flag(const CommandLine& line, std::string_view name) {
  return line.has(name) && line.value(name) != "false";
}

int start(const CommandLine& line) {
  CaptureOptions options;
  options.fifo = line.value("--fifo");
  options.source = line.value("--other-source");
  if (options.source.empty()) options.source = line.value("--source");
  if (options.source.empty()) options.source = lines::default_address();
  options.filter = line.value("--extcap-capture-filter");
  options.spec = line.value("--spec", kDefaultSpec);
  options.listen_only = flag(line, "--listen-only");
  options.reconnect = flag(line, "--reconnect");
  return capture(options);
}

/// Checks a filter. Wireshark asks for that without --capture, and takes every output for a no.
int judge_filter(const CommandLine& line) {
  const std::string error =
      filter_error(line.value("--extcap-capture-filter"), line.value("--spec", kDefaultSpec));
  if (error.empty()) return cli::kExitClean;
  answer(error + "\n");
  return cli::kExitUsage;
}

int run(const CommandLine& line) {
  if (line.has("--help")) return answer(help_text());
  if (line.has("--version")) return answer(RUBRIC_VERSION "\n");
  if (!line.unfinished().empty()) return complain(line.unfinished() + " needs a value");
  if (line.has("--extcap-interfaces")) return answer(interfaces());
  const std::string interface = line.value("--extcap-interface", kInterface);
  if (interface != kInterface) {
    return complain(fmt::format("unknown interface '{}'; there is '{}'", interface, kInterface));
  }
  if (line.has("--extcap-dlts")) return answer(link_types());
  if (line.has("--extcap-config")) return answer(config(line.value("--extcap-reload-option")));
  if (line.has("--capture")) return start(line);
  if (line.has("--extcap-capture-filter")) return judge_filter(line);
  return complain(
      "nothing to do: one of --extcap-interfaces, --extcap-dlts, --extcap-config, "
      "--extcap-capture-filter, --capture is needed");
}

}  // namespace
}  // namespace rubric::extcap

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);  // A closed pipe shows as a failed write.
  try {
    return rubric::extcap::run(
        rubric::extcap::CommandLine(std::vector<std::string>(argv + 1, argv + argc)));
  } catch (const rubric::cli::Ending& error) {
    return rubric::extcap::complain(error.what());
  }
}
