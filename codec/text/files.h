// Writes the files of reports: whole, or with the reason why not.
#pragma once

#include <string>
#include <string_view>

namespace rubric::report {

/// Writes all of `text` to the file descriptor, waiting if needed. Returns 0, or the error as in
/// errno.
int write_all(int fd, std::string_view text);

/// Writes `text` as the whole of a new or an old file. Returns 0, or the error as in errno; then
/// there may be a part of it.
int write_file(const std::string& path, std::string_view text);

}  // namespace rubric::report
