#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <iterator>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "codec/containers/pcapng_format.h"
#include "codec/containers/writer.h"
#include "codec/frame_generator/framer.h"
#include "codec/frame_generator/known_protocols.h"
#include "codec/reflect/fault_text.h"
#include "codec/reflect/suggest.h"
#include "codec/text/json.h"
#include "codec/text/text.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/input.h"
#include "tools/cli/output.h"
#include "tools/cli/specs.h"
#include "tools/commands/commands.h"
#include "tools/format/put.h"
#include "tools/format/record.h"

namespace rubric::tools {
namespace {

using generate::Framed;
using generate::FrameGenerator;
using generate::Framer;
using reflect::Route;
using text::Json;

Json error_json(const Error& error, const Json::Members& more = {}) {
  if (error.fault == Fault::kNone) return Json::raw("");
  Json::Members out = {{"fault", reflect::fault_name(error.fault)},
                       {"offset", error.offset_bytes},
                       {"requirement", reflect::requirement(error.requirement).id}};
  out.insert(out.end(), more.begin(), more.end());
  return Json::object(out);
}

Json number_json(const generate::NumberAt& number) {
  const std::string field = fmt::format("{}.{}", number.message->name, number.field->name);
  return Json::object({{"field", field}, {"offset", number.offset_bytes}, {"value", number.value}});
}

/// Returns the JSON line of a frame, schema rubric.generate/1, without its end. `offset`: where it
/// begins in its file, or null.
std::string expectation(std::uint64_t number, const std::string& offset, const Framed& framed,
                        bool with_fields) {
  const Json null = Json::raw("");
  const bool valid = framed.valid();
  std::string raw(2 * framed.bytes.size(), '0');
  format::put_hex(raw.data(), framed.view().bytes);
  Json::Members out = {
      {"schema", "rubric.generate/1"},
      {"number", number},
      {"offset", Json::raw(offset)},
      {"carrier", framed.route->carrier},
      {"framing", format::framing_name(framed.packet.framing)},
      {"message", framed.route->type->name},
      {"verdict", valid ? "valid" : "malformed"},
      {"path", valid ? Json::array(framed.path, &reflect::Type::name) : null},
      {"error", error_json(framed.error)},
      {"unfit", framed.unfit_message
                    ? error_json(framed.unfit, {{"message", framed.unfit_message->name}})
                    : null},
      {"what", framed.what}};
  if (with_fields) {
    out.emplace_back("fields", valid ? Json::array(framed.numbers, number_json) : null);
  }
  out.emplace_back("raw", raw);
  return Json::object(out).text();
}

/// Returns one line for people about the packet.
std::string comment(const Framed& framed) {
  if (framed.valid()) return "valid: " + framed.what;
  return fmt::format("malformed: {} at {} ({}): {}", reflect::fault_name(framed.error.fault),
                     framed.error.offset_bytes, reflect::requirement(framed.error.requirement).id,
                     framed.what);
}

constexpr double kFramingShare = 0.15;  // Share of the broken frames, if a format has framing.
constexpr std::int64_t kBetweenFramesNs = 1'000'000;
constexpr std::uint64_t kAckSeed = 0x61636B;  // The acknowledgement has a generator of its own.

struct GenerateOptions {
  cli::InputOptions input;  // Only the choice of the protocol.
  std::uint64_t count = 1000;
  std::uint64_t seed = 1;
  double valid = 0.7;
  std::string format = "jsonl";
  std::vector<std::string> messages;
  std::string output = "-";
  std::string expect;
  bool fields = false;
};

constexpr const char* kGenerateFooter =
    "Makes each message in turn, on each way that leads to it. The expectation of a frame (schema\n"
    "rubric.generate/1, see tools/commands/generate_format.md) says which fault is where, and by\n"
    "which rule; it is known by construction, without a decoder. jsonl has it with the frame in\n"
    "hex, pcapng as the packet's comment. hdlc, sf and hex hold no radio frames.\n"
    "The same options give the same bytes.\n"
    "Examples:\n"
    "  rubric generate --count 10000 --format hdlc -o frames.hdlc --expect frames.jsonl\n"
    "  rubric generate --valid 0 --message net_msg --format pcapng -o bad.pcapng\n"
    "  rubric generate --count 5 | jq -r '.verdict + \" \" + .what'\n"
    "Exit codes: 0 written, 64 usage, 74 output cannot be written.";

struct Container {
  const char* name;
  InputFormat format;
};
constexpr Container kContainers[] = {
    {"hdlc", InputFormat::kHdlc}, {"sf", InputFormat::kSf},       {"pcapng", InputFormat::kPcapng},
    {"hex", InputFormat::kHex},   {"jsonl", InputFormat::kJsonl},
};

std::vector<std::string> container_names() {
  std::vector<std::string> names;
  for (const Container& container : kContainers) names.emplace_back(container.name);
  return names;
}

InputFormat format_of(std::string_view name) {
  for (const Container& container : kContainers) {
    if (name == container.name) return container.format;
  }
  return InputFormat::kUnknown;
}

/// A message, and its routes that the format can hold.
struct Message {
  std::string name;
  std::vector<const Route*> routes;
  bool of_link = false;
};

void add_routes(const reflect::RouteTable& table, bool of_link, const Framer& framer,
                std::vector<Message>& messages) {
  for (int i = 0; i < table.count; ++i) {
    const Route& route = table.routes[i];
    const std::string_view name = route.type->name;
    auto known = std::find_if(messages.begin(), messages.end(),
                              [&](const Message& message) { return message.name == name; });
    if (known == messages.end()) {
      messages.push_back({std::string(name), {}, of_link});
      known = messages.end() - 1;
    }
    if (framer.holds(route)) known->routes.push_back(&route);
  }
}

/// A file or stdout that counts its input.
class CountedOutput {
 public:
  explicit CountedOutput(const std::string& path) : output_(path, cli::Output::Mode::kWhole) {}

  std::uint64_t size() const { return size_; }
  void append(std::string_view text) {
    size_ += text.size();
    output_.buffer().append(text);
    output_.drain();
  }
  bool open() const { return output_.open(); }
  bool finish() { return output_.finish(); }

 private:
  std::uint64_t size_ = 0;
  cli::Output output_;
};

/// One run.
class Run {
 public:
  Run(const GenerateOptions& options, const reflect::Protocol& protocol)
      : options_(options),
        format_(format_of(options.format)),
        frames_(protocol, cli::routes_of(protocol), options.seed),
        acks_(tinyos::tables::kProtocol, generate::kLinkAckRoutes, options.seed ^ kAckSeed),
        framer_(format_, frames_.random()) {
    add_routes(frames_.routes(), false, framer_, messages_);
    if (protocol.carrier_count != 0) {
      add_routes(acks_.routes(), true, framer_, messages_);
    } else if (format_ != InputFormat::kHex && format_ != InputFormat::kJsonl) {
      throw cli::UsageError("--format", fmt::format("{} holds frames, and {} has messages alone; "
                                                    "hex and jsonl do",
                                                    options.format, protocol.id));
    }
    choose_messages();
  }

  int run() {
    writer_ = make_writer(format_);
    CountedOutput out(options_.output);
    std::unique_ptr<CountedOutput> expect;
    if (!options_.expect.empty()) expect = std::make_unique<CountedOutput>(options_.expect);
    begin(out);
    for (std::uint64_t i = 0; i < options_.count && out.open(); ++i) {
      const std::string line = write_frame(i, out);
      if (expect) expect->append(line + "\n");
    }
    text_.clear();
    if (writer_) writer_->finish(text_);
    out.append(text_);
    const bool written = out.finish();
    const bool told = !expect || expect->finish();
    return written && told ? cli::kExitClean : cli::kExitOutput;
  }

 private:
  // Chooses the requested messages, or all that the format holds; in an order of the seed's.
  void choose_messages() {
    std::vector<std::string> names;
    for (const Message& message : messages_) names.push_back(message.name);
    for (const std::string& wanted : options_.messages) {
      if (std::find(names.begin(), names.end(), wanted) != names.end()) continue;
      throw cli::UsageError("--message", fmt::format("no frame leads to '{}'{}", wanted,
                                                     reflect::did_you_mean(wanted, names)));
    }
    std::vector<std::string> left_out;
    std::erase_if(messages_, [&](const Message& message) {
      const auto& asked = options_.messages;
      const bool named = std::find(asked.begin(), asked.end(), message.name) != asked.end();
      if (!asked.empty() && !named) return true;
      if (!message.routes.empty()) return false;
      if (named) refuse(message.name);
      left_out.push_back(message.name);
      return true;
    });
    if (!left_out.empty()) {
      text::print(stderr, "rubric: {} holds no radio frames: left out {}\n", options_.format,
                  fmt::join(left_out, ", "));
    }
    if (options_.count < messages_.size()) {
      text::print(stderr, "rubric: {} of {} messages do not come up; --count {} has them all\n",
                  messages_.size() - options_.count, messages_.size(), messages_.size());
    }
    for (std::size_t i = messages_.size(); i > 1; --i) {
      std::swap(messages_[i - 1], messages_[frames_.random().below(i)]);
    }
  }

  [[noreturn]] void refuse(const std::string& name) const {
    throw cli::UsageError(
        "--message", fmt::format("{} travels on the radio alone, and {} holds no radio frames; "
                                 "pcapng and jsonl do",
                                 name, options_.format));
  }

  void begin(CountedOutput& out) {
    text_.clear();
    if (writer_) writer_->begin(text_);
    out.append(text_);
  }

  Framed make(std::uint64_t index) {
    generate::Random& random = frames_.random();
    const Message& message = messages_[index % messages_.size()];
    const Route& route = *message.routes[random.below(message.routes.size())];
    FrameGenerator& generator = message.of_link ? acks_ : frames_;
    if (random.chance(options_.valid)) return framer_.sound(generator.valid(route));
    Framed framed;
    const bool last = index + 1 == options_.count;
    if (random.chance(kFramingShare) && framer_.broken(generator.valid(route), last, framed)) {
      return framed;
    }
    return framer_.sound(generator.near_valid(route));
  }

  /// Writes a frame; returns its expectation.
  std::string write_frame(std::uint64_t index, CountedOutput& out) {
    Framed framed = make(index);
    const std::uint64_t number = index + 1;
    if (!writer_) {
      std::string line = expectation(number, "null", framed, options_.fields);
      out.append(line + "\n");
      return line;
    }
    const std::string note = comment(framed);
    framed.packet.time_ns = static_cast<std::int64_t>(index) * kBetweenFramesNs;
    framed.packet.comment = note;
    const std::uint64_t begin = out.size();
    text_.clear();
    const bool radio = framed.packet.framing == Framing::kRadio;
    writer_->write(framed.view(), radio ? "radio" : "serial", text_);
    out.append(text_);
    return expectation(number, std::to_string(begin + frame_begin()), framed, options_.fields);
  }

  // Returns where the frame begins in the last output, as a reader counts.
  std::size_t frame_begin() const {
    if (format_ == InputFormat::kHdlc) return 1;  // After the flag.
    if (format_ != InputFormat::kPcapng) return 0;
    // A description of an interface may precede it.
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(text_.data());
    return pcapng::last_data_at(Bytes(bytes, text_.size()));
  }

  const GenerateOptions& options_;
  InputFormat format_;
  FrameGenerator frames_;
  FrameGenerator acks_;
  Framer framer_;
  std::vector<Message> messages_;
  std::unique_ptr<Writer> writer_;
  std::string text_;
};

std::string share(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (!text.empty() && *end == '\0' && value >= 0 && value <= 1) return {};
  return "expected a share from 0 to 1, given " + text;
}

void check_outputs(const GenerateOptions& options) {
  for (const std::string& file : cli::files_in(options.input.spec)) {
    cli::keep_apart("--out", options.output, {file});
    cli::keep_apart("--expect", options.expect, {file});
  }
  if (options.expect.empty()) return;
  if (options.format == "jsonl") {
    throw cli::UsageError("--expect", "jsonl carries the expectations in line");
  }
  cli::keep_apart("--expect", options.expect, {options.output});
}

}  // namespace

void add_generate(cli::Command& app) {
  auto options = std::make_shared<GenerateOptions>();
  cli::Command& sub = app.add_subcommand(
      "generate", "Generate valid and near-valid frames, and what a decoder must say of each");
  sub.footer(kGenerateFooter);
  sub.add_option("--count", options->count, "Make this many frames").check(cli::at_least_one);
  sub.add_option("--seed", options->seed, "Seed all that is left to chance")
      .check(cli::whole_number);
  sub.add_option("--valid", options->valid, "Make this share of the frames valid")
      .check(share, "SHARE");
  sub.add_option("--format", options->format, "Write hdlc, sf, pcapng, hex or jsonl")
      .one_of(container_names());
  cli::add_spec_option(sub, options->input);
  sub.add_option("--message", options->messages, "Make only these messages");
  sub.add_option("-o,--out", options->output, "Write to this file; - is stdout");
  sub.add_option("--expect", options->expect,
                 "Write the expectations to this file, a JSON line a frame");
  sub.add_flag("--fields", options->fields, "Add each number of a valid frame to its expectation");
  sub.exit_code_of([options] {
    check_outputs(*options);
    return Run(*options, cli::chosen_protocol(options->input)).run();
  });
}

}  // namespace rubric::tools
