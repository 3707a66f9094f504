#include "tools/encode.h"

#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <optional>
#include <system_error>

#include "codec/reflect/encode_number.h"
#include "codec/reflect/registry.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/input.h"
#include "tools/record/carriers.h"
#include "tools/record/json.h"
#include "tools/record/lines.h"
#include "tools/record/packet_output.h"
#include "tools/record/record.h"

namespace rubric::tools {
namespace {

using record::OwnedPacket;
using reflect::Value;

// What the frames of a message that comes alone say, where the command line says nothing else.
constexpr int kBroadcast = 0xffff;
constexpr int kSerialGroup = 0;
constexpr int kRadioGroup = 0x22;   // TinyOS's default.
constexpr int kRadioFcf = 0x8841;   // Data, short addresses, one PAN, no acknowledgement wanted.

struct Options {
  cli::InputOptions input;
  std::string format = "hex";
  std::string output = "-";
  std::string carrier;
  std::optional<int> am_type;
  std::optional<int> dest;
  std::optional<int> src;
  std::optional<int> group;
};

constexpr const char* kFooter =
    "A line with \"raw\" is encoded from it. Where it also has \"fields\" and is not marked\n"
    "malformed, both must say the same: delete \"raw\", and \"crc\" or \"fcs\" in\n"
    "\"frame\", to encode changed fields. Sizes, counts and check sums that are missing are\n"
    "computed. A message alone:\n"
    "  echo '{\"type\":10,\"value\":12}' | rubric encode --as config\n"
    "Exit codes: 0 all lines encoded, 2 usage, 3 some line or file could not be read or encoded.";

/// Turns a line into a packet; throws record::RecordError.
class LineEncoder {
 public:
  LineEncoder(const Options& options, const reflect::Protocol& protocol,
              const reflect::Type* message)
      : options_(options), protocol_(protocol), message_(message), reader_(protocol) {
    if (message_) wrap_ = around();
  }

  void encode(const Value& line, OwnedPacket& out) {
    if (!message_) return reader_.read(line, out);
    if (!line.is(Value::Kind::kObject)) {
      throw record::RecordError(
          "", fmt::format("expected an object with the fields of {}, given {}", message_->name,
                          reflect::value_text(line)));
    }
    Value whole = wrap_;
    whole.set("fields", line);
    if (framing_ == "radio") {
      // Every frame of a node takes the next number.
      const Value& frame = *wrap_.find("frame");
      whole.items[frame_index_] = frame;
      whole.items[frame_index_].set("dsn", Value::of_integer(next_dsn_++ & 0xff));
    }
    reader_.read(whole, out);
  }

 private:
  std::string_view carrier_name() const {
    if (!options_.carrier.empty()) return options_.carrier;
    const auto reaches = [&](const char* name) {
      const reflect::Type* carrier = reflect::find_carrier(protocol_, name);
      return carrier && record::am_type_on(*carrier, *message_);
    };
    return !reaches("serial") && reaches("radio_i") ? "radio" : "serial";
  }

  std::int64_t am_type(std::string_view carrier_name) const {
    if (options_.am_type) return *options_.am_type;
    const reflect::Type* carrier =
        reflect::find_carrier(protocol_, carrier_name == "radio" ? "radio_i" : "serial");
    if (carrier) {
      if (const auto type = record::am_type_on(*carrier, *message_)) return *type;
    }
    throw CLI::ValidationError(
        "--as", fmt::format("no AM type carries {} itself on {}; give --am-type, encode the "
                            "message that it travels in, or use --carrier none "
                            "('rubric explain {}' says more)",
                            message_->name, carrier_name == "radio" ? "the radio" : "serial lines",
                            message_->id));
  }

  // The line around the fields.
  Value around() {
    const std::string_view carrier = carrier_name();
    const bool radio = carrier == "radio";
    const bool in_capture = options_.format == "pcap" || options_.format == "pcapng";
    framing_ = carrier == "none"                         ? "bare"
               : radio                                   ? "radio"
               : options_.format == "hdlc" || in_capture ? "hdlc"
                                                         : "sf";
    Value line = Value::of_object();
    line.set("schema", Value::of_string(record::kSchema));
    line.set("framing", Value::of_string(framing_));
    line.set("path", Value::of_array({Value::of_string(message_->id)}));
    if (framing_ == "bare") return line;
    const auto number = [](std::int64_t value) { return Value::of_integer(value); };
    const int group = options_.group.value_or(radio ? kRadioGroup : kSerialGroup);
    Value am = Value::of_object();
    am.set("dest", number(options_.dest.value_or(kBroadcast)));
    am.set("src", number(options_.src.value_or(0)));
    am.set("group", number(group));
    am.set("type", number(am_type(carrier)));
    line.set("am", std::move(am));
    Value frame = Value::of_object();
    if (radio) {
      frame.set("fcf", number(kRadioFcf));
      frame.set("destpan", number(group));
    }
    frame_index_ = line.items.size();
    line.set("frame", std::move(frame));
    return line;
  }

  const Options& options_;
  const reflect::Protocol& protocol_;
  const reflect::Type* message_;
  record::RecordReader reader_;
  Value wrap_;
  std::string_view framing_;
  std::size_t frame_index_ = 0;
  int next_dsn_ = 0;
};

/// One run over all lines of all files.
class Run {
 public:
  Run(const Options& options, LineEncoder& encoder, record::PacketOutput& output)
      : encoder_(encoder), output_(output), files_(options.input.files) {
    if (files_.empty()) files_.emplace_back("-");
    as_message_ = !options.input.as_message.empty();
  }

  bool all() {
    for (const std::string& name : files_) {
      file_ = name == "-" ? "stdin" : name;
      try {
        record::Lines lines(name);
        one(lines);
      } catch (const std::system_error& error) {
        fmt::print(stderr, "rubric: {}: {}\n", file_, error.code().message());
        good_ = false;
      }
    }
    return good_;
  }

  /// Whether there was anything to encode.
  bool any() const { return any_; }

 private:
  void complain(const std::string& place, const std::string& what) {
    fmt::print(stderr, "rubric: {}: {}\n", place, what);
    good_ = false;
  }

  void one(record::Lines& lines) {
    std::string_view line;
    while (output_.open() && lines.next(line)) {
      if (line.find_first_not_of(" \t") == std::string_view::npos) continue;
      any_ = true;
      const std::string place = fmt::format("{}:{}", file_, lines.number());
      if (lines.too_long()) {
        complain(place, fmt::format("expected a line of at most {} bytes", lines.kMaxBytes));
        continue;
      }
      try {
        encoder_.encode(record::parse_json(line), packet_);
        put(place);
      } catch (const record::JsonError& error) {
        complain(fmt::format("{}:{}", place, error.column()), error.what());
      } catch (const record::RecordError& error) {
        std::string what = error.what();
        if (as_message_ && what.starts_with("fields.")) what.erase(0, sizeof("fields.") - 1);
        complain(place, what);
      }
    }
  }

  void put(const std::string& place) {
    const Packet packet = packet_.view();
    const std::string refused = output_.write(packet, packet_.interface_name);
    if (!refused.empty()) complain(place, refused);
    if (output_.cut_refused()) {
      complain(last_place_, "a frame that was cut can only be the last of a stream");
    }
    last_place_ = place;
  }

  LineEncoder& encoder_;
  record::PacketOutput& output_;
  std::vector<std::string> files_;
  std::string file_;
  std::string last_place_;
  OwnedPacket packet_;
  bool as_message_ = false;
  bool good_ = true;
  bool any_ = false;
};

int run(const Options& options) {
  const reflect::Protocol& protocol = cli::chosen_protocol(options.input);
  const reflect::Type* message = cli::chosen_message(options.input, protocol);
  LineEncoder encoder(options, protocol, message);
  try {
    record::PacketOutput output(options.format, options.output);
    Run run(options, encoder, output);
    const bool good = run.all();
    // A name that was mistyped must not cost the file that would have been replaced.
    if (!good && !run.any()) return cli::kExitInput;
    const std::string failure = output.finish();
    if (failure.empty()) return good ? cli::kExitClean : cli::kExitInput;
    fmt::print(stderr, "rubric: {}: {}\n", options.output, failure);
  } catch (const std::system_error& error) {
    fmt::print(stderr, "rubric: {}: {}\n", options.output, error.code().message());
  }
  return cli::kExitInput;
}

void check_target(const Options& options) {
  if (record::overwrites(options.output, options.input.files)) {
    throw CLI::ValidationError("--output", "'" + options.output + "' is also the input");
  }
}

void check_wrapping(const Options& options) {
  const bool wrapping = options.am_type || options.dest || options.src || options.group ||
                        !options.carrier.empty();
  if (wrapping && options.input.as_message.empty()) {
    throw CLI::ValidationError("--carrier, --am-type, --dest, --src, --group",
                               "go with --as MESSAGE; a line of rubric decode has its own frame");
  }
}

}  // namespace

void add_encode(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* sub = app.add_subcommand(
      "encode", "Frames from the JSON lines of 'rubric decode', or from fields alone");
  sub->footer(kFooter);
  sub->add_option("FILE", options->input.files, "JSON lines; none or - is stdin");
  sub->add_option("--format", options->format, "What to write: hex, hdlc, sf, pcap, pcapng")
      ->check(CLI::IsMember(record::container_names()))
      ->capture_default_str();
  sub->add_option("-o,--output", options->output, "Where to; - is stdout")
      ->check(cli::given())
      ->capture_default_str();
  sub->add_option("--spec", options->input.spec, "Protocol above the AM layer")
      ->capture_default_str();
  sub->add_option("--as", options->input.as_message,
                  "Each line is the fields of this message, which is put into a frame")
      ->check(cli::given());
  sub->add_option("--carrier", options->carrier,
                  "With --as, the frame: serial, radio, or none (default: what carries it)")
      ->check(CLI::IsMember({"serial", "radio", "none"}));
  sub->add_option("--am-type", options->am_type, "With --as, the AM type (default: its own)")
      ->check(CLI::Range(0, 0xff));
  sub->add_option("--dest", options->dest, "With --as, the AM destination (default: broadcast)")
      ->check(CLI::Range(0, 0xffff));
  sub->add_option("--src", options->src, "With --as, the AM source (default: 0)")
      ->check(CLI::Range(0, 0xffff));
  sub->add_option("--group", options->group,
                  "With --as, the AM group (default: 0 on serial lines, 0x22 on the radio)")
      ->check(CLI::Range(0, 0xff));
  sub->callback([options] {
    check_wrapping(*options);
    check_target(*options);
    const int code = run(*options);
    if (code != cli::kExitClean) cli::exit_with(code);
  });
}

}  // namespace rubric::tools
