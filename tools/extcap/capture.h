// A capture that Wireshark reads while it grows.
#pragma once

#include <string>

namespace rubric::extcap {

struct CaptureOptions {
  std::string fifo;     ///< A named pipe that Wireshark reads; or a file.
  std::string source;   ///< As live/line.h names them.
  std::string filter;   ///< As `rubric decode --filter`; empty: all frames.
  std::string spec;     ///< Protocol of the filter.
  bool listen_only = false;
  bool reconnect = false;
};

/// Captures until somebody says so. The exit code; mistakes are said on stderr.
int capture(const CaptureOptions& options);

/// What is wrong with a filter; empty: nothing. Throws cli::UsageError for an unknown `spec`.
std::string filter_error(const std::string& filter, const std::string& spec);

}  // namespace rubric::extcap
