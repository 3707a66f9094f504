// A pcapng file that is written while packets come.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "codec/containers/writer.h"
#include "codec/text/files.h"

namespace rubric::lines {

/// The size or age at which a growing capture goes on in a next file; 0 is none.
struct Rotation {
  std::uint64_t bytes = 0;
  std::chrono::seconds time{0};
};

/// A capture. A growing one has every packet on its way to the disk when write() returns; a whole
/// one takes its name in finish(). Errors go to stderr once, as soon as they happen; a closed pipe
/// is reported by finish().
class CaptureFile {
 public:
  using Mode = text::OutFile::Mode;

  /// Opens nothing yet: that is left to the first packet or to open(), so that a source that
  /// cannot be had costs no file. A rotated `run.pcapng` goes on in `run.2.pcapng`.
  explicit CaptureFile(const std::string& path, Mode mode, const Rotation& rotation = {});

  /// Opens the file and writes its header, so that readers see what it is. Returns false if that
  /// failed, now or earlier.
  bool open();
  void write(const Packet& packet, std::string_view interface_name);
  /// Returns whether the file was opened, or could not be.
  bool is_started() const { return file_ || error_ != 0; }
  /// Returns whether the file is a pipe whose reader closed it.
  bool reader_gone() const;
  /// Ends the file; opens it before if nothing has. Returns false if something could not be
  /// written.
  bool finish();

 private:
  void flush();
  bool is_full() const;
  void end_file();
  void complain() const;

  std::string path_;  // Of the present file.
  const std::string first_path_;
  const Mode mode_;
  const Rotation rotation_;
  std::unique_ptr<text::OutFile> file_;
  int number_ = 1;
  std::uint64_t size_ = 0;  // Of the present file.
  std::chrono::steady_clock::time_point opened_at_{};
  int error_ = 0;
  std::optional<PcapngWriter> writer_;
  std::string waiting_;
};

}  // namespace rubric::lines
