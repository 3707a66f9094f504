#include "codec/lines/capture_file.h"

#include <fmt/format.h>
#include <poll.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "codec/text/text.h"

namespace rubric::lines {
namespace {

using std::chrono::steady_clock;

constexpr std::size_t kEnough = 64 * 1024;

std::string numbered(const std::string& path, int number) {
  if (number == 1) return path;
  const std::filesystem::path first(path);
  const std::string name =
      fmt::format("{}.{}{}", first.stem().string(), number, first.extension().string());
  return (first.parent_path() / name).string();
}

}  // namespace

CaptureFile::CaptureFile(const std::string& path, Mode mode, const Rotation& rotation)
    : path_(path), first_path_(path), mode_(mode), rotation_(rotation) {}

bool CaptureFile::open() {
  if (is_started()) return error_ == 0;
  while (!file_ && error_ == 0) {
    path_ = numbered(first_path_, number_);
    try {
      file_ = std::make_unique<text::OutFile>(path_, mode_);
    } catch (const std::system_error& error) {
      // A long run goes on after the files of an earlier one.
      if (number_ > 1 && error.code() == std::errc::file_exists) {
        ++number_;
      } else {
        error_ = error.code().value();
      }
    }
  }
  if (error_ != 0) {
    if (error_ != EINTR) complain();  // A pipe waited for its reader until Ctrl-C.
    return false;
  }
  size_ = 0;
  opened_at_ = steady_clock::now();
  writer_.emplace();
  writer_->begin(waiting_);
  flush();
  return error_ == 0;
}

bool CaptureFile::is_full() const {
  if (rotation_.bytes != 0 && size_ >= rotation_.bytes) return true;
  return rotation_.time.count() != 0 && steady_clock::now() - opened_at_ >= rotation_.time;
}

void CaptureFile::write(const Packet& packet, std::string_view interface_name) {
  if (file_ && is_full()) {
    end_file();
    ++number_;
  }
  if (!open()) return;
  writer_->write(packet, interface_name, waiting_);
  if (mode_ != Mode::kWhole || waiting_.size() >= kEnough) flush();
}

void CaptureFile::flush() {
  if (error_ == 0) {
    error_ = text::write_all(file_->fd(), waiting_);
    if (error_ != 0 && error_ != EPIPE) complain();
  }
  size_ += waiting_.size();
  waiting_.clear();
}

bool CaptureFile::reader_gone() const {
  if (!file_) return error_ == EPIPE;
  pollfd self{file_->fd(), 0, 0};
  return error_ == EPIPE || (::poll(&self, 1, 0) == 1 && (self.revents & POLLERR) != 0);
}

void CaptureFile::end_file() {
  writer_->finish(waiting_);
  flush();
  if (error_ == 0) {
    error_ = file_->finish();
    if (error_ != 0) complain();
  }
  file_.reset();
}

bool CaptureFile::finish() {
  if (open()) end_file();
  if (error_ == EPIPE) complain();
  return error_ == 0;
}

void CaptureFile::complain() const {
  text::print(stderr, "rubric: cannot write {}: {}\n", path_, std::strerror(error_));
}

}  // namespace rubric::lines
