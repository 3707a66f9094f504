#include "tools/wireshark/extcap/sentences.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "codec/containers/link_record.h"
#include "codec/lines/line.h"
#include "codec/reflect/registry.h"
#include "tools/wireshark/extcap/command_line.h"

namespace rubric::extcap {
namespace {

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

}  // namespace

std::string interfaces() {
  return fmt::format(
      "extcap {{version={}}}{{display=Rubric}}\n"
      "interface {{value={}}}{{display=RUBICON mote or sink (serial line, serial forwarder)}}\n",
      RUBRIC_VERSION, kInterface);
}

std::string link_types() {
  return fmt::format(
      "dlt {{number={}}}{{name=USER0}}{{display=Serial frames, from kind byte to CRC}}\n"
      "dlt {{number={}}}{{name=USER1}}{{display=Packets of a serial forwarder}}\n",
      kLinkSerial, kLinkSf);
}

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

}  // namespace rubric::extcap
