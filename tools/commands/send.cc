#include <fmt/format.h>

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "codec/lines/sender.h"
#include "codec/lines/stop.h"
#include "codec/reflect/fault_text.h"
#include "codec/reflect/frame.h"
#include "codec/text/text.h"
#include "conformance/test/runner/target.h"
#include "tools/cli/color.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/output.h"
#include "tools/commands/commands.h"
#include "tools/encode/line_encoder.h"
#include "tools/format/jsonl.h"
#include "tools/format/text.h"

namespace rubric::tools {
namespace {

using encode::EncodedLines;
using encode::OwnedPacket;
using lines::Milliseconds;
using lines::SteadyTime;
using runner::TargetBroken;
using std::chrono::steady_clock;

constexpr int kWaitMostMs = 3'600'000;
constexpr int kRetriesMost = 10'000;
constexpr double kListenMostS = 86'400;

struct SendOptions {
  encode::LineOptions lines;
  std::string to;  ///< Empty: $MOTECOM.
  int timeout_ms = 1000;
  int retries = 24;
  int interval_ms = 0;
  bool keep_going = false;
  std::optional<double> listen_s;
  std::string format = "text";
  std::string color = "auto";
};

constexpr const char* kSendFooter =
    "Packets go one at a time. On a serial line each is sent again, as TinyOS hosts do, until the\n"
    "mote confirms it; what the mote wants confirmed is confirmed, too. A serial forwarder\n"
    "confirms nothing. Frames without a packet, such as confirmations, are left out.\n"
    "Examples:\n"
    "  echo '{\"type\":10,\"value\":12}' |\n"
    "    rubric send --as config --to serial@/dev/ttyUSB0:telosb\n"
    "  rubric send commands.jsonl --to sf@localhost:9002 --listen 2   # and what is answered\n"
    "  rubric decode run.pcapng --filter 'direction==inbound' --format jsonl | rubric send\n"
    "Exit codes: 0 all packets confirmed (or given to the forwarder), 3 a packet was not\n"
    "confirmed, or the line cannot be had or is gone, 64 usage, 66 some line or file could not be\n"
    "read or encoded, and was not sent.";

lines::Address address_of(const SendOptions& options) {
  const std::string text = options.to.empty() ? lines::default_address() : options.to;
  const char* const whence = options.to.empty() ? "$MOTECOM" : "--to";
  try {
    return lines::required_address(text);
  } catch (const std::invalid_argument& error) {
    throw cli::UsageError(whence, error.what());
  }
}

lines::HostLinkOptions link_options(const SendOptions& options) {
  return {.ack_wait = Milliseconds{options.timeout_ms}, .tries = options.retries + 1};
}

std::unique_ptr<format::Formatter> make_formatter(const SendOptions& options,
                                                  const reflect::Protocol& protocol) {
  if (options.format == "jsonl") {
    return std::make_unique<format::JsonlFormatter>(protocol, false, std::vector<format::Path>{});
  }
  format::TextOptions text{.color = cli::use_color(options.color, 1)};
  return std::make_unique<format::TextFormatter>(protocol, std::move(text));
}

std::string counted(int count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

/// One run of the subcommand.
class Send {
 public:
  Send(const SendOptions& options, lines::Address address)
      : options_(options),
        protocol_(cli::chosen_protocol(options.lines.input)),
        encoder_(options.lines, protocol_, cli::chosen_message(options.lines.input, protocol_),
                 "sf"),
        decoder_(protocol_),
        formatter_(make_formatter(options, protocol_)),
        name_(address.name),
        sender_(std::move(address), link_options(options),
                [this](const Packet& packet) { came(packet); }) {}

  int run() {
    lines::stop_on_signals();
    bool good = true;
    try {
      sender_.open();
      good = send_all();
      listening_ = true;
      if (options_.listen_s && !unsent_) {
        sender_.hear(steady_clock::now() + std::chrono::duration_cast<steady_clock::duration>(
                                               std::chrono::duration<double>(*options_.listen_s)));
      }
      sender_.close();
    } catch (const TargetBroken& error) {
      line_is_gone(error.what());
    }
    const bool written = output_.finish();
    summary();
    if (!written) return cli::kExitOutput;
    if (unsent_) return cli::kExitIncomplete;
    return good ? cli::kExitClean : cli::kExitInput;
  }

 private:
  bool send_all() {
    const auto wait_for_line = [this](int fd) {
      output_.flush();
      sender_.hear(SteadyTime::max(), fd);
      return !lines::stop_requested();
    };
    const auto send = [this](EncodedLines& lines, const OwnedPacket& packet,
                             const std::string& place) { return send_line(lines, packet, place); };
    EncodedLines lines(options_.lines, encoder_, send, wait_for_line);
    return lines.all();
  }

  // Returns why this cannot be sent, or nothing.
  std::string refusal(const Packet& packet) const {
    if (packet.framing == Framing::kRadio) return "expected a serial packet, given a radio frame";
    if (packet.framing == Framing::kBare) {
      return "expected a serial packet, given a message alone (--as MESSAGE takes its fields)";
    }
    if (packet.error.fault != Fault::kNone) {
      return fmt::format("a malformed frame cannot be sent as it is: {}",
                         reflect::fault_sentence(packet.error.fault));
    }
    const std::size_t max = sender_.packet_bytes_max();
    if (packet.bytes.size() <= max) return {};
    return fmt::format(
        "expected a packet of at most {} bytes from the dispatch byte on, as {} "
        "takes, given {}",
        max, sender_.confirms() ? "a mote's serial line" : "a serial forwarder",
        packet.bytes.size());
  }

  // Sends one packet. Returns whether to go on.
  bool send_line(EncodedLines& lines, const OwnedPacket& owned, const std::string& place) {
    const Packet packet = owned.view();
    const std::string why = refusal(packet);
    if (!why.empty()) {
      lines.complain(place, why);
      return true;
    }
    const bool has_packet = packet.framing == Framing::kSf || lines::brings_packet(packet);
    if (!has_packet || packet.bytes.empty()) {
      ++left_out_;
      return true;
    }
    if (packets_ > 0) sender_.hear(steady_clock::now() + Milliseconds{options_.interval_ms});
    if (lines::stop_requested()) {
      text::print(stderr, "rubric: {}: stopped before this was sent\n", place);
      unsent_ = true;
      return false;
    }
    const lines::Sender::Result result = sender_.send(packet.bytes);
    report(packet, result);
    if (!result.broken.empty()) throw TargetBroken(result.broken);
    if (result.done) return true;
    unsent_ = true;
    if (options_.keep_going && !lines::stop_requested()) return true;
    text::print(stderr, "rubric: {}: {}; nothing after it is sent{}\n", place,
                lines::stop_requested() ? "stopped" : "not confirmed",
                lines::stop_requested() ? "" : " (--keep-going would)");
    return false;
  }

  std::string name_of(const Packet& packet) {
    decoder_.decode(packet, frame_);
    const reflect::Type* const message = frame_.decoded.message();
    if (message != nullptr) return message->name;
    return frame_.am.present ? fmt::format("AM type {}", frame_.am.type) : "packet";
  }

  // Prints the packet's line.
  void report(const Packet& packet, const lines::Sender::Result& result) {
    ++packets_;
    done_ += result.done;
    std::string text = fmt::format("{:>4}  {:<14}  ", packets_, name_of(packet));
    if (!sender_.confirms()) {
      text += result.done ? "sent" : "not sent";
    } else {
      text += fmt::format("{}confirmed after {}, {} ms", result.done ? "" : "not ",
                          counted(result.tries, "try", "tries"), result.took.count());
    }
    if (result.strange_acks > 0) {
      text += "; " + counted(result.strange_acks, "confirmation", "confirmations") +
              " of other numbers came";
    }
    text += '\n';
    if (options_.format == "jsonl") {  // Its lines are the frames that come alone.
      text::print_harmless(stderr, text);
      return;
    }
    output_.buffer().append(text);
    output_.flush();
  }

  // Handles a frame from the line.
  void came(const Packet& packet) {
    const bool confirmation = packet.framing == Framing::kHdlc && packet.kind == kSerialAck &&
                              packet.error.fault == Fault::kNone;
    if (!options_.listen_s || confirmation) return;
    decoder_.decode(packet, frame_);
    format::Record record{.index = frames_++,
                          .number = frames_,
                          .interface_name = name_,
                          .time_ns = packet.time_ns,
                          .frame = &frame_};
    formatter_->print(record, output_.buffer());
    // A closed pipe ends the listening; packets are sent all the same.
    if (!output_.flush() && listening_) lines::request_stop();
  }

  void line_is_gone(const char* what) {
    text::print(stderr, "rubric: {}: {}\n", name_, what);
    unsent_ = true;
  }

  void summary() const {
    std::string text = counted(packets_, "packet", "packets");
    if (sender_.confirms()) {
      text += fmt::format(", {} confirmed", done_);
      if (done_ < packets_) text += fmt::format(", {} not", packets_ - done_);
    } else {
      text += done_ < packets_ ? fmt::format(", {} sent", done_) : " sent";
    }
    if (left_out_ > 0) {
      text += ", " + counted(left_out_, "frame", "frames") + " without a packet left out";
    }
    if (options_.listen_s) text += ", " + fmt::format("{} came", frames_);
    text::print(stderr, "rubric: {}\n", text);
  }

  const SendOptions& options_;
  const reflect::Protocol& protocol_;
  encode::LineEncoder encoder_;
  reflect::FrameDecoder decoder_;
  std::unique_ptr<format::Formatter> formatter_;
  std::string name_;
  cli::Output output_;
  reflect::Frame frame_;
  lines::Sender sender_;
  int packets_ = 0;  // Sent packets, whatever their result.
  int done_ = 0;
  int left_out_ = 0;
  std::uint64_t frames_ = 0;  // Received and shown.
  bool unsent_ = false;
  bool listening_ = false;  // All that there was to send was sent.
};

void add_timing_options(cli::Command& app, SendOptions& options) {
  app.add_option("--timeout", options.timeout_ms,
                 "On a serial line, send an unconfirmed packet again after this many ms")
      .between(1, kWaitMostMs);
  app.add_option("--retries", options.retries,
                 "On a serial line, send it again at most this many times")
      .between(0, kRetriesMost);
  app.add_option("--interval", options.interval_ms, "Wait this many ms between packets")
      .between(0, kWaitMostMs);
  app.add_flag("--keep-going", options.keep_going, "Go on after a packet that is not confirmed");
  app.add_option("--listen", options.listen_s,
                 "Print what comes back, as rubric decode does, until this many seconds after the "
                 "last packet")
      .between(0.0, kListenMostS);
}

}  // namespace

void add_send(cli::Command& app) {
  auto options = std::make_shared<SendOptions>();
  options->lines.to_line = true;
  cli::Command& sub = app.add_subcommand(
      "send", "Send packets to a mote: JSON lines of 'rubric decode', or fields alone");
  sub.footer(kSendFooter);
  encode::add_line_options(sub, options->lines);
  sub.get_option("FILE").check([](const std::string& text) {
    return text.find('@') != text.npos && (text.starts_with("serial@") || text.starts_with("sf@") ||
                                           text.starts_with("network@"))
               ? fmt::format("'{}' is where to: --to {}", text, text)
               : std::string();
  });
  sub.add_option("--to", options->to,
                 "Send to serial@DEVICE:BAUD (or a platform, as serial@/dev/ttyUSB0:telosb), "
                 "network@HOST:PORT or sf@HOST:PORT (default: $MOTECOM, else sf@localhost:9002)");
  add_timing_options(sub, *options);
  sub.add_option("--format", options->format,
                 "With --listen, print what comes back as text or jsonl (rubric.decode/1; what "
                 "became of the packets then goes to stderr)")
      .one_of({"text", "jsonl"});
  cli::add_color_option(sub, options->color);
  sub.exit_code_of([options] {
    encode::check_line_options(options->lines);
    return Send(*options, address_of(*options)).run();
  });
}

}  // namespace rubric::tools
