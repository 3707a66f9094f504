// Keeps a run: all frames in a capture, and what each node was given and did in a log.
#pragma once

#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "codec/lines/capture_file.h"
#include "codec/text/files.h"
#include "conformance/trace/events/lines.h"
#include "conformance/trace/trace.h"

namespace rubric::run {

/// Nodes of several threads may write. Frames wait for a moment before they are written, so that
/// those of nodes that are late come in the order of their stamps.
class Keeper {
 public:
  using Mode = text::OutFile::Mode;

  /// Returns false if the file cannot be opened, having said why on stderr.
  bool open_capture(const std::string& path, Mode mode, const lines::Rotation& rotation);
  /// Opens the log of these nodes, and of what they state. Throws std::system_error.
  void open_log(const std::string& path, Mode mode, const std::vector<trace::NodeHeader>& nodes,
                std::uint64_t seed);

  void frame(const Packet& packet, std::string_view interface_name);
  void given(const events::NodeNames& names, const machine::Event& event);
  void did(const events::NodeNames& names, const machine::Frame& frame);
  void did(const events::NodeNames& names, const machine::Notice& notice);

  /// Writes the frames that have waited long enough.
  void settle();
  /// Ends both files. Returns false if something could not be written, having said why on stderr.
  bool finish();

 private:
  struct Kept {
    Packet packet;
    std::vector<std::uint8_t> bytes;
    std::string interface_name;
  };
  void write_until(std::int64_t time_ns);
  void put(const trace::Line& line);
  void check_log(int error);
  std::int64_t now_us() const;

  std::mutex mutex_;
  std::optional<lines::CaptureFile> capture_;
  std::vector<Kept> waiting_;  // By time.
  std::unique_ptr<text::OutFile> log_;
  std::string log_path_;
  int log_error_ = 0;
  std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
};

}  // namespace rubric::run
