#include <fmt/format.h>

#include <cstdint>
#include <ctime>
#include <memory>
#include <optional>
#include <string>

#include "codec/lines/capture_file.h"
#include "codec/lines/line.h"
#include "codec/reflect/frame.h"
#include "codec/text/text.h"
#include "tools/cli/color.h"
#include "tools/cli/each.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/frame_filter.h"
#include "tools/cli/input.h"
#include "tools/cli/output.h"
#include "tools/cli/specs.h"
#include "tools/cli/write_options.h"
#include "tools/commands/commands.h"
#include "tools/format/csv.h"
#include "tools/format/filter.h"
#include "tools/format/jsonl.h"
#include "tools/format/text.h"

namespace rubric::tools {
namespace {

constexpr std::int64_t kNoPrevious = kNoTime;

struct DecodeOptions {
  cli::InputOptions input;
  std::string format = "text";
  std::string filter;
  std::string fields;
  std::string time = "epoch";
  std::string color = "auto";
  std::uint64_t count = 0;  ///< 0: all.
  bool hex = false;
  bool strict = false;
  bool units = false;
  cli::EachOptions each;
  cli::WriteOptions write;
};

std::vector<format::Path> chosen_fields(const DecodeOptions& options,
                                        const reflect::Protocol& protocol) {
  if (options.fields.empty()) return {};
  try {
    return format::parse_paths(options.fields, protocol);
  } catch (const format::PathError& error) {
    const auto works = [&](const reflect::Protocol& other) {
      try {
        format::parse_paths(options.fields, other);
        return true;
      } catch (const format::PathError&) {
        return false;
      }
    };
    throw cli::UsageError("--fields", error.what() + cli::spec_with(protocol, works));
  }
}

std::unique_ptr<format::Formatter> make_formatter(const DecodeOptions& options,
                                                  const reflect::Protocol& protocol) {
  std::vector<format::Path> fields = chosen_fields(options, protocol);
  if (options.format == "jsonl") {
    return std::make_unique<format::JsonlFormatter>(protocol, options.units, std::move(fields));
  }
  if (options.format == "csv") {
    return std::make_unique<format::CsvFormatter>(protocol, std::move(fields));
  }
  format::TextOptions text;
  text.color = cli::use_color(options.color, 1);
  text.hex = options.hex;
  text.units = options.units;
  text.fields = std::move(fields);
  return std::make_unique<format::TextFormatter>(protocol, std::move(text));
}

std::optional<format::Filter> make_filter(const DecodeOptions& options,
                                          const reflect::Protocol& protocol) {
  if (options.filter.empty()) return std::nullopt;
  return cli::filter_of(options.filter, protocol);
}

/// Times in the form of --time.
class Clock {
 public:
  explicit Clock(const std::string& mode)
      : none_(mode == "none"),
        relative_(mode == "relative"),
        delta_(mode == "delta"),
        utc_(mode == "utc"),
        local_(mode == "local") {}

  /// Returns the time to show for a frame.
  std::int64_t shown(std::int64_t time_ns) {
    if (none_ || time_ns == kNoTime) return kNoTime;
    if (!relative_ && !delta_) return time_ns;
    if (reference_ns_ == kNoPrevious) reference_ns_ = time_ns;
    // Wraps instead of overflowing: damaged stamps can be anything.
    const auto difference = static_cast<std::int64_t>(static_cast<std::uint64_t>(time_ns) -
                                                      static_cast<std::uint64_t>(reference_ns_));
    if (delta_) reference_ns_ = time_ns;
    return difference;
  }

  /// Returns the date and time of day, as ISO 8601 writes them; empty if they are not asked for.
  std::string_view text_of(std::int64_t time_ns) {
    if ((!utc_ && !local_) || time_ns == kNoTime) return {};
    constexpr std::int64_t kSecondNs = 1'000'000'000;
    const std::int64_t rest = time_ns % kSecondNs;
    const std::int64_t part = rest < 0 ? rest + kSecondNs : rest;
    const std::time_t seconds = time_ns / kSecondNs - (rest < 0);
    std::tm day{};
    const bool known =
        (utc_ ? ::gmtime_r(&seconds, &day) : ::localtime_r(&seconds, &day)) != nullptr;
    if (!known) return {};
    char date[32];
    char zone[8] = "Z";
    std::strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%S", &day);
    if (local_) std::strftime(zone, sizeof zone, "%z", &day);
    text_ = part % 1000 ? fmt::format("{}.{:09}{}", date, part, zone)
                        : fmt::format("{}.{:06}{}", date, part / 1000, zone);
    return text_;
  }

 private:
  bool none_;
  bool relative_;
  bool delta_;
  bool utc_;
  bool local_;
  std::string text_;
  std::int64_t reference_ns_ = kNoPrevious;
};

/// One run of the subcommand.
class Decode {
 public:
  explicit Decode(const DecodeOptions& options)
      : options_(options),
        protocol_(cli::chosen_protocol(options.input)),
        decoder_(protocol_, cli::chosen_message(options.input, protocol_)),
        others_(protocol_),
        formatter_(make_formatter(options, protocol_)),
        filter_(make_filter(options, protocol_)),
        clock_(options.time) {}

  int run() {
    if (!options_.write.path.empty()) {
      const bool grows = cli::goes_on(options_.input);
      cli::check_write(options_.write, cli::all_inputs(options_.input), grows);
      capture_.emplace(options_.write.path,
                       grows ? options_.write.growing() : lines::CaptureFile::Mode::kWhole,
                       cli::rotation_of(options_.write));
    }
    formatter_->begin(output_.buffer());
    const cli::InputResult result = cli::read_packets(
        options_.input,
        [this](const Packet& packet, const cli::Source& source) { return take(packet, source); },
        [this] { output_.flush(); });
    const bool written = output_.finish();
    if (result.live) {
      text::print(stderr, "rubric: {} frames, {} malformed, {} shown\n", index_, malformed_count_,
                  printed_);
    }
    // A source that cannot be had costs no file.
    const bool kept = !capture_ || (result.failed && !capture_->is_started()) || capture_->finish();
    if (!written || !kept) return cli::kExitOutput;
    if (result.failed) return cli::kExitInput;
    return malformed_ ? cli::kExitFindings : cli::kExitClean;
  }

  // Returns the counts of what was read, as members of a JSON object.
  std::string counts() const {
    return fmt::format(R"("frames":{},"malformed":{},"shown":{})", index_, malformed_count_,
                       printed_);
  }

 private:
  bool take(const Packet& packet, const cli::Source& source) {
    decoder_.decode(packet, frame_);
    others_.look(frame_);
    const bool noted = options_.strict && frame_.decoded.note_count() != 0;
    malformed_ = malformed_ || frame_.malformed() || noted;
    malformed_count_ += frame_.malformed();
    if (capture_) capture_->write(packet, source.interface_name);
    record_.index = index_++;
    record_.number = source.number;
    record_.frame = &frame_;
    record_.interface_name = source.interface_name;
    record_.time_ns = packet.time_ns;
    if (filter_ && !filter_->matches(record_)) return true;
    record_.time_ns = clock_.shown(packet.time_ns);
    record_.time_text = clock_.text_of(packet.time_ns);
    formatter_->print(record_, output_.buffer());
    ++printed_;
    return output_.drain() && printed_ != options_.count;
  }

  const DecodeOptions& options_;
  const reflect::Protocol& protocol_;
  reflect::FrameDecoder decoder_;
  cli::OtherSpecs others_;
  std::unique_ptr<format::Formatter> formatter_;
  std::optional<format::Filter> filter_;
  Clock clock_;
  cli::Output output_;
  reflect::Frame frame_;
  format::Record record_;
  std::uint64_t index_ = 0;
  std::uint64_t printed_ = 0;
  std::uint64_t malformed_count_ = 0;
  bool malformed_ = false;
  std::optional<lines::CaptureFile> capture_;
};

// Decodes each file as a run of its own, and shows what was read of it.
int decode_each(const DecodeOptions& options) {
  for (const std::string& file : options.input.files) {
    if (options.input.follow || lines::parse_address(file)) {
      throw cli::UsageError("--each", "is for runs that are over");
    }
  }
  if (!options.write.path.empty())
    throw cli::UsageError("--write", "of which run? --each has many");
  Decode{options};  // Finds what makes no sense before the first run.
  const cli::InputOptions& in = options.input;
  const std::string settings =
      fmt::format("{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}", in.format, in.fcs, fmt::join(in.links, " "),
                  in.spec, in.as_message, options.filter, options.count, options.strict);
  const cli::EachJob job{"decode", settings};
  return cli::each(options.each, job, in.files, "-",
                   [&](const std::string& file, std::string& members) {
                     DecodeOptions one = options;
                     one.input.files = {file};
                     one.input.progress = false;
                     Decode decode(one);
                     const int code = decode.run();
                     if (code <= cli::kExitFindings) members = decode.counts();
                     return code;
                   });
}

int run_decode(const DecodeOptions& options) {
  cli::check_each(options.each);
  const bool each = options.each.each && !options.input.files.empty();
  return each ? decode_each(options) : Decode(options).run();
}

}  // namespace

void add_decode(cli::Command& app) {
  cli::Command& command = app.add_subcommand("decode", "Print what captures hold, a line a frame");
  auto options = std::make_shared<DecodeOptions>();
  cli::add_input_options(command, options->input);
  cli::add_live_options(command, options->input);
  command.add_option("--format", options->format, "Print text, jsonl (rubric.decode/1) or csv")
      .one_of({"text", "jsonl", "csv"})
      .show_default();
  command.add_option("--filter", options->filter,
                     "Print only frames for which this holds: message==updates && src.devid==4");
  command.add_option("--fields", options->fields, "Print only these fields, as in a.b,c");
  command
      .add_option("--time", options->time,
                  "Print times as epoch (seconds, as captured), utc or local (dates), relative "
                  "(since the first line), delta (since the line before) or none")
      .one_of({"epoch", "utc", "local", "relative", "delta", "none"})
      .show_default();
  command.add_option("--count", options->count, "Stop after this many lines")
      .check(cli::at_least_one);
  command.add_flag("--hex", options->hex, "Print a hex dump below each line of text");
  command.add_flag("--strict", options->strict, "End with 1 for noted frames, too");
  command.add_flag("--units", options->units, "Show values in their units, such as degrees C");
  cli::add_write_options(command, options->write, "Keep all frames in this pcapng file as well",
                         true);
  cli::add_each_options(command, options->each);
  cli::add_color_option(command, options->color);
  command.footer(
      "Examples:\n"
      "  rubric decode capture.pcapng --filter 'message==updates && src.devid==4'\n"
      "  rubric decode mote.serial.bin --format jsonl | jq .message\n"
      "  rubric decode capture.pcapng --format csv --fields time,src.devid,updates.value\n"
      "  echo 0a000c | rubric decode --as config\n"
      "  rubric decode --each 'captures/*.pcapng' --shard 1/4    # counts, a line of JSON a run\n"
      "  rubric decode serial@/dev/ttyUSB0:telosb --write run.pcapng    # until Ctrl-C\n"
      "Exit codes: 0 clean, 1 something malformed was read, 64 usage, 66 input cannot be read,\n"
      "74 output cannot be written.");
  command.exit_code_of([options] { return run_decode(*options); });
}

}  // namespace rubric::tools
