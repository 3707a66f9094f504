// Lines for a program that may read slowly, or not at all.
#pragma once

#include <cstddef>
#include <mutex>
#include <string>
#include <string_view>

#include "codec/lines/time.h"

namespace rubric::run {

/// What a reader has at the end of a node to take what waits.
constexpr lines::Milliseconds kLastWords{1000};

/// What its reader has not taken waits here, so that it holds no node up: a node that waits breaks
/// the rules of time. Several threads may write; each line stays whole.
class LineOutput {
 public:
  /// `name` is for what is said on stderr.
  LineOutput(int fd, std::string name) : fd_(fd), name_(std::move(name)) {}

  /// Takes a line with its end. Where the reader is too far behind the line is lost, and stderr
  /// says so once.
  void put(std::string_view line);
  /// Writes what the reader takes now. Returns whether nothing waits.
  bool flush();
  /// Writes what waits until the deadline. Says on stderr how many lines were lost.
  void finish(lines::SteadyTime deadline);
  /// Returns the error, as in errno, with which it took no more, EPIPE if its reader has gone; 0:
  /// none.
  int error() const;

 private:
  bool write_some();

  const int fd_;
  const std::string name_;
  mutable std::mutex mutex_;
  std::string waiting_;
  std::size_t lost_ = 0;
  int error_ = 0;
};

}  // namespace rubric::run
