// Reads files into a Run, in one order of time.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "codec/containers/reader.h"
#include "conformance/check/align/align.h"
#include "conformance/check/observation.h"

namespace rubric::check {

/// Collects files to one run. Damaged bytes are observed as such and never stop the reading.
class RunReader {
 public:
  explicit RunReader(const AlignOptions& align = {});
  ~RunReader();
  RunReader(const RunReader&) = delete;
  RunReader& operator=(const RunReader&) = delete;

  /// Adds a file's bytes, .rtr text included; the format is found from its content, and reports use
  /// `name`. Returns false, with `error` naming file and reason, if they cannot be read at all; no
  /// run comes of that.
  /// 'rubric check' adds captures packet by packet, as every command reads them.
  bool add_file(const std::string& path, std::string& error);
  bool add_bytes(const std::string& name, std::string_view bytes, std::string& error);
  /// Opens a file or line whose packets come one by one; returns its index among the run's files.
  std::uint32_t open(const std::string& name);
  /// Takes the next packet of file `file`, which open() returned; the name is that of the packet's
  /// interface, empty if it has none; the number is the packet's in its file, 0 for that after the
  /// one before.
  void take(std::uint32_t file, const Packet& packet, std::string_view interface_name,
            std::uint64_t number = 0);
  /// Returns what finish() would return now; more may be added afterwards. The bytes of frames are
  /// shared.
  Run snapshot() const;
  /// Forgets frames that snapshot() returned, as `known` has them: the first ones up to `end`,
  /// without those of Run::past. Times go on as they are there.
  void forget(const Run& known, std::size_t end);
  /// Returns how many observations are held.
  std::size_t held() const;
  /// Returns between which stamps they are; 0 without any.
  std::int64_t span_us() const;

  /// Returns everything that was added, in one order (see merge()), and empties the reader.
  Run finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Reads all of `files` as one run.
std::optional<Run> read(const std::vector<std::string>& files, std::string& error);

/// Orders by time what several taps saw. At equal times frames keep the order of their file, and
/// files the order in which they were given. Radio stamps mark starts of frames and serial stamps
/// their ends, so a cause precedes its effect as long as the taps share a clock. Frames without a
/// time come after those with one, make has_time false, and do not change the run's end.
void merge(Run& run);

}  // namespace rubric::check
