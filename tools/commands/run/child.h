// An application in a process of its own.
#pragma once

#include <sys/types.h>

#include <string>

namespace rubric::run {

/// Runs a command by the shell, with pipes at its standard input and output.
class Child {
 public:
  /// Throws std::system_error.
  explicit Child(const std::string& command);
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  /// Closes its standard input, and ends it if it does not end within two seconds.
  ~Child();

  int in() const { return in_; }    ///< To be written.
  int out() const { return out_; }  ///< To be read.

 private:
  pid_t pid_ = -1;
  int in_ = -1;
  int out_ = -1;
};

}  // namespace rubric::run
