// rubric-extcap: called by Wireshark, which captures with it. extcap(4) says how.
#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "codec/containers/link_record.h"
#include "codec/lines/capture_file.h"
#include "codec/lines/line.h"
#include "codec/lines/stop.h"
#include "codec/reflect/frame.h"
#include "codec/reflect/registry.h"
#include "codec/text/text.h"
#include "tools/cli/command.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/input.h"
#include "tools/format/filter.h"

namespace rubric::extcap {
namespace {

// The command line that Wireshark passes to an extcap program.

/// The name of our only interface, as in `tshark -i rubric`.
constexpr std::string_view kInterface = "rubric";

/// The protocol of the capture filter, if none is named.
constexpr std::string_view kDefaultSpec = "rubicon";

/// A command line of which only known options are kept: newer Wiresharks pass more than older ones.
class CommandLine {
 public:
  /// Takes `--name value` as well as `--name=value`; the last one if an option is given twice.
  explicit CommandLine(const std::vector<std::string>& words);

  bool has(std::string_view name) const { return values_.find(name) != values_.end(); }
  /// Returns the value of an option that takes one; `otherwise` if it is not given.
  std::string value(std::string_view name, std::string_view otherwise = {}) const;
  /// Returns an option that lacks its value, being the last word; empty if there is none.
  const std::string& unfinished() const { return unfinished_; }

 private:
  std::map<std::string, std::string, std::less<>> values_;
  std::string unfinished_;
};

struct CaptureOptions {
  std::string fifo;    ///< A named pipe that Wireshark reads; or a file.
  std::string source;  ///< In the form of live/line.h.
  std::string filter;  ///< In the form of `rubric decode --filter`; empty: all frames.
  std::string spec;    ///< Protocol of the filter.
  bool listen_only = false;
  bool reconnect = false;
};

// The word after one of these is its value, even if it looks like an option: Wireshark passes
// `--extcap-reload-option --source`.
constexpr std::string_view kWithValue[] = {
    "--extcap-interface",
    "--extcap-capture-filter",
    "--extcap-control-in",
    "--extcap-control-out",
    "--extcap-reload-option",
    "--extcap-version",
    "--fifo",
    "--source",
    "--other-source",
    "--spec",
};

bool takes_value(std::string_view name) {
  return std::find(std::begin(kWithValue), std::end(kWithValue), name) != std::end(kWithValue);
}

CommandLine::CommandLine(const std::vector<std::string>& words) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
    if (!word.starts_with("--")) continue;  // The value of an option that we do not know.
    const std::size_t equals = word.find('=');
    std::string name = word.substr(0, equals);
    std::string value;
    if (equals != word.npos) {
      value = word.substr(equals + 1);
    } else if (takes_value(name)) {
      if (i + 1 == words.size())
        unfinished_ = name;
      else
        value = words[++i];
    }
    values_[std::move(name)] = std::move(value);
  }
}

std::string CommandLine::value(std::string_view name, std::string_view otherwise) const {
  const auto found = values_.find(name);
  return found == values_.end() ? std::string(otherwise) : found->second;
}

// Returns the text of --help.
std::string help_text() {
  return "With this program Wireshark and tshark capture what a mote or sink sends on its serial\n"
         "line, or what a serial forwarder passes on. 'rubric install-wireshark' makes it known\n"
         "to Wireshark, which then calls it.\n"
         "\n"
         "Usage: rubric-extcap --extcap-interfaces\n"
         "  or:  rubric-extcap --extcap-dlts --extcap-interface rubric\n"
         "  or:  rubric-extcap --extcap-config --extcap-interface rubric\n"
         "  or:  rubric-extcap --extcap-capture-filter FILTER --extcap-interface rubric\n"
         "  or:  rubric-extcap --capture --extcap-interface rubric --fifo FILE [OPTIONS]\n"
         "\n"
         "Options:\n"
         "  --help                Print this help\n"
         "  --version             Print the version\n"
         "  --extcap-interfaces   Print what can be captured from\n"
         "  --extcap-dlts         Print what kinds of packets come from there\n"
         "  --extcap-config       Print what can be set\n"
         "  --extcap-reload-option NAME\n"
         "                        With --extcap-config, print only the choices of this option\n"
         "  --capture             Capture, until SIGINT, SIGTERM, or FILE's reader has gone\n"
         "  --fifo FILE           Write the capture to this file, as pcapng\n"
         "  --extcap-interface NAME\n"
         "                        Use this one of --extcap-interfaces\n"
         "  --extcap-capture-filter FILTER\n"
         "                        Capture only frames for which this holds, as in\n"
         "                        rubric decode --filter; without --capture, print what is wrong\n"
         "                        with it\n"
         "  --source ADDRESS      Capture from serial@DEVICE:BAUD (or a platform, as telosb for\n"
         "                        BAUD), network@HOST:PORT, a serial line through TCP, or\n"
         "                        sf@HOST:PORT, a serial forwarder (default: $MOTECOM, or\n"
         "                        sf@localhost:9002)\n"
         "  --other-source ADDRESS\n"
         "                        Capture from this instead of --source, unless it is empty\n"
         "  --listen-only         Write nothing to a serial line: confirm no frames\n"
         "  --reconnect           Open a line again when it comes back\n"
         "  --spec PROTOCOL       Use the names of this protocol in FILTER (default: rubicon)\n"
         "Unknown options are ignored.\n"
         "\n"
         "Examples:\n"
         "  tshark -D | grep rubric\n"
         "  tshark -i rubric -o extcap.rubric.source:serial@/dev/ttyUSB0:telosb\n"
         "  tshark -i rubric -o extcap.rubric.source:sf@localhost:9002 -f 'message==updates'\n"
         "  rubric-extcap --capture --extcap-interface rubric --fifo run.pcapng"
         " --source sf@localhost:9002\n"
         "Exit codes: 0 captured or printed, 64 usage, 66 the source cannot be had or is gone, or\n"
         "FILE cannot be written.\n";
}

// Answers to Wireshark, in the sentences that extcap(4) describes.

namespace fs = std::filesystem;

constexpr int kSource = 0;  // Numbers of the arguments, in the order in which they are shown.
constexpr int kOtherSource = 1;
constexpr int kListenOnly = 2;
constexpr int kReconnect = 3;
constexpr int kSpec = 4;

struct Speed {
  const char* platform;
  const char* shown;
};
constexpr Speed kSpeeds[] = {
    {"telosb", "telosb, tmote: 115200"}, {"micaz", "micaz, iris: 57600"}, {"mica", "mica: 19200"}};

/// Returns whether the text fits a sentence, which ends with its line, and its values with a brace.
bool can_be_said(std::string_view text) { return text.find_first_of("{}\r\n") == text.npos; }

/// Returns serial adapters that are plugged in, by name.
std::vector<std::string> devices() {
  std::vector<std::string> found;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator("/dev", error)) {
    const std::string name = entry.path().filename().string();
    const bool serial = name.starts_with("ttyUSB") || name.starts_with("ttyACM");
    if (serial && can_be_said(name)) found.push_back(entry.path().string());
  }
  std::sort(found.begin(), found.end(), [](const std::string& a, const std::string& b) {
    return a.size() != b.size() ? a.size() < b.size() : a < b;  // ttyUSB2 before ttyUSB10.
  });
  return found;
}

std::string value(int argument, std::string_view text, std::string_view shown, bool is_default) {
  return fmt::format("value {{arg={}}}{{value={}}}{{display={}}}{{default={}}}\n", argument, text,
                     shown, is_default);
}

std::string sources() {
  std::string first = lines::default_address();
  if (!can_be_said(first)) first = "sf@localhost:9002";
  std::string out = value(kSource, first, first, true);
  for (const std::string& device : devices()) {
    for (const Speed& speed : kSpeeds) {
      const std::string address = fmt::format("serial@{}:{}", device, speed.platform);
      if (address == first) continue;
      out += value(kSource, address, fmt::format("{} ({})", device, speed.shown), false);
    }
  }
  return out;
}

std::string specs() {
  std::string out;
  for (const reflect::Protocol* protocol : reflect::protocols()) {
    out += value(kSpec, protocol->id, protocol->id, protocol->id == kDefaultSpec);
  }
  return out;
}

// Answers --extcap-interfaces.
std::string interfaces() {
  return fmt::format(
      "extcap {{version={}}}{{display=Rubric}}\n"
      "interface {{value={}}}{{display=RUBICON mote or sink (serial line, serial forwarder)}}\n",
      RUBRIC_VERSION, kInterface);
}

// Answers --extcap-dlts.
std::string link_types() {
  return fmt::format(
      "dlt {{number={}}}{{name=USER0}}{{display=Serial frames, from kind byte to CRC}}\n"
      "dlt {{number={}}}{{name=USER1}}{{display=Packets of a serial forwarder}}\n",
      kLinkSerial, kLinkSf);
}

// Answers --extcap-config. With `reload`, an option's name, only its present choices.
std::string config(std::string_view reload) {
  if (!reload.empty()) {
    const std::string_view name =
        reload.substr(std::min(reload.find_first_not_of('-'), reload.size()));
    return name == "source" ? sources() : name == "spec" ? specs() : std::string();
  }
  std::string out;
  const auto argument = [&out](int number, std::string_view call, std::string_view shown,
                               std::string_view type, std::string_view tip,
                               std::string_view more = {}) {
    out += fmt::format("arg {{number={}}}{{call={}}}{{display={}}}{{type={}}}{{tooltip={}}}{}\n",
                       number, call, shown, type, tip, more);
  };
  argument(kSource, "--source", "Source", "selector", "Where frames come from", "{reload=true}");
  argument(kOtherSource, "--other-source", "Another source", "string",
           "Taken instead, if given: serial@DEVICE:BAUD, network@HOST:PORT or sf@HOST:PORT",
           "{placeholder=serial@/dev/ttyUSB0:telosb}"
           "{validation=^(serial@.+:[0-9a-z]+|(network|sf)@.+:[0-9]+)?$}");
  argument(kListenOnly, "--listen-only", "Listen only", "boolflag",
           "Write nothing to a serial line: confirm no frames", "{default=false}");
  argument(kReconnect, "--reconnect", "Reconnect", "boolflag",
           "Open a line again when it comes back", "{default=false}");
  argument(kSpec, "--spec", "Protocol of the capture filter", "selector",
           "Whose names of messages and fields the capture filter uses");
  return out + sources() + specs();
}

// A capture that Wireshark reads while it grows.

cli::InputOptions input_of(const CaptureOptions& options) {
  return {.files = {options.source},
          .spec = options.spec,
          .listen_only = options.listen_only,
          .reconnect = options.reconnect};
}

int usage(const std::string& what) {
  text::print_harmless(stderr, "rubric-extcap: " + what + '\n');
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
          if (file_.reader_gone()) lines::request_stop();
        });
    if (file_.reader_gone()) return cli::kExitClean;  // A reader that stops ends the capture.
    if (!file_.finish()) return cli::kExitOutput;
    return result.failed ? cli::kExitInput : cli::kExitClean;
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

// Captures until it is stopped. Returns the exit code; prints mistakes on stderr.
int capture(const CaptureOptions& options) {
  if (options.fifo.empty()) return usage("--capture needs --fifo FILE");
  lines::stop_on_signals();
  try {
    // Comes first: until the pipe is opened, Wireshark waits and shows nothing.
    lines::CaptureFile file(options.fifo, lines::CaptureFile::Mode::kGrowOver);
    if (!file.open()) {  // Stopped, if nobody opened the pipe.
      return lines::stop_requested() ? cli::kExitClean : cli::kExitOutput;
    }
    lines::required_address(options.source);
    return Capture(options, file).run();
  } catch (const format::FilterError& error) {
    return usage("capture filter: " + error.explain(options.filter));
  } catch (const cli::Ending& error) {
    return usage(error.what());
  } catch (const std::invalid_argument& error) {
    return usage(fmt::format("source {}", error.what()));
  }
}

// Returns what is wrong with a filter, or nothing. Throws cli::UsageError for an unknown `spec`.
std::string filter_error(const std::string& filter, const std::string& spec) {
  CaptureOptions options{.spec = spec};
  if (filter.empty()) return {};
  try {
    format::Filter(filter, cli::chosen_protocol(input_of(options)));
  } catch (const format::FilterError& error) {
    return error.what();
  }
  return {};
}

int answer(const std::string& text) {
  fmt::print("{}", text);
  return std::fflush(stdout) == 0 ? cli::kExitClean : cli::kExitOutput;
}

int complain(const std::string& what) {
  text::print(stderr, "rubric-extcap: {}\nTry 'rubric-extcap --help'.\n", what);
  return cli::kExitUsage;
}

/// Returns whether `--listen-only` or `--listen-only=true` is given.
bool flag(const CommandLine& line, std::string_view name) {
  return line.has(name) && line.value(name) != "false";
}

int start(const CommandLine& line) {
  CaptureOptions options{.fifo = line.value("--fifo"), .source = line.value("--other-source")};
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
