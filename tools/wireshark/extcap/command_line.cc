#include "tools/wireshark/extcap/command_line.h"

#include <algorithm>
#include <iterator>

namespace rubric::extcap {
namespace {

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

}  // namespace

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
         "Exit codes: 0 captured or printed, 2 usage, 3 the source cannot be had or is gone, or\n"
         "FILE cannot be written.\n";
}

}  // namespace rubric::extcap
