// From files to a Run: whatever was captured, in one order of time.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "codec/containers/reader.h"
#include "conformance/oracle/align.h"
#include "conformance/oracle/observation.h"

namespace rubric::oracle {

/// What captures are; .rtr logs are known by their first line in any case.
struct ReadAs {
  InputFormat format = InputFormat::kUnknown;  ///< kUnknown: found out from the content.
  Framing hex_framing = Framing::kSf;          ///< What the lines of hex text are.
  AlignOptions align = {};                     ///< How captures are put on one clock.
};

/// Collects files to one run. Damaged bytes are observed as such and never stop the reading.
class RunReader {
 public:
  explicit RunReader(const ReadAs& as = {});
  ~RunReader();
  RunReader(const RunReader&) = delete;
  RunReader& operator=(const RunReader&) = delete;

  /// The file at `path`, format by content, .rtr text included. False, with `error` saying file and
  /// reason, where it cannot be read at all.
  bool add_file(const std::string& path, std::string& error);
  /// The same for bytes at hand; `name` is how reports call them.
  bool add_bytes(const std::string& name, std::string_view bytes, std::string& error);
  /// A file or line whose packets come one by one; returns its index among the run's files.
  std::uint32_t open(const std::string& name);
  /// The next packet of file `file`, which open() gave; the name is that of the packet's interface,
  /// empty where it has none.
  void take(std::uint32_t file, const Packet& packet, std::string_view interface_name);
  /// What finish() would give now; more may be added afterwards. The bytes of frames are shared.
  Run snapshot() const;

  /// Everything that was added, in one order (see merge()). The reader is empty afterwards.
  Run finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// All of `files` as one run.
std::optional<Run> read(const std::vector<std::string>& files, std::string& error);

/// Orders by time what several taps saw; what came at the same time keeps the order of its file,
/// and files the order in which they were given. Radio stamps are starts of frames and serial
/// stamps their ends, so a cause stands before what it caused as long as the taps share a clock.
/// What has no time stands behind what has, makes has_time false, and says nothing of the run's
/// end.
void merge(Run& run);

/// Which way a frame on a serial line goes where the capture does not say: a sink's frames carry
/// AM source 0 and destination 0xFFFF just as a host's may, so the message decides.
bool looks_towards_sink(const machine::Frame& frame);

}  // namespace rubric::oracle
