// Turns lines into packets: those of `rubric decode --format jsonl`, or the fields of one message
// alone.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "codec/reflect/schema.h"
#include "codec/reflect/value.h"
#include "tools/cli/command.h"
#include "tools/cli/input.h"
#include "tools/encode/record.h"

namespace rubric::encode {

class Lines {
 public:
  /// More than any frame's line; longer lines cannot be valid.
  static constexpr std::size_t kMaxBytes = 16 * 1024 * 1024;

  /// Called before each read from the file, which may wait, to do other work meanwhile. Returns
  /// false to stop reading, as if the file ended.
  using BeforeRead = std::function<bool(int fd)>;

  /// Opens a file, "-" is stdin. Throws std::system_error.
  explicit Lines(const std::string& name, BeforeRead before_read = {});
  ~Lines();
  Lines(const Lines&) = delete;
  Lines& operator=(const Lines&) = delete;

  /// Reads the next line without its end; returns false at the end of the input. The view is valid
  /// until the next call. Throws std::system_error if reading fails.
  bool next(std::string_view& line);

  /// Returns the number of that line, from 1.
  std::uint64_t number() const { return number_; }
  /// Returns whether that line was longer than kMaxBytes; it is then cut.
  bool too_long() const { return too_long_; }

 private:
  bool fill();

  int fd_;
  BeforeRead before_read_;
  std::unique_ptr<char[]> chunk_;
  std::string_view rest_;  // Rest of the chunk.
  std::string line_;       // A line that spans chunks.
  std::uint64_t number_ = 0;
  bool too_long_ = false;
};

struct LineOptions {
  cli::InputOptions input;     ///< Its files, spec and message.
  std::string carrier;         ///< With a message: serial, radio or none; empty: its own carrier.
  std::optional<int> am_type;  ///< With a message: of the frame around it, as the next three.
  std::optional<int> dest;
  std::optional<int> src;
  std::optional<int> group;
  bool to_line = false;  ///< For a serial line, so that no other carrier will do.
};

/// Adds FILE, --spec, --as, --am-type, --dest, --src and --group to a subcommand.
void add_line_options(cli::Command& app, LineOptions& options);
/// Adds --carrier.
void add_carrier_option(cli::Command& app, LineOptions& options);
/// Throws cli::UsageError if an option is given that needs --as.
void check_line_options(const LineOptions& options);

/// Turns a line into a packet.
class LineEncoder {
 public:
  /// `serial_framing`: "hdlc" or "sf", for a single message on a serial line.
  /// Throws cli::UsageError if nothing carries the message.
  LineEncoder(const LineOptions& options, const reflect::Protocol& protocol,
              const reflect::Type* message, std::string_view serial_framing);

  /// Encodes a line. Throws RecordError.
  void encode(const reflect::Value& line, OwnedPacket& out);

  /// Returns what lets the line be encoded: the option for fields alone, or the spec that has its
  /// message; nothing if that is not what it lacks.
  std::string way_out(const reflect::Value& line) const;

 private:
  std::string_view carrier_name() const;
  std::int64_t am_type(std::string_view carrier_name) const;
  reflect::Value around();

  const LineOptions& options_;
  const reflect::Protocol& protocol_;
  const reflect::Type* message_;
  std::string_view serial_framing_;
  RecordReader reader_;
  reflect::Value wrap_;
  std::string_view framing_;
  std::size_t frame_index_ = 0;
  int next_dsn_ = 0;
};

/// One run over all lines of all files. Reports a faulty line on stderr, with its place, and
/// continues with the next.
class EncodedLines {
 public:
  /// Called for each packet, with its line's place ("FILE:LINE"); returns false to end the run.
  using OnPacket =
      std::function<bool(EncodedLines& lines, const OwnedPacket& packet, const std::string& place)>;

  /// `options` and `encoder` outlive this.
  EncodedLines(const LineOptions& options, LineEncoder& encoder, OnPacket on_packet,
               Lines::BeforeRead before_read = {});

  /// Runs. Returns false if some line or file could not be read or encoded.
  bool all();
  /// Returns whether there was a line that is not empty.
  bool any() const { return any_; }
  /// Reports on stderr what is wrong at a place, so that all() returns false.
  void complain(const std::string& place, std::string_view what);

 private:
  void encode_next(Lines& lines);

  LineEncoder& encoder_;
  OnPacket on_packet_;
  Lines::BeforeRead before_read_;
  std::vector<std::string> files_;
  std::string file_;
  OwnedPacket packet_;
  bool as_message_;
  bool ended_ = false;
  bool good_ = true;
  bool any_ = false;
};

}  // namespace rubric::encode
