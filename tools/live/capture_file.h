// A pcapng file that grows while packets come.
#pragma once

#include <string>
#include <string_view>

#include "codec/containers/writer.h"

namespace rubric::live {

/// Throws std::system_error, with the path, where the file cannot be written.
class CaptureFile {
 public:
  explicit CaptureFile(const std::string& path);
  ~CaptureFile();
  CaptureFile(const CaptureFile&) = delete;
  CaptureFile& operator=(const CaptureFile&) = delete;

  void write(const Packet& packet, std::string_view interface_name);
  /// What was written so far is in the file then, in whole blocks.
  void flush();
  /// Whether the file is a pipe whose reader closed it.
  bool reader_gone() const;
  /// Ends the file. False if something of it could not be written. Why, stderr says once: as soon
  /// as it happens, but that the reader of a pipe is gone only here.
  bool finish();

 private:
  void complain() const;

  std::string path_;
  int fd_;
  int error_ = 0;
  PcapngWriter writer_;
  std::string waiting_;
};

}  // namespace rubric::live
