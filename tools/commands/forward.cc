#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>

#include "codec/lines/forward/server.h"
#include "codec/lines/line.h"
#include "codec/text/text.h"
#include "conformance/test/runner/target.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/frame_filter.h"
#include "tools/cli/input.h"
#include "tools/cli/write_options.h"
#include "tools/commands/commands.h"

namespace rubric::tools {
namespace {

struct ForwardOptions {
  std::string source;
  std::uint64_t buffer_kib = 1024;
  std::uint32_t patience_s = 10;
  std::uint32_t ack_wait_ms = 1000;
  int retries = 24;  ///< TinyOS's Java host has the same.
  forward::ServerOptions server;
  cli::WriteOptions write;
  cli::InputOptions input;  ///< Its --spec alone.
  std::string filter;
};

lines::Address source_of(const std::string& given) {
  std::string name = given;
  if (name.empty() && std::getenv("MOTECOM") != nullptr) name = lines::default_address();
  if (name.empty()) throw cli::UsageError("SOURCE (or $MOTECOM) is required");
  try {
    return lines::required_address(name);
  } catch (const std::invalid_argument& error) {
    throw cli::UsageError("SOURCE", error.what());
  }
}

// Checks that the capture is no pipe: all clients wait while it is written, and a pipe may take
// nothing.
void check_capture(const std::string& path) {
  std::error_code none;
  const auto status = std::filesystem::status(path, none);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    throw cli::UsageError("--write", path + " is not a regular file");
  }
}

void print_summary(const std::string& source, const forward::Counts& counts) {
  text::print(stderr, "rubric: {}: {} packets from it ({} malformed frames), {} to it", source,
              counts.from_source, counts.malformed, counts.to_source);
  if (counts.withheld) text::print(stderr, ", {} not passed on", counts.withheld);
  if (counts.unconfirmed) text::print(stderr, ", {} not confirmed", counts.unconfirmed);
  if (counts.not_sent) text::print(stderr, ", {} not sent", counts.not_sent);
  text::print(stderr, "; {} clients, {} cut off", counts.served, counts.cut_off);
  if (counts.refused) text::print(stderr, ", {} refused", counts.refused);
  text::print(stderr, "\n");
}

int run_forward(ForwardOptions& options) {
  options.server.source.address = source_of(options.source);
  check_capture(options.write.path);
  cli::check_write(options.write, {options.source}, true);
  options.server.write = options.write.path;
  options.server.write_mode = options.write.growing();
  options.server.rotation = cli::rotation_of(options.write);
  options.server.source.link.ack_wait = lines::Milliseconds(options.ack_wait_ms);
  options.server.source.link.tries = 1 + options.retries;
  options.server.backlog_bytes = options.buffer_kib * 1024;
  cli::FrameFilter filter(options.filter, cli::chosen_protocol(options.input));
  std::uint64_t number = 0;
  if (!options.filter.empty()) {
    options.server.passes = [&](Bytes bytes) {
      Packet packet{.framing = Framing::kSf, .direction = Direction::kOutbound, .bytes = bytes};
      return filter.takes(packet, options.server.source.address.name, ++number);
    };
  }
  options.server.limits.patience = std::chrono::seconds(options.patience_s);
  try {
    forward::Server server(options.server);
    const bool whole = server.run();
    print_summary(options.server.source.address.name, server.counts());
    if (server.capture_failed()) return cli::kExitOutput;
    return whole ? cli::kExitClean : cli::kExitInput;
  } catch (const runner::TargetBroken& broken) {
    text::print(stderr, "rubric: {}\n", broken.what());
  } catch (const std::system_error& error) {
    text::print(stderr, "rubric: {}\n", error.what());
  }
  return cli::kExitInput;
}

void add_client_options(cli::Command& command, ForwardOptions& options) {
  command
      .add_option("--clients", options.server.clients_max,
                  "Serve at most this many at once; refuse others")
      .between(1, 10'000);
  command
      .add_option("--buffer", options.buffer_kib, "Cut off a client that is this many KiB behind")
      .between(64, 1 << 20);
  command
      .add_option("--patience", options.patience_s,
                  "Cut off a client that takes more seconds than this for its handshake, or to end "
                  "a packet")
      .between(1, 86'400);
}

void add_source_options(cli::Command& command, ForwardOptions& options) {
  command.add_flag("--reconnect", options.server.reconnect,
                   "Open a source again when it comes back; clients stay");
  command.add_flag("--listen-only", options.server.source.link.listen_only,
                   "Write nothing to a serial line; drop packets of clients");
  command
      .add_option("--timeout", options.ack_wait_ms,
                  "On a serial line, send an unconfirmed packet again after this many ms")
      .between(1, 3'600'000);
  command
      .add_option("--retries", options.retries,
                  "On a serial line, send it again at most this many times")
      .between(0, 10'000);
}

}  // namespace

void add_forward(cli::Command& app) {
  cli::Command& command = app.add_subcommand(
      "forward", "Serve a mote's serial line to many clients, as TinyOS's Serial Forwarder does");
  auto options = std::make_shared<ForwardOptions>();
  command.add_option("SOURCE", options->source,
                     "serial@DEVICE:BAUD (or a platform, as serial@/dev/ttyUSB0:telosb), "
                     "network@HOST:PORT or sf@HOST:PORT; without it, $MOTECOM");
  command.add_option("--port", options->server.port, "Listen on this port; 0: a free one")
      .between(0, 65'535);
  command.add_option("--bind", options->server.bind,
                     "Listen at this address; 0.0.0.0 or :: lets other hosts in");
  add_client_options(command, *options);
  add_source_options(command, *options);
  cli::add_write_options(command, options->write,
                         "Keep packets of both directions in this pcapng file, not a pipe", true);
  command.add_option("--filter", options->filter,
                     "Give clients only packets for which this holds, as in 'rubric decode'; "
                     "--write keeps all");
  cli::add_spec_option(command, options->input);
  command.add_flag("--verbose", options->server.verbose, "Say which clients come and leave");
  command.footer(
      "The first line on stdout says where it listens: 'listening on 127.0.0.1:9002'. Whoever\n"
      "can connect there reads all packets and can send to the motes.\n"
      "Examples:\n"
      "  rubric forward serial@/dev/ttyUSB0:telosb             # until Ctrl-C\n"
      "  rubric decode sf@localhost:9002                       # one of many clients\n"
      "  rubric forward sf@lab:9002 --port 9003 --reconnect --write run.pcapng\n"
      "Exit codes: 0 ended by Ctrl-C, 64 usage, 66 the source is gone or the port is taken,\n"
      "74 the capture cannot be written.");
  command.exit_code_of([options] { return run_forward(*options); });
}

}  // namespace rubric::tools
