#include "tools/encode/line_encoder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>

#include "codec/containers/hex_reader.h"
#include "codec/generated/tinyos/enums.h"
#include "codec/lines/stop.h"
#include "codec/reflect/encode_number.h"
#include "codec/reflect/registry.h"
#include "codec/text/text.h"
#include "tools/cli/specs.h"
#include "tools/cli/terminal.h"
#include "tools/encode/carriers.h"
#include "tools/encode/members.h"

namespace rubric::encode {

using reflect::Value;

namespace {

// Defaults of the frames around a single message, unless the command line gives others.
constexpr int kBroadcast = 0xffff;
constexpr int kSerialGroup = 0;
constexpr int kRadioGroup = 0x22;  // TinyOS's default.

constexpr std::size_t kChunkBytes = 256 * 1024;
constexpr std::string_view kHexIsNoJson =
    "hex digits, no JSON; 'rubric convert' reads frames as hex, and 'rubric decode --format jsonl' "
    "prints them as JSON lines";

bool is_hex(std::string_view line) {
  std::vector<std::uint8_t> bytes;
  const Bytes text(reinterpret_cast<const std::uint8_t*>(line.data()), line.size());
  return decode_hex_line(text, bytes).fault == Fault::kNone && !bytes.empty();
}

}  // namespace

LineEncoder::LineEncoder(const LineOptions& options, const reflect::Protocol& protocol,
                         const reflect::Type* message, std::string_view serial_framing)
    : options_(options),
      protocol_(protocol),
      message_(message),
      serial_framing_(serial_framing),
      reader_(protocol) {
  if (message_) wrap_ = around();
}

void LineEncoder::encode(const Value& line, OwnedPacket& out) {
  if (!message_) return reader_.read(line, out);
  if (!line.is(Value::Kind::kObject)) {
    throw RecordError("", fmt::format("expected an object with the fields of {}, given {}",
                                      message_->name, reflect::value_text(line)));
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

std::string LineEncoder::way_out(const Value& line) const {
  if (message_ || !line.is(Value::Kind::kObject)) return {};
  if (!line.find("schema")) return "; --as MESSAGE reads the fields of a message alone";
  const Value* const name = line.find("message");
  if (!name || !name->is(Value::Kind::kString)) return {};
  if (reflect::find_type(protocol_, name->text)) return {};
  const std::string has_it = cli::spec_with_message(protocol_, name->text);
  return has_it.empty() ? "" : fmt::format("; {} has no {}{}", protocol_.id, name->text, has_it);
}

std::string_view LineEncoder::carrier_name() const {
  if (options_.to_line) return "serial";
  if (!options_.carrier.empty()) return options_.carrier;
  const auto reaches = [&](const char* name) {
    const reflect::Type* carrier = reflect::find_carrier(protocol_, name);
    return carrier && am_type_on(*carrier, *message_);
  };
  return !reaches("serial") && reaches("radio_i") ? "radio" : "serial";
}

std::int64_t LineEncoder::am_type(std::string_view carrier_name) const {
  if (options_.am_type) return *options_.am_type;
  const reflect::Type* carrier =
      reflect::find_carrier(protocol_, carrier_name == "radio" ? "radio_i" : "serial");
  if (carrier && !reflect::has_tinyos_headers(*carrier)) {
    throw cli::UsageError(
        "--as", fmt::format("{} is in frames with headers of their own; encode lines as 'rubric "
                            "decode --format jsonl' prints them, or use --carrier none",
                            message_->name));
  }
  if (carrier) {
    if (const auto type = am_type_on(*carrier, *message_)) return *type;
  }
  throw cli::UsageError(
      "--as", fmt::format("no AM type carries {} itself on {}; give --am-type, {} the message that "
                          "it travels in{} ('rubric explain {}' says more)",
                          message_->name, carrier_name == "radio" ? "the radio" : "serial lines",
                          options_.to_line ? "or send" : "encode",
                          options_.to_line ? "" : ", or use --carrier none", message_->id));
}

// Returns the line around the fields.
Value LineEncoder::around() {
  const std::string_view carrier = carrier_name();
  const bool radio = carrier == "radio";
  framing_ = carrier == "none" ? "bare" : radio ? "radio" : serial_framing_;
  Value line = Value::of_object();
  line.set("schema", Value::of_string(kSchema));
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
    frame.set("fcf", number(static_cast<std::int64_t>(tinyos::FrameControl::kData)));
    frame.set("destpan", number(group));
  }
  frame_index_ = line.items.size();
  line.set("frame", std::move(frame));
  return line;
}

EncodedLines::EncodedLines(const LineOptions& options, LineEncoder& encoder, OnPacket on_packet,
                           Lines::BeforeRead before_read)
    : encoder_(encoder),
      on_packet_(std::move(on_packet)),
      before_read_(std::move(before_read)),
      files_(options.input.files),
      as_message_(!options.input.as_message.empty()) {
  if (files_.empty()) files_.emplace_back("-");
}

bool EncodedLines::all() {
  for (const std::string& name : files_) {
    if (ended_) break;
    file_ = name == "-" ? "stdin" : name;
    if (name == "-") cli::say_what_is_awaited();
    try {
      Lines lines(name, before_read_);
      encode_next(lines);
      if (lines.number() == 0 && !lines::stop_requested()) {
        text::print(stderr, "rubric: {}: is empty\n", file_);
      }
    } catch (const std::system_error& error) {
      complain(file_, error.code().message());
    }
  }
  return good_;
}

void EncodedLines::complain(const std::string& place, std::string_view what) {
  text::print(stderr, "rubric: {}: {}\n", place, what);
  good_ = false;
}

void EncodedLines::encode_next(Lines& lines) {
  std::string_view line;
  while (!ended_ && lines.next(line)) {
    if (line.find_first_not_of(" \t") == std::string_view::npos) continue;
    any_ = true;
    const std::string place = fmt::format("{}:{}", file_, lines.number());
    if (lines.too_long()) {
      complain(place, fmt::format("expected a line of at most {} bytes", lines.kMaxBytes));
      continue;
    }
    Value value;
    try {
      value = parse_json(line);
      encoder_.encode(value, packet_);
      ended_ = !on_packet_(*this, packet_, place);
    } catch (const JsonError& error) {
      complain(fmt::format("{}:{}", place, error.column()),
               is_hex(line) ? kHexIsNoJson : std::string_view(error.what()));
    } catch (const RecordError& error) {
      std::string what = error.what();
      if (as_message_ && what.starts_with("fields.")) what.erase(0, sizeof("fields.") - 1);
      complain(place, what + encoder_.way_out(value));
    }
  }
}

void add_line_options(cli::Command& app, LineOptions& options) {
  app.add_option("FILE", options.input.files, "JSON lines; none or - is stdin");
  cli::add_spec_option(app, options.input);
  app.add_option("--as", options.input.as_message,
                 "Read each line as the fields of this message, and put it into a frame");
  app.add_option("--am-type", options.am_type, "With --as, set the AM type (default: its own)")
      .between(0, 0xff);
  app.add_option("--dest", options.dest, "With --as, set the AM destination (default: broadcast)")
      .between(0, 0xffff);
  app.add_option("--src", options.src, "With --as, set the AM source (default: 0)")
      .between(0, 0xffff);
  app.add_option(
         "--group", options.group,
         options.to_line
             ? "With --as, set the AM group (default: 0)"
             : "With --as, set the AM group (default: 0 on serial lines, 0x22 on the radio)")
      .between(0, 0xff);
}

void add_carrier_option(cli::Command& app, LineOptions& options) {
  app.add_option(
         "--carrier", options.carrier,
         "With --as, choose the frame: serial, radio or none (default: what carries the message)")
      .one_of({"serial", "radio", "none"});
}

void check_line_options(const LineOptions& options) {
  const bool wrapping =
      options.am_type || options.dest || options.src || options.group || !options.carrier.empty();
  if (wrapping && options.input.as_message.empty()) {
    throw cli::UsageError(options.to_line ? "--am-type, --dest, --src, --group"
                                          : "--carrier, --am-type, --dest, --src, --group",
                          "go with --as MESSAGE; a line of rubric decode has its own frame");
  }
}

Lines::Lines(const std::string& name, BeforeRead before_read)
    : fd_(name == "-" ? 0 : ::open(name.c_str(), O_RDONLY | O_CLOEXEC)),
      before_read_(std::move(before_read)),
      chunk_(std::make_unique_for_overwrite<char[]>(kChunkBytes)) {
  if (fd_ < 0) throw std::system_error(errno, std::generic_category());
}

Lines::~Lines() {
  if (fd_ > 0) ::close(fd_);
}

bool Lines::fill() {
  while (true) {
    if (before_read_ && !before_read_(fd_)) return false;
    const ssize_t got = ::read(fd_, chunk_.get(), kChunkBytes);
    if (got >= 0) {
      rest_ = {chunk_.get(), static_cast<std::size_t>(got)};
      return got > 0;
    }
    if (errno != EINTR) throw std::system_error(errno, std::generic_category());
  }
}

bool Lines::next(std::string_view& line) {
  line_.clear();
  too_long_ = false;
  if (rest_.empty() && !fill()) return false;
  ++number_;
  while (true) {
    const std::size_t end = rest_.find('\n');
    const std::string_view piece = rest_.substr(0, end);
    const bool whole = end != std::string_view::npos;
    rest_.remove_prefix(whole ? end + 1 : rest_.size());
    if (whole && line_.empty()) {
      line = piece;
    } else {
      too_long_ = too_long_ || piece.size() > kMaxBytes - line_.size();
      if (!too_long_) line_ += piece;
      line = line_;
    }
    if (whole || (rest_.empty() && !fill())) break;
  }
  if (line.ends_with('\r')) line.remove_suffix(1);
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (number_ == 1 && line.starts_with(kByteOrderMark)) line.remove_prefix(kByteOrderMark.size());
  return true;
}

}  // namespace rubric::encode
