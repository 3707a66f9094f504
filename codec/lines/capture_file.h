// A pcapng file that grows while packets come.
#pragma once

#include <string>
#include <string_view>

#include "codec/containers/writer.h"

namespace rubric::lines {

/// Throws std::system_error, with the path, if the file cannot be written.
class CaptureFile {
 public:
  explicit CaptureFile(const std::string& path);
  ~CaptureFile();
  CaptureFile(const CaptureFile&) = delete;
  CaptureFile& operator=(const CaptureFile&) = delete;

  void write(const Packet& packet, std::string_view interface_name);
  /// Writes everything so far to the file, in whole blocks.
  void flush();
  /// Returns whether the file is a pipe whose reader closed it.
  bool reader_gone() const;
  /// Ends the file. Returns false if something could not be written. stderr has the reason once: as
  /// soon as it happens, except that a closed pipe is reported only here.
  bool finish();

 private:
  void complain() const;

  std::string path_;
  int fd_;
  int error_ = 0;
  PcapngWriter writer_;
  std::string waiting_;
};

}  // namespace rubric::lines
