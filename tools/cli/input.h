// Input of all subcommands that read packets: files, formats, protocol.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "codec/containers/packet.h"
#include "codec/containers/reader.h"
#include "codec/reflect/schema.h"
#include "tools/cli/command.h"

namespace rubric::lines {
class Air;
class Line;
}  // namespace rubric::lines

namespace rubric::cli {

/// One of them: a line that was opened before its turn to be read.
struct OpenLine {
  std::shared_ptr<lines::Line> line;
  std::shared_ptr<lines::Air> air;
};

/// Filled by add_input_options.
struct InputOptions {
  std::vector<std::string> files;  ///< In order; none or "-" is stdin.
  std::string format = "auto";     ///< As for --input-format.
  std::string fcs = "auto";        ///< As for --fcs.
  std::vector<std::string> links;  ///< As for --link-type: 149=radio-fcs.
  std::string spec = "rubicon";    ///< A protocol's id, or a .ksy file.
  std::string as_message;          ///< Bytes are this message alone; empty: framed packets.
  bool progress = true;            ///< A bar on stderr for long files, where that is a terminal.
  bool prints = true;              ///< Output runs along on stdout; else it comes at the end.
  bool follow = false;             ///< At a file's end wait for more of it.
  bool listen_only = false;        ///< Write nothing to a serial line.
  bool reconnect = false;          ///< A line that is gone is opened again.
  std::map<std::string, OpenLine> open_lines;  ///< By name, as from open_sources().
};

/// Adds FILE..., --spec, --as and those of add_capture_options() to a subcommand.
void add_input_options(Command& app, InputOptions& options);

/// Adds --input-format, of which `bare` goes with --as, --fcs and --link-type.
void add_capture_options(Command& app, InputOptions& options, bool bare = false);

/// Adds --spec.
void add_spec_option(Command& app, InputOptions& options);

/// Adds --follow, --listen-only and --reconnect: for subcommands whose files may be lines in
/// use (live/line.h). Without FILE, at a terminal, $MOTECOM is taken.
void add_live_options(Command& app, InputOptions& options);

/// Returns whether the input goes on until somebody ends it: a line in use, a followed file, a
/// pipe.
bool goes_on(const InputOptions& options);
/// Ends the command if a file cannot be read, or a line cannot be opened and will not be again:
/// before an output replaces one that is good. The lines stay open until they are read.
void open_sources(InputOptions& options);

/// Returns all files that are read, "-" for stdin, and the one of --spec: no output may be one of
/// them.
std::vector<std::string> all_inputs(const InputOptions& options);

/// Returns the protocol of --spec, as protocol_of() does; of "auto" that of choose_spec().
const reflect::Protocol& chosen_protocol(const InputOptions& options);
/// Returns the message of --as, null if it is not given; throws UsageError as above.
const reflect::Type* chosen_message(const InputOptions& options, const reflect::Protocol& protocol);

/// The source of a packet. Borrowed: valid during the callback.
struct Source {
  std::string_view file;            ///< As given; "-" is stdin.
  std::size_t file_index = 0;       ///< Counts from 0.
  std::uint64_t number = 0;         ///< Number of the packet in its file, from 1.
  std::string_view format;          ///< As for --input-format, after detection.
  std::string_view interface_name;  ///< Empty if the packet's interface has no name.
};

/// The result of reading.
struct InputResult {
  bool failed = false;   ///< A file could not be opened or read, or is damaged; said on stderr.
  bool damaged = false;  ///< Nothing worse happened than that a file has damaged places.
  bool stopped = false;  ///< The callback asked to stop.
  bool live = false;     ///< A line, or a followed file, was read until the user stopped it.
};

/// Called for each packet, in order; false stops reading.
using OnPacket = std::function<bool(const Packet&, const Source&)>;
/// Called before reading waits for more of a pipe or a device: a good time to flush output.
using OnIdle = std::function<void()>;

/// What to do with inputs that are no captures but text of another kind.
struct OtherText {
  std::function<bool(Bytes beginning)> is_it;
  std::function<void(const Source&, std::string text)> take;  ///< Called with the whole of it.
};

/// Reads all files in constant memory, except for the text that `other` takes. Delivers a damaged
/// place of a capture file as a packet with an error, and reads on after it and in later files.
InputResult read_packets(const InputOptions& options, const OnPacket& on_packet,
                         const OnIdle& on_idle = {}, const OtherText& other = {});

/// Returns whether this packet is a damaged place of its file rather than a malformed frame.
bool is_damage(const Packet& packet);

}  // namespace rubric::cli
