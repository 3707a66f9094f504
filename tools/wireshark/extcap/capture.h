// A capture that Wireshark reads while it grows.
#pragma once

#include <string>

namespace rubric::extcap {

struct CaptureOptions {
  std::string fifo;    ///< A named pipe that Wireshark reads; or a file.
  std::string source;  ///< In the form of live/line.h.
  std::string filter;  ///< In the form of `rubric decode --filter`; empty: all frames.
  std::string spec;    ///< Protocol of the filter.
  bool listen_only = false;
  bool reconnect = false;
};

/// Captures until it is stopped. Returns the exit code; prints mistakes on stderr.
int capture(const CaptureOptions& options);

/// Returns what is wrong with a filter, or nothing. Throws cli::UsageError for an unknown `spec`.
std::string filter_error(const std::string& filter, const std::string& spec);

}  // namespace rubric::extcap
