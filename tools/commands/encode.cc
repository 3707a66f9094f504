#include <fmt/format.h>

#include <memory>
#include <string>
#include <string_view>

#include "tools/cli/exit_codes.h"
#include "tools/commands/commands.h"
#include "tools/encode/line_encoder.h"
#include "tools/encode/packet_output.h"

namespace rubric::tools {
namespace {

struct EncodeOptions {
  encode::LineOptions lines;
  std::string format = "hex";
  std::string output = "-";
};

constexpr const char* kEncodeFooter =
    "A line with \"raw\" is encoded from it. Where it also has \"fields\" and is not marked\n"
    "malformed, both must say the same: delete \"raw\", and \"crc\" or \"fcs\" in\n"
    "\"frame\", to encode changed fields. Sizes, counts and check sums that are missing are\n"
    "computed. A message alone:\n"
    "  echo '{\"type\":10,\"value\":12}' | rubric encode --as config\n"
    "Exit codes: 0 all lines encoded, 64 usage, 66 some line or file could not be read or "
    "encoded,\n"
    "74 output cannot be written.";

/// Returns the framing of a single message on its way to such an output.
std::string_view serial_framing(const std::string& format) {
  const bool in_capture = format == "pcap" || format == "pcapng";
  return format == "hdlc" || in_capture ? "hdlc" : "sf";
}

/// Writes all lines. Returns whether all were written.
bool write_all(const EncodeOptions& options, encode::LineEncoder& encoder,
               encode::PacketOutput& output, bool& any) {
  std::string last_place;
  const auto put = [&](encode::EncodedLines& lines, const encode::OwnedPacket& packet,
                       const std::string& place) {
    const std::string refused = output.write(packet.view(), packet.interface_name);
    if (!refused.empty()) lines.complain(place, refused);
    if (output.cut_refused()) {
      lines.complain(last_place, "a frame that was cut can only be the last of a stream");
    }
    last_place = place;
    return output.open();
  };
  encode::EncodedLines lines(options.lines, encoder, put);
  const bool good = lines.all();
  any = lines.any();
  return good;
}

int run_encode(const EncodeOptions& options) {
  const reflect::Protocol& protocol = cli::chosen_protocol(options.lines.input);
  const reflect::Type* message = cli::chosen_message(options.lines.input, protocol);
  encode::LineEncoder encoder(options.lines, protocol, message, serial_framing(options.format));
  encode::PacketOutput output(options.format, options.output);
  bool any = false;
  const bool good = write_all(options, encoder, output, any);
  // A mistyped name must not cost the file that would have been replaced.
  if (!good && !any) return cli::kExitInput;
  if (!output.finish()) return cli::kExitOutput;
  return good ? cli::kExitClean : cli::kExitInput;
}

}  // namespace

void add_encode(cli::Command& app) {
  auto options = std::make_shared<EncodeOptions>();
  cli::Command& sub = app.add_subcommand(
      "encode", "Make frames from the JSON lines of 'rubric decode', or from fields alone");
  sub.footer(kEncodeFooter);
  encode::add_line_options(sub, options->lines);
  encode::add_carrier_option(sub, options->lines);
  sub.add_option("--format", options->format, "Write hex, hdlc, sf, pcap or pcapng")
      .one_of(encode::container_names());
  sub.add_option("-o,--out", options->output, "Write to this file; - is stdout");
  sub.exit_code_of([options] {
    encode::check_line_options(options->lines);
    cli::keep_apart("--out", options->output, cli::all_inputs(options->lines.input));
    return run_encode(*options);
  });
}

}  // namespace rubric::tools
