#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>

#include "codec/text/packed.h"
#include "codec/text/text.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/frame_filter.h"
#include "tools/cli/input.h"
#include "tools/commands/commands.h"
#include "tools/encode/packet_output.h"
#include "tools/format/record.h"

namespace rubric::tools {
namespace {

struct ConvertOptions {
  cli::InputOptions input;
  std::string format;
  std::string output;
  std::string only;
  std::string filter;
};

constexpr const char* kConvertFooter =
    "What the target cannot hold is reported on stderr. pcap holds one link type, that of the "
    "first\n"
    "packet; --only hdlc and --only radio choose.\n"
    "Exit codes: 0 converted, 64 usage, 66 an input is missing or damaged (what can be read of\n"
    "all inputs is written; a target is made only if that is something), 74 output cannot be\n"
    "written.";

struct Suffix {
  std::string_view suffix;
  const char* container;
};
constexpr Suffix kSuffixes[] = {
    {".pcapng", "pcapng"}, {".ntar", "pcapng"}, {".pcap", "pcap"}, {".cap", "pcap"},
    {".sfstream", "sf"},   {".sf", "sf"},       {".hex", "hex"},   {".txt", "hex"},
    {".hdlc", "hdlc"},     {".bin", "hdlc"},
};

std::string container_of(std::string_view file) {
  file = text::name_unpacked(file);
  for (const Suffix& known : kSuffixes) {
    if (file.ends_with(known.suffix)) return known.container;
  }
  return {};
}

/// Data that the target could not hold.
struct Losses {
  std::uint64_t packets = 0;
  std::uint64_t written = 0;
  std::uint64_t times = 0;
  std::uint64_t given_times = 0;  // Packets without a time that got one.
  std::uint64_t directions = 0;
  std::uint64_t interfaces = 0;
  std::uint64_t comments = 0;
  std::uint64_t sequence_numbers = 0;            // From the serial line.
  std::uint64_t radio_facts = 0;                 // RSSI and its like.
  std::uint64_t more_facts = 0;                  // Those that no container here holds.
  std::uint64_t radio = 0;                       // Among those written.
  std::map<std::string, std::uint64_t> refused;  // By reason: a handful.
};

void count_details(const Packet& packet, std::string_view interface_name,
                   const encode::Holds& holds, const std::string& container, Losses& losses) {
  const bool bare_packets = container == "sf" || container == "hex";
  losses.sequence_numbers += bare_packets && packet.serial_seq != kAbsent;
  losses.radio += packet.framing == Framing::kRadio;
  losses.radio_facts += container == "hex" && packet.radio.any();
  losses.more_facts += packet.radio.more;
  losses.times += !holds.times && packet.time_ns != kNoTime;
  losses.directions += !holds.directions && packet.direction != Direction::kUnknown;
  losses.interfaces += !holds.interfaces && !interface_name.empty();
  losses.comments += !holds.comments && !packet.comment.empty();
}

void report(const Losses& losses, const std::string& container) {
  for (const auto& [why, count] : losses.refused) {
    text::print(stderr, "rubric: left out {} of {} packets: {}\n", count, losses.packets, why);
  }
  const auto lost = [&](std::uint64_t count, const char* what) {
    if (count == 0) return;
    text::print(stderr, "rubric: {} holds no {}: {} of {} packets lost theirs\n", container, what,
                count, losses.written);
  };
  lost(losses.times, "times");
  if (losses.given_times) {
    text::print(stderr, "rubric: {} of {} packets have no time stamp and got {}, as {} needs one\n",
                losses.given_times, losses.written,
                container == "pcap" ? "0" : "that of the packet before them", container);
  }
  lost(losses.directions, "directions");
  lost(losses.interfaces, "interface names");
  lost(losses.comments, "comments");
  lost(losses.sequence_numbers, "serial sequence numbers");
  lost(losses.radio_facts, "RSSI, link quality, channel or time slot");
  if (losses.more_facts) {
    text::print(
        stderr,
        "rubric: {} of {} packets lost what their TAP headers say besides RSSI, link quality, "
        "channel and time slot, or their FCS of 32 bits\n",
        losses.more_facts, losses.written);
  }
  if (container == "hex" && losses.radio && losses.radio != losses.written) {
    text::print(stderr,
                "rubric: hex does not say which lines are radio frames; --only keeps one "
                "framing\n");
  }
}

// Settles the target: with several files and no -o it is the last one, as with cp.
void settle_target(ConvertOptions& options) {
  if (options.output.empty() && options.input.files.size() > 1) {
    options.output = options.input.files.back();
    options.input.files.pop_back();
  }
  if (options.output.empty() && options.format.empty()) {
    throw cli::UsageError("OUT",
                          "is missing: name the file to write last, or give --format for stdout");
  }
  if (options.output.empty()) options.output = "-";
  if (std::filesystem::is_directory(options.output)) {
    throw cli::UsageError("OUT", "'" + options.output + "' is a folder; name a file in it");
  }
  if (options.format.empty()) options.format = container_of(options.output);
  if (options.format.empty()) {
    throw cli::UsageError("--format", "is needed, as '" + options.output +
                                          "' has no suffix that says what to write (.pcapng, "
                                          ".pcap, .sf, .hex, .hdlc)");
  }
  options.input.prints = options.output == "-";
  cli::keep_apart("OUT", options.output, options.input.files);
  if (!options.input.prints) cli::open_sources(options.input);
}

int run_convert(const ConvertOptions& options) {
  cli::FrameFilter filter(options.filter, cli::chosen_protocol(options.input));
  Losses losses;
  const encode::Holds holds = encode::holds(options.format);
  encode::PacketOutput output(options.format, options.output);
  const auto on_packet = [&](const Packet& packet, const cli::Source& source) {
    if (!options.only.empty() && format::framing_name(packet.framing) != options.only) return true;
    if (cli::is_damage(packet)) return true;  // Said already, and no packet.
    if (!filter.takes(packet, source.interface_name, source.number)) return true;
    ++losses.packets;
    const std::string refused = output.write(packet, source.interface_name);
    if (output.cut_refused()) {
      ++losses.refused["a frame that was cut can only be the last of a stream"];
      --losses.written;
    }
    if (!refused.empty()) {
      ++losses.refused[refused];
      return true;
    }
    ++losses.written;
    count_details(packet, source.interface_name, holds, options.format, losses);
    return output.open();
  };
  const cli::InputResult result = cli::read_packets(options.input, on_packet);
  losses.given_times = output.given_times();
  bool written = true;
  // A mistyped name must not cost the file that would have been replaced.
  if (!result.failed || losses.packets > 0) written = output.finish();
  report(losses, options.format);
  if (!written) return cli::kExitOutput;
  return result.failed ? cli::kExitInput : cli::kExitClean;
}

}  // namespace

void add_convert(cli::Command& app) {
  auto options = std::make_shared<ConvertOptions>();
  cli::Command& sub =
      app.add_subcommand("convert", "Convert packets from one container into another");
  sub.footer(kConvertFooter);
  sub.add_option(
      "FILE", options->input.files,
      "Captures, and last the target unless -o names it; - is stdin or stdout. Names that "
      "end in .gz or .zst are written compressed");
  sub.add_option("-o,--out", options->output, "Write to this file; - is stdout");
  sub.add_option("--format", options->format,
                 "Write hex, hdlc, sf, pcap or pcapng (default: by the target's suffix)")
      .one_of(encode::container_names());
  cli::add_capture_options(sub, options->input);
  sub.add_option("--only", options->only, "Keep only packets of this framing: hdlc, sf or radio")
      .one_of({"hdlc", "sf", "radio"});
  sub.add_option("--filter", options->filter,
                 "Keep only packets for which this holds, as in 'rubric decode'");
  cli::add_spec_option(sub, options->input);
  sub.exit_code_of([options] {
    settle_target(*options);
    return run_convert(*options);
  });
}

}  // namespace rubric::tools
