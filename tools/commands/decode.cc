#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <ctime>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

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
#include "tools/cli/terminal.h"
#include "tools/cli/write_options.h"
#include "tools/commands/commands.h"
#include "tools/commands/decode_threads.h"
#include "tools/format/csv.h"
#include "tools/format/filter.h"
#include "tools/format/jsonl.h"
#include "tools/format/text.h"

namespace rubric::tools {
namespace {

constexpr std::uintmax_t kLongBytes = 64 * 1024 * 1024;  // Captures that all cores decode.
constexpr std::uint64_t kThreadsMost = 256;

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
  std::optional<std::size_t> width;  ///< Of text; 0: lines are as long as they are.
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
  format::TextOptions text{.color = cli::use_color(options.color, 1),
                           .hex = options.hex,
                           .units = options.units,
                           .width = options.width.value_or(cli::screen_columns(1)),
                           .fields = std::move(fields)};
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
    if (reference_ns_ == kNoTime) reference_ns_ = time_ns;
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
  std::int64_t reference_ns_ = kNoTime;
};

/// Decodes packets and prints them; each thread has its own.
class FramePrinter {
 public:
  FramePrinter(const DecodeOptions& options, const reflect::Protocol& protocol)
      : strict_(options.strict),
        decoder_(protocol, cli::chosen_message(options.input, protocol)),
        others_(protocol),
        formatter_(make_formatter(options, protocol)),
        filter_(make_filter(options, protocol)),
        clock_(options.time) {}

  void begin(format::Buffer& out) { formatter_->begin(out); }

  void print(const Packet& packet, format::Record record, format::Buffer& out, DecodedPart& part) {
    decoder_.decode(packet, frame_);
    others_.look(frame_, part.hints);
    const bool noted = strict_ && frame_.decoded.note_count() != 0;
    ++part.frames;
    part.malformed += frame_.malformed();
    part.bad = part.bad || frame_.malformed() || noted;
    record.frame = &frame_;
    record.time_ns = packet.time_ns;
    if (filter_ && !filter_->matches(record)) return;
    record.time_ns = clock_.shown(packet.time_ns);
    record.time_text = clock_.text_of(packet.time_ns);
    formatter_->print(record, out);
    ++part.shown;
  }

 private:
  const bool strict_;
  reflect::FrameDecoder decoder_;
  cli::OtherSpecs others_;
  std::unique_ptr<format::Formatter> formatter_;
  std::optional<format::Filter> filter_;
  Clock clock_;
  reflect::Frame frame_;
};

// Returns how many threads decode the input; 1: it is done without others.
std::size_t threads_for(const DecodeOptions& options) {
  // What a line shows depends on the line before it, or on how many there are.
  const bool in_line = options.count != 0 || options.time == "relative" || options.time == "delta";
  if (in_line || !options.write.path.empty() || cli::goes_on(options.input)) return 1;
  if (options.each.jobs != 0) return std::min(options.each.jobs, kThreadsMost);
  std::uintmax_t bytes = 0;
  for (const std::string& file : options.input.files) {
    std::error_code ignored;
    const std::uintmax_t size = std::filesystem::file_size(file, ignored);
    if (!ignored) bytes += size;
  }
  return bytes < kLongBytes ? 1 : std::max(1U, std::thread::hardware_concurrency());
}

/// One run of the subcommand.
class Decode {
 public:
  explicit Decode(const DecodeOptions& options)
      : options_(options),
        protocol_(cli::chosen_protocol(options.input)),
        printer_(options, protocol_) {}

  int run() {
    cli::InputOptions input = options_.input;
    if (!options_.write.path.empty()) {
      const bool grows = cli::goes_on(input);
      cli::check_write(options_.write, cli::all_inputs(input), grows);
      cli::open_sources(input);
      capture_.emplace(options_.write.path,
                       grows ? options_.write.growing() : lines::CaptureFile::Mode::kWhole,
                       cli::rotation_of(options_.write));
    }
    printer_.begin(output_.buffer());
    if (const std::size_t count = threads_for(options_); count > 1) begin_threads(count);
    const cli::InputResult result = cli::read_packets(
        input,
        [this](const Packet& packet, const cli::Source& source) { return take(packet, source); },
        [this] { output_.flush(); });
    if (threads_) threads_->finish();
    const bool written = output_.finish();
    if (result.live) {
      text::print(stderr, "rubric: {} frames, {} malformed, {} shown\n", sum_.frames,
                  sum_.malformed, sum_.shown);
    }
    // A source that cannot be had costs no file.
    const bool kept = !capture_ || (result.failed && !capture_->is_started()) || capture_->finish();
    if (!written || !kept) return cli::kExitOutput;
    if (result.failed) return cli::kExitInput;
    return sum_.bad ? cli::kExitFindings : cli::kExitClean;
  }

  // Returns the counts of what was read, as members of a JSON object.
  std::string counts() const {
    return fmt::format(R"("frames":{},"malformed":{},"shown":{})", sum_.frames, sum_.malformed,
                       sum_.shown);
  }

 private:
  void begin_threads(std::size_t count) {
    const auto make = [this]() -> DecodeThreads::Decode {
      auto printer = std::make_shared<FramePrinter>(options_, protocol_);
      return [printer](const Packet& packet, const format::Record& record, format::Buffer& out,
                       DecodedPart& part) { printer->print(packet, record, out, part); };
    };
    output_.flush();  // What comes before the first frame.
    threads_.emplace(count, make, [this](format::Buffer& out, const DecodedPart& part) {
      std::swap(output_.buffer(), out);
      const bool written = output_.flush();
      std::swap(output_.buffer(), out);
      say(part.hints);
      sum_.frames += part.frames;
      sum_.malformed += part.malformed;
      sum_.shown += part.shown;
      sum_.bad = sum_.bad || part.bad;
      return written;
    });
  }

  bool take(const Packet& packet, const cli::Source& source) {
    format::Record record{
        .index = index_++, .number = source.number, .interface_name = source.interface_name};
    if (threads_) return threads_->add(packet, record);
    printer_.print(packet, record, output_.buffer(), sum_);
    if (!sum_.hints.empty()) say(std::exchange(sum_.hints, {}));
    if (capture_) capture_->write(packet, source.interface_name);
    return output_.drain() && (options_.count == 0 || sum_.shown < options_.count);
  }

  void say(const std::vector<cli::OtherSpecs::Hint>& hints) {
    for (const cli::OtherSpecs::Hint& hint : hints) {
      if (said_.insert(hint.about).second) text::print_harmless(stderr, hint.text);
    }
  }

  const DecodeOptions& options_;
  const reflect::Protocol& protocol_;
  FramePrinter printer_;
  cli::Output output_;
  std::uint64_t index_ = 0;
  DecodedPart sum_;
  std::set<int> said_;
  std::optional<lines::CaptureFile> capture_;
  std::optional<DecodeThreads> threads_;  // Ends before all that it uses.
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
  const std::string settings = fmt::format(
      "{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}", in.format, in.fcs, fmt::join(in.links, " "), in.spec,
      in.as_message, options.filter, options.count, options.strict, cli::text_of_spec(in.spec));
  cli::EachJob job{"decode", settings};
  if (in.spec != "none") job.prepare = cli::read_all_specs;  // Without a spec none is looked for.
  return cli::each(options.each, job, in.files, "-",
                   [&](const std::string& file, std::string& members) {
                     DecodeOptions one = options;
                     one.input.files = {file};
                     one.input.progress = false;
                     one.each.jobs = 1;
                     Decode decode(one);
                     const int code = decode.run();
                     if (code <= cli::kExitFindings) members = decode.counts();
                     return code;
                   });
}

int run_decode(const DecodeOptions& options) {
  cli::EachOptions others = options.each;
  others.jobs = 0;  // Has a meaning of its own here.
  cli::check_each(others);
  const bool each = options.each.each && !options.input.files.empty();
  return each ? decode_each(options) : Decode(options).run();
}

}  // namespace

void add_decode(cli::Command& app) {
  cli::Command& command = app.add_subcommand("decode", "Print what captures hold, a line a frame");
  auto options = std::make_shared<DecodeOptions>();
  cli::add_input_options(command, options->input);
  cli::add_live_options(command, options->input);
  command
      .add_option("--format", options->format,
                  "Print text, jsonl (rubric.decode/1) or csv, which needs "
                  "--fields to have a message's fields")
      .one_of({"text", "jsonl", "csv"});
  command.add_option("--filter", options->filter,
                     "Print only frames for which this holds: message==updates && src.devid==4");
  command.add_option("--fields", options->fields, "Print only these fields, as in a.b,c");
  command
      .add_option("--time", options->time,
                  "Print times as epoch (seconds, as captured), utc or local (dates), relative "
                  "(since the first line), delta (since the line before) or none")
      .one_of({"epoch", "utc", "local", "relative", "delta", "none"});
  command.add_option("--count", options->count, "Stop after this many lines (default: at the end)")
      .check(cli::at_least_one);
  command.add_flag("--hex", options->hex, "Print a hex dump below each line of text");
  command.add_flag("--strict", options->strict, "End with 1 for noted frames, too");
  command.add_flag("--units", options->units, "Show values in their units, such as degrees C");
  command
      .add_option("--width", options->width,
                  "Wrap text at this many columns, 0: nowhere (default: the terminal's, else 0)")
      .check(cli::whole_number);
  cli::add_write_options(command, options->write, "Keep all frames in this pcapng file as well",
                         true);
  cli::add_each_options(command, options->each);
  command.get_option("--jobs").description(
      "Decode with so many threads, with --each so many runs at a time (default: as many as there "
      "are cores; for captures under 64 MB 1)");
  cli::add_color_option(command, options->color);
  command.footer(
      "Examples:\n"
      "  rubric decode capture.pcapng --filter 'message==updates && src.devid==4'\n"
      "  rubric decode mote.serial.bin --format jsonl | jq .message\n"
      "  rubric decode capture.pcapng --format csv --fields time,src.devid,updates.value\n"
      "  echo 0a000c | rubric decode --as config\n"
      "  rubric decode --each 'captures/*.pcapng' --shard 1/4    # counts, a line of JSON a run\n"
      "  rubric decode serial@/dev/ttyUSB0:telosb --write run.pcapng    # until Ctrl-C\n"
      "Exit codes: 0 clean, 1 something malformed was read, 64 usage, 66 input cannot be read, or\n"
      "is damaged or cut, 74 output cannot be written; with --each 2 a run's process was killed.");
  command.exit_code_of([options] { return run_decode(*options); });
}

}  // namespace rubric::tools
