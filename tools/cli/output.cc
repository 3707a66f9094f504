#include "tools/cli/output.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "codec/text/text.h"
#include "tools/cli/command.h"

namespace rubric::cli {

bool is_written(const std::string& name, int error) {
  if (error != 0 && error != EPIPE) {
    text::print(stderr, "rubric: cannot write {}: {}\n", name == "-" ? "stdout" : name,
                std::strerror(error));
  }
  return error == 0;
}

namespace {

std::unique_ptr<text::OutFile> opened(const std::string& path, Output::Mode mode) try {
  return std::make_unique<text::OutFile>(path, mode);
} catch (const std::system_error& error) {
  exit_with(cannot_write(error));
}

}  // namespace

Output::Output(const std::string& path, Mode mode)
    : file_(opened(path, mode)),
      name_(path),
      fd_(file_->fd()),
      packer_(text::make_packer(text::packing_of_name(path))) {}

bool Output::flush() {
  if (packer_) {
    packer_->pack(buffer_.view(), packed_);
    if (open()) error_ = text::write_all(fd_, packed_);
    packed_.clear();
  } else if (open()) {
    error_ = text::write_all(fd_, buffer_.view());
  }
  buffer_.clear();
  return open();
}

bool Output::finish() {
  if (flush() && packer_) {
    packer_->finish(packed_);
    error_ = text::write_all(fd_, packed_);
    packed_.clear();
  }
  if (open() && file_) error_ = file_->finish();
  return is_written(name_, error_);
}

bool write_file(const std::string& path, std::string_view text) {
  if (path == "-") std::fflush(stdout);  // Keeps the order with earlier output.
  return is_written(path, text::write_file(path, text));
}

int cannot_write(const std::system_error& error) {
  text::print(stderr, "rubric: cannot write {}\n", error.what());
  return kExitOutput;
}

void keep_apart(const std::string& option, const std::string& output,
                const std::vector<std::string>& files) {
  struct stat to {};
  const bool is_file = !output.empty() && output != "-" && ::stat(output.c_str(), &to) == 0;
  const auto is_output = [&](const std::string& file) {
    if (!output.empty() && output != "-" && file == output) return true;  // Not there yet.
    struct stat from {};
    const int got = file == "-" ? ::fstat(0, &from) : ::stat(file.c_str(), &from);
    if (!is_file || got != 0 || to.st_dev != from.st_dev || to.st_ino != from.st_ino) return false;
    return S_ISREG(to.st_mode) || S_ISBLK(to.st_mode);
  };
  const bool clash =
      files.empty() ? is_output("-") : std::any_of(files.begin(), files.end(), is_output);
  if (clash) throw UsageError(option, output + " is also an input or another output");
}

}  // namespace rubric::cli
