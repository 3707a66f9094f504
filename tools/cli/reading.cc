#include "tools/cli/reading.h"

#include <fmt/format.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "codec/containers/link_record.h"
#include "codec/generated/tinyos/am_header.h"
#include "codec/generated/tinyos/enums.h"
#include "codec/generated/tinyos/mac_ack.h"

namespace rubric::cli {
namespace {

/// Hex text whose lines are 802.15.4 frames.
constexpr const char* kHexRadio = "hex-radio";

struct FormatName {
  const char* name;
  InputFormat format;
};
constexpr FormatName kFormats[] = {
    {"hdlc", InputFormat::kHdlc},     {"sf", InputFormat::kSf},   {"pcap", InputFormat::kPcap},
    {"pcapng", InputFormat::kPcapng}, {"hex", InputFormat::kHex}, {kHexRadio, InputFormat::kHex},
    {"log", InputFormat::kLog},
};

/// The names of link types in --link-type.
struct LinkName {
  const char* name;
  std::uint16_t link_type;
};
constexpr LinkName kLinks[] = {
    {"serial", kLinkSerial},      {"sf", kLinkSf},
    {"radio", kLinkRadioNoFcs},   {"radio-fcs", kLinkRadioFcs},
    {"radio-phy", kLinkRadioPhy}, {"radio-tap", kLinkRadioTap},
    {"ethernet", kLinkEthernet},
};

struct UserLink {
  std::uint16_t from;
  std::uint16_t to;
};

// Parses 149=radio-fcs.
std::optional<UserLink> parse_user_link(const std::string& text) {
  const std::size_t equals = text.find('=');
  const bool digits = equals == 3 && text.find_first_not_of("0123456789") == equals;
  const int from = digits ? std::stoi(text) : 0;
  if (from < kLinkUserFirst || from > kLinkUserLast) return std::nullopt;
  for (const LinkName& known : kLinks) {
    if (text.substr(equals + 1) != known.name) continue;
    return UserLink{static_cast<std::uint16_t>(from), known.link_type};
  }
  return std::nullopt;
}

std::string check_user_link(const std::string& text) {
  if (parse_user_link(text)) return {};
  std::string names;
  for (const LinkName& known : kLinks)
    names += (names.empty() ? "" : ", ") + std::string(known.name);
  return fmt::format(
      "expected a link type from 147 to 162 and what it is ({}), as in 149=radio-fcs; given '{}'",
      names, text);
}

InputFormat find_format(std::string_view name) {
  for (const FormatName& known : kFormats) {
    if (name == known.name) return known.format;
  }
  return InputFormat::kUnknown;
}

// Returns whether the bytes begin with a frame control field of TinyOS.
bool is_like_radio(Bytes bytes) {
  const auto begin = tinyos::MacAckView::parse(bytes);
  if (!begin) return false;
  const auto control = static_cast<tinyos::FrameControl>(begin->fcf());
  return control == tinyos::FrameControl::kAck || control == tinyos::FrameControl::kData ||
         control == tinyos::FrameControl::kDataAckRequest;
}

// Returns whether no line is an active message, and most could be radio frames without their FCS.
bool lines_may_be_radio(const Reading& reading, Bytes beginning) {
  std::uint64_t active = 0, radio = 0, all = 0;
  auto look = [&](const Packet& packet) {
    active += tinyos::AmHeaderView::parse(packet.bytes) ? 1 : 0;
    radio += is_like_radio(packet.bytes) ? 1 : 0;
    ++all;
  };
  make_reader(reading.format, reading.options)->feed(beginning, look);
  return active == 0 && all != 0 && 2 * radio >= all;
}

// Decides whether lines of text are radio frames.
void choose_radio_text(const InputOptions& options, Bytes beginning, Reading& reading) {
  const bool named = options.format == kHexRadio;
  const bool automatic = options.format == "auto";
  if (!named && !is_text(reading.format)) return;
  if (named && detect(beginning) == InputFormat::kLog) reading.format = InputFormat::kLog;
  const bool with_fcs =
      (named || automatic) && options.fcs == "auto" && lines_end_with_fcs(beginning);
  if (!named && !with_fcs) {
    if (!lines_may_be_radio(reading, beginning)) return;
    reading.remark =
        "none of its lines is an active message; if they are radio frames: "
        "--input-format hex-radio";
    return;
  }
  reading.options.hex_framing = Framing::kRadio;
  reading.options.hex_has_fcs = with_fcs || options.fcs == "crc" || options.fcs == "cc24xx";
  if (!named) {
    reading.remark = "its lines are radio frames with their FCS (--input-format hex-radio)";
  }
}

// Decides what ends the radio frames of a capture file.
void choose_fcs(const InputOptions& options, Bytes beginning, Reading& reading) {
  reading.fcs = fcs_kind(options.fcs);
  if (options.fcs != "auto" || !is_capture(reading.format)) return;
  FcsGuess guess;
  auto look = [&](const Packet& packet) { guess.take(packet); };
  make_reader(reading.format, reading.options)->feed(beginning, look);
  if (guess.is_cc24xx()) {
    reading.fcs = FcsKind::kCc24xx;
    reading.remark =
        "its radio frames end with RSSI and link quality in place of the FCS (--fcs cc24xx)";
  } else if (guess.is_left_out()) {
    reading.fcs = FcsKind::kLeftOut;
    reading.remark = "its radio frames were captured without their FCS";
  } else if (guess.is_extra()) {
    reading.fcs = FcsKind::kExtra;
    reading.remark =
        "its radio frames end with their FCS, though its link type 230 says that they have none";
  } else if (guess.may_be_cc24xx()) {
    reading.remark =
        "no FCS of its radio frames fits; if a TI chip put RSSI and link quality there: --fcs "
        "cc24xx; if they have none, as Cooja writes them: --fcs none";
  } else if (guess.fits_nowhere()) {
    reading.remark =
        "no FCS of its radio frames fits; if they have none, as Cooja writes them: --fcs none";
  }
}

}  // namespace

bool is_text(InputFormat format) {
  return format == InputFormat::kHex || format == InputFormat::kLog;
}

bool is_capture(InputFormat format) {
  return format == InputFormat::kPcap || format == InputFormat::kPcapng;
}

std::string_view format_name(InputFormat format) {
  for (const FormatName& known : kFormats) {
    if (known.format == format) return known.name;
  }
  return "unknown";
}

Reading reading_of(const InputOptions& options, Bytes beginning) {
  Reading out{.format = options.format == "auto" ? detect(beginning) : find_format(options.format)};
  for (const std::string& text : options.links) {
    const std::optional<UserLink> link = parse_user_link(text);
    if (link) out.options.user_links[link->from - kLinkUserFirst] = link->to;
  }
  if (!options.as_message.empty()) {
    out.options.hex_framing = Framing::kBare;
  } else {
    choose_radio_text(options, beginning, out);
  }
  choose_fcs(options, beginning, out);
  return out;
}

void add_capture_options(Command& app, InputOptions& options, bool bare) {
  std::vector<std::string> formats{"auto", "hdlc", "sf", "pcap", "pcapng", "hex", "log", kHexRadio};
  if (bare) formats.emplace_back("bare");
  app.add_option("--input-format", options.format,
                 std::string("Read the input as auto, hdlc (bytes of a serial line), sf (serial "
                             "forwarder), pcap, pcapng, hex (text, from the dispatch byte on, or "
                             "from a flag 7E), log (the same, or what sniffers print, among other "
                             "lines)") +
                     (bare ? ", hex-radio (text, 802.15.4 frames) or bare (one message, with --as)"
                           : " or hex-radio (text, 802.15.4 frames)"))
      .one_of(std::move(formats));
  app.add_option("--fcs", options.fcs,
                 "Read the last two bytes of radio frames with link type 195, or of hex-radio, as "
                 "crc (their FCS), cc24xx (RSSI, link quality and CRC bit of TI's chips), none "
                 "(data) or auto (decided from the beginning of the file)")
      .one_of({"auto", "crc", "cc24xx", "none"});
  app.add_option("--link-type", options.links,
                 "Read a user-defined link type, 147 to 162, as serial, sf, radio, radio-fcs, "
                 "radio-phy, radio-tap or ethernet: 149=radio-fcs")
      .check(check_user_link)
      .repeatable();
}

}  // namespace rubric::cli
