// Files as every report is written: whole, and with the reason where that fails.
#pragma once

#include <string>
#include <string_view>

namespace rubric::report {

/// Writes all of `text` to the file descriptor, waiting where it has to. 0, or why not as in errno.
int write_all(int fd, std::string_view text);

/// Writes `text` as the whole of a new or an old file. 0, or why not as in errno; then there may be
/// a part of it.
int write_file(const std::string& path, std::string_view text);

}  // namespace rubric::report
