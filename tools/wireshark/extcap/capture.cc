#include "tools/wireshark/extcap/capture.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <system_error>

#include "codec/lines/capture_file.h"
#include "codec/lines/line.h"
#include "codec/lines/stop.h"
#include "codec/reflect/frame.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/input.h"
#include "tools/format/filter.h"

namespace rubric::extcap {
namespace {

cli::InputOptions input_of(const CaptureOptions& options) {
  cli::InputOptions input;
  input.files = {options.source};
  input.spec = options.spec;
  input.listen_only = options.listen_only;
  input.reconnect = options.reconnect;
  return input;
}

int usage(const std::string& what) {
  fmt::print(stderr, "rubric-extcap: {}\n", what);
  return cli::kExitUsage;
}

/// One capture into a pipe that is open.
class Capture {
 public:
  Capture(const CaptureOptions& options, lines::CaptureFile& file)
      : input_(input_of(options)),
        protocol_(cli::chosen_protocol(input_)),
        decoder_(protocol_, nullptr),
        file_(file) {
    if (!options.filter.empty()) filter_.emplace(options.filter, protocol_);
  }

  int run() {
    const cli::InputResult result = cli::read_packets(
        input_,
        [this](const Packet& packet, const cli::Source& source) { return take(packet, source); },
        [this] {
          file_.flush();
          if (file_.reader_gone()) lines::request_stop();
        });
    if (file_.reader_gone()) return cli::kExitClean;  // A reader that stops ends the capture.
    if (!file_.finish() || result.failed) return cli::kExitInput;
    return cli::kExitClean;
  }

 private:
  bool take(const Packet& packet, const cli::Source& source) {
    if (!filter_ || wanted(packet, source)) file_.write(packet, source.interface_name);
    return true;
  }

  bool wanted(const Packet& packet, const cli::Source& source) {
    decoder_.decode(packet, frame_);
    record_.index = index_++;
    record_.number = source.number;
    record_.frame = &frame_;
    record_.interface_name = source.interface_name;
    record_.time_ns = packet.time_ns;
    return filter_->matches(record_);
  }

  cli::InputOptions input_;
  const reflect::Protocol& protocol_;
  reflect::FrameDecoder decoder_;
  std::optional<format::Filter> filter_;
  lines::CaptureFile& file_;
  reflect::Frame frame_;
  format::Record record_;
  std::uint64_t index_ = 0;
};

}  // namespace

int capture(const CaptureOptions& options) {
  if (options.fifo.empty()) return usage("--capture needs --fifo FILE");
  lines::stop_on_signals();
  try {
    // Comes first: until the pipe is opened, Wireshark waits and shows nothing.
    lines::CaptureFile file(options.fifo);
    lines::required_address(options.source);
    return Capture(options, file).run();
  } catch (const format::FilterError& error) {
    return usage("capture filter: " + error.explain(options.filter));
  } catch (const cli::Ending& error) {
    return usage(error.what());
  } catch (const std::invalid_argument& error) {
    return usage(fmt::format("source {}", error.what()));
  } catch (const std::system_error& error) {
    if (lines::stop_requested()) return cli::kExitClean;  // Nobody opened the pipe.
    fmt::print(stderr, "rubric-extcap: {}: {}\n", options.fifo,
               std::strerror(error.code().value()));
    return cli::kExitInput;
  }
}

std::string filter_error(const std::string& filter, const std::string& spec) {
  CaptureOptions options;
  options.spec = spec;
  if (filter.empty()) return {};
  try {
    format::Filter(filter, cli::chosen_protocol(input_of(options)));
  } catch (const format::FilterError& error) {
    return error.what();
  }
  return {};
}

}  // namespace rubric::extcap
